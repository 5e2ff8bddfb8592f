#include "client/render/relief_masks.h"

#include <algorithm>
#include <cstring>

#include "client/render/relief_passes_layout.h"
#include "client/render/relief_shaders.h"
#include "codec/facade/facade_form.h"
#include "tiles/radiance/in_parallel.h"

namespace citystream::client {
namespace {

void split(VkDeviceAddress address, uint (&words)[2]) {
    std::memcpy(words, &address, sizeof words);
}

}  // namespace

ReliefMasks::ReliefMasks(const Device& device, SlotPool& pool, const ReliefMaking& making)
    : device_(device), pool_(pool), making_(making), pages_(device, pool) {}

ReliefMasks::~ReliefMasks() {
    for (Pass& pass : passes_) destroy_pass(device_, pass);
}

Status ReliefMasks::plan(std::span<const ReliefMap> maps) {
    todo_.clear();
    made_ = refused_ = rays_ = 0;
    ++plans_;
    for (const ReliefMap& map : maps) {
        if (!is_live(pool_, map.map)) return Error{"a facade map that does not exist cannot have a relief mask"};
        if (const auto at = masks_.find(map.map); at != masks_.end()) at->second.used = plans_;
    }
    for (const ReliefMap& map : maps) {
        auto at = masks_.find(map.map);
        const bool has_rays = making_.most_rays == 0 || rays_ < making_.most_rays;
        if (at == masks_.end() && has_rays) {
            if (make(map))
                at = masks_.find(map.map);
            else
                ++refused_;
        }
        if (at != masks_.end() && has_rays) go_on(map.map, at->second);
    }
    return Done{};
}

/// With the rays that are left of the frame's.
void ReliefMasks::go_on(LayerId map, Mask& mask) {
    if (mask.done == mask.surfaces) return;
    uint64_t count = mask.surfaces - mask.done;
    if (making_.most_rays != 0)
        count = std::min(count, (making_.most_rays - rays_ + RELIEF_DIRECTIONS - 1) / RELIEF_DIRECTIONS);
    if (mask.host) {
        constexpr uint32_t kTogether = 64;
        tiles::radiance::in_parallel((count + kTogether - 1) / kTogether, 0, [&](size_t i) {
            const auto first = static_cast<uint32_t>(i * kTogether);
            codec::radiance::cast_relief_rays(mask.host->grid, mask.host->words, mask.done + first,
                                              std::min(kTogether, static_cast<uint32_t>(count) - first));
            return true;
        });
    } else {
        todo_.push_back({map, mask.done, static_cast<uint32_t>(count)});
    }
    rays_ += count * RELIEF_DIRECTIONS;
    mask.done += static_cast<uint32_t>(count);
    if (mask.done < mask.surfaces) return;
    ++made_;
    if (mask.host) finish_on_host(mask);
}

/// Its words take the place of those that it began with.
void ReliefMasks::finish_on_host(Mask& mask) {
    destroy_layer(pool_, mask.layer);
    mask.layer = create_layer(pool_);
    if (const Status status = append_words(pool_, mask.layer, mask.host->words); !status)
        throw VulkanError(status.error().message);
    mask.host.reset();
}

bool ReliefMasks::make(const ReliefMap& map) {
    if (map.caster >= FACADE_RENDERER_COUNT) return false;
    auto grid = codec::facade::decode_form(read_words(pool_, map.map, pool_.layers[map.map].words));
    if (!grid) return false;
    const codec::radiance::ReliefSurfaces surfaces = codec::radiance::relief_surfaces(*grid);
    std::vector<uint32_t> words = codec::radiance::relief_mask_starts(surfaces, map.scales);
    const uint64_t slots = (uint64_t{words.size()} * 4 + kSlotBytes - 1) / kSlotBytes;
    while (free_slots(pool_) < slots) {
        if (!drop_oldest()) return false;
    }
    const LayerId layer = create_layer(pool_);
    if (!append_words(pool_, layer, words)) {
        destroy_layer(pool_, layer);
        return false;
    }
    slots_used_ += slots;
    Mask& mask = masks_[map.map];
    mask = {layer,
            map.caster,
            plans_,
            static_cast<uint32_t>(surfaces.shape.words(0)),
            static_cast<uint32_t>(surfaces.starts.size()),
            0,
            nullptr};
    if (making_.on_host) mask.host = std::make_unique<HostMask>(HostMask{std::move(*grid), std::move(words)});
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
    std::erase_if(todo_, [&](const Job& job) { return job.map == at->first; });
    slots_used_ -= pool_.layers[layer].slots.size();
    destroy_layer(pool_, layer);
    masks_.erase(at);
}

void ReliefMasks::record(VkCommandBuffer commands) {
    if (todo_.empty()) return;
    std::vector<LayerId> layers;
    for (const Job& job : todo_) layers.insert(layers.end(), {job.map, masks_.at(job.map).layer});
    pages_.begin(layers);
    for (const Job& job : todo_) {
        const Mask& mask = masks_.at(job.map);
        Pass& pass = passes_[mask.caster];
        if (pass.handle == VK_NULL_HANDLE)
            pass = create_compute_pass(device_, relief_shaders(mask.caster).mask, sizeof(ReliefMaskPassConstants));
        ReliefMaskPassConstants constants{};
        split(pages_.reference(job.map), constants.map);
        split(pages_.reference(mask.layer), constants.mask);
        constants.first_word = mask.first_word + job.first * RELIEF_MASK_SURFACE_WORDS;
        constants.surfaces = job.count;
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass.handle);
        vkCmdPushConstants(commands, pass.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
        vkCmdDispatch(commands, std::min<uint32_t>(job.count, RELIEF_PASS_ROW_GROUPS),
                      (job.count + RELIEF_PASS_ROW_GROUPS - 1) / RELIEF_PASS_ROW_GROUPS, 1);
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
    return at == masks_.end() || at->second.done < at->second.surfaces ? kNoLayer : at->second.layer;
}

void ReliefMasks::forget(LayerId map) {
    if (const auto at = masks_.find(map); at != masks_.end()) drop(at);
}

void ReliefMasks::make_room(uint64_t slots) {
    while (free_slots(pool_) < slots && !masks_.empty())
        drop(std::ranges::min_element(masks_, {}, [](const auto& entry) { return entry.second.used; }));
}

ReliefMaskCounts ReliefMasks::counts() const {
    return {masks_.size(), slots_used_ * kSlotBytes, made_, refused_, rays_};
}

bool ReliefMasks::has_pipeline() const {
    return std::ranges::any_of(passes_, [](const Pass& pass) { return pass.handle != VK_NULL_HANDLE; });
}

}  // namespace citystream::client
