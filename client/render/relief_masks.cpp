#include "client/render/relief_masks.h"

#include <algorithm>
#include <cstring>

#include "client/render/relief_passes_layout.h"
#include "client/render/relief_shaders.h"
#include "codec/facade/facade_form_layout.h"
#include "codec/facade/run_grid.h"

namespace citystream::client {
namespace {

constexpr uint32_t kHeadWords = 4;

/// Of a map's first words.
bool is_map(std::span<const uint32_t> head) {
    if (head.size() < kHeadWords || (head[FACADE_FORM_WORD_FORM] & 0xffffu) != FACADE_FORM_MAGIC) return false;
    const uint32_t width = head[FACADE_FORM_WORD_SIZE] & 0xffffu, height = head[FACADE_FORM_WORD_SIZE] >> 16;
    return width >= 1 && height >= 1 && width <= codec::facade::kMaxFacadeSide &&
           height <= codec::facade::kMaxFacadeSide;
}

void split(VkDeviceAddress address, uint (&words)[2]) {
    std::memcpy(words, &address, sizeof words);
}

}  // namespace

ReliefMasks::ReliefMasks(const Device& device, SlotPool& pool) : device_(device), pool_(pool), pages_(device, pool) {}

ReliefMasks::~ReliefMasks() {
    for (Pass& pass : passes_) destroy_pass(device_, pass);
}

Status ReliefMasks::plan(std::span<const ReliefMap> maps) {
    todo_.clear();
    made_ = refused_ = 0;
    ++plans_;
    for (const ReliefMap& map : maps) {
        if (!is_live(pool_, map.map)) return Error{"a facade map that does not exist cannot have a relief mask"};
        if (const auto at = masks_.find(map.map); at != masks_.end()) at->second.used = plans_;
    }
    for (const ReliefMap& map : maps) {
        if (masks_.contains(map.map)) continue;
        if (make(map))
            ++made_;
        else
            ++refused_;
    }
    return Done{};
}

bool ReliefMasks::make(const ReliefMap& map) {
    const std::vector<uint32_t> head = read_words(pool_, map.map, kHeadWords);
    if (map.caster >= FACADE_RENDERER_COUNT || !is_map(head)) return false;
    const auto shape =
        codec::radiance::relief_mask_shape(head[FACADE_FORM_WORD_SIZE] & 0xffffu, head[FACADE_FORM_WORD_SIZE] >> 16);
    const uint64_t slots = (uint64_t{shape.words()} * 4 + kSlotBytes - 1) / kSlotBytes;
    while (free_slots(pool_) < slots) {
        if (!drop_oldest()) return false;
    }
    std::vector<uint32_t> words = codec::radiance::relief_mask_head(shape, map.scales);
    words.resize(shape.words());
    const LayerId layer = create_layer(pool_);
    if (!append_words(pool_, layer, words)) {
        destroy_layer(pool_, layer);
        return false;
    }
    slots_used_ += slots;
    masks_[map.map] = {layer, shape, plans_};
    todo_.push_back({map, layer, shape.texels()});
    return true;
}

/// Of those that the present plan does not name.
bool ReliefMasks::drop_oldest() {
    const auto oldest = std::ranges::min_element(masks_, {}, [](const auto& entry) { return entry.second.used; });
    if (oldest == masks_.end() || oldest->second.used == plans_) return false;
    drop(oldest);
    return true;
}

void ReliefMasks::drop(std::map<LayerId, Mask>::iterator at) {
    const LayerId layer = at->second.layer;
    std::erase_if(todo_, [&](const Job& job) { return job.mask == layer; });
    slots_used_ -= pool_.layers[layer].slots.size();
    destroy_layer(pool_, layer);
    masks_.erase(at);
}

void ReliefMasks::record(VkCommandBuffer commands) {
    if (todo_.empty()) return;
    std::vector<LayerId> layers;
    for (const Job& job : todo_) layers.insert(layers.end(), {job.map.map, job.mask});
    pages_.begin(layers);
    for (const Job& job : todo_) {
        Pass& pass = passes_[job.map.caster];
        if (pass.handle == VK_NULL_HANDLE)
            pass = create_compute_pass(device_, relief_shaders(job.map.caster).mask, sizeof(ReliefMaskPassConstants));
        ReliefMaskPassConstants constants{};
        split(pages_.reference(job.map.map), constants.map);
        split(pages_.reference(job.mask), constants.mask);
        constants.texels = job.texels;
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass.handle);
        vkCmdPushConstants(commands, pass.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
        vkCmdDispatch(commands, std::min<uint32_t>(job.texels, RELIEF_PASS_ROW_GROUPS),
                      (job.texels + RELIEF_PASS_ROW_GROUPS - 1) / RELIEF_PASS_ROW_GROUPS, 1);
    }
    memory_barrier(
        commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
        VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT,
        VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT | VK_ACCESS_HOST_READ_BIT | VK_ACCESS_HOST_WRITE_BIT);
}

void ReliefMasks::finish() {
    todo_.clear();
}

LayerId ReliefMasks::mask_of(LayerId map) const {
    const auto at = masks_.find(map);
    return at == masks_.end() ? kNoLayer : at->second.layer;
}

void ReliefMasks::forget(LayerId map) {
    if (const auto at = masks_.find(map); at != masks_.end()) drop(at);
}

void ReliefMasks::make_room(uint64_t slots) {
    while (free_slots(pool_) < slots && !masks_.empty())
        drop(std::ranges::min_element(masks_, {}, [](const auto& entry) { return entry.second.used; }));
}

ReliefMaskCounts ReliefMasks::counts() const {
    return {masks_.size(), slots_used_ * kSlotBytes, made_, refused_};
}

bool ReliefMasks::has_pipeline() const {
    return std::ranges::any_of(passes_, [](const Pass& pass) { return pass.handle != VK_NULL_HANDLE; });
}

}  // namespace citystream::client
