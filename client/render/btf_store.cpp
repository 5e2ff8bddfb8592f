#include "client/render/btf_store.h"

#include <algorithm>
#include <cstring>

#include "client/render/relief_passes_layout.h"
#include "client/render/relief_shaders.h"
#include "codec/facade/facade_form.h"
#include "shaders/btf_mip.comp.h"
#include "tiles/radiance/in_parallel.h"

namespace citystream::client {
namespace {

/// Words of a BTF are read in groups of four.
constexpr uint64_t kAlignment = 16;
/// vkCmdUpdateBuffer takes no more at a time.
constexpr uint64_t kMostUpdateBytes = 65536;
static_assert(4 * (BTF_VIEW_TABLE + BTF_MOST_VIEWS_ACROSS * BTF_MOST_VIEWS_ACROSS * BTF_DIRECTION_WORDS) <=
              kMostUpdateBytes);

void split(VkDeviceAddress address, uint (&words)[2]) {
    std::memcpy(words, &address, sizeof words);
}

void dispatch(VkCommandBuffer commands, const Pass& pass, const BtfPassConstants& constants) {
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass.handle);
    vkCmdPushConstants(commands, pass.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
    vkCmdDispatch(commands, std::min<uint32_t>(constants.groups, RELIEF_PASS_ROW_GROUPS),
                  (constants.groups + RELIEF_PASS_ROW_GROUPS - 1) / RELIEF_PASS_ROW_GROUPS, 1);
}

void between_passes(VkCommandBuffer commands) {
    memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT,
                   VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                   VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

uint64_t aligned_bytes(const codec::radiance::BtfShape& shape) {
    return (4 * shape.words() + kAlignment - 1) / kAlignment * kAlignment;
}

/// Of btf_mip.comp.glsl, for mip >= 1.
uint32_t mip_groups(const codec::radiance::BtfShape& shape, uint32_t mip) {
    const uint32_t side = shape.patch() >> mip, texels = side * side;
    const uint64_t words = uint64_t{shape.views()} * texels * BTF_RECORD_WORDS;
    const uint64_t coverage = shape.has_coverage ? uint64_t{shape.views()} * ((texels + 3) / 4) : 0;
    return static_cast<uint32_t>((words + coverage + BTF_GROUP - 1) / BTF_GROUP);
}

}  // namespace

BtfStore::BtfStore(const Device& device, SlotPool& pool, const ReliefMasks& masks, uint64_t budget_bytes,
                   const codec::radiance::BtfOptions& options, const ReliefMaking& making)
    : device_(device),
      pool_(pool),
      masks_(masks),
      budget_bytes_(budget_bytes),
      options_(options),
      making_(making),
      pages_(device, pool) {}

BtfStore::~BtfStore() {
    for (Pass& pass : passes_) destroy_pass(device_, pass);
    destroy_pass(device_, mip_pass_);
    destroy_buffer(device_, buffer_);
}

Status BtfStore::plan(std::span<const ReliefMap> maps) {
    todo_.clear();
    made_ = refused_ = rays_ = 0;
    ++plans_;
    for (const ReliefMap& map : maps) {
        if (!is_live(pool_, map.map)) return Error{"a facade map that does not exist cannot have a BTF"};
        if (const auto at = btfs_.find(map.map); at != btfs_.end()) at->second.used = plans_;
    }
    for (const ReliefMap& map : maps) {
        auto at = btfs_.find(map.map);
        const bool has_rays = making_.most_rays == 0 || rays_ < making_.most_rays;
        if (at == btfs_.end() && has_rays) {
            if (make(map))
                at = btfs_.find(map.map);
            else
                ++refused_;
        }
        if (at != btfs_.end() && has_rays) go_on(map, at->second);
    }
    return Done{};
}

/// With the rays that are left of the frame's; not while the map has no mask.
void BtfStore::go_on(const ReliefMap& map, Place& place) {
    const uint64_t view_rays = uint64_t{place.shape.patch()} * place.shape.patch() * BTF_RAYS;
    uint64_t count = place.shape.views() - place.done;
    if (count == 0 || masks_.mask_of(map.map) == kNoLayer) return;
    if (making_.most_rays != 0) count = std::min(count, (making_.most_rays - rays_ + view_rays - 1) / view_rays);
    if (place.host)
        make_on_host(place, static_cast<uint32_t>(count));
    else
        todo_.push_back({map, place.done, static_cast<uint32_t>(count)});
    rays_ += count * view_rays;
    place.done += static_cast<uint32_t>(count);
    if (place.done < place.shape.views()) return;
    ++made_;
    if (!place.host) return;
    std::memcpy(static_cast<std::byte*>(buffer_.mapped) + place.begin, place.host->words.data(),
                4 * place.host->words.size());
    place.host.reset();
}

/// None of words that do not decode.
std::unique_ptr<BtfStore::HostBtf> BtfStore::begin_on_host(const ReliefMap& map,
                                                           const codec::radiance::BtfShape& shape) const {
    const auto all_words = [&](LayerId layer) { return read_words(pool_, layer, pool_.layers[layer].words); };
    auto grid = codec::facade::decode_form(all_words(map.map));
    if (!grid) return nullptr;
    HostBtf host{std::move(*grid), all_words(masks_.mask_of(map.map)),
                 codec::radiance::btf_head(shape, map.slots, map.scales)};
    host.words.resize(shape.words(), 0);
    return std::make_unique<HostBtf>(std::move(host));
}

void BtfStore::make_on_host(Place& place, uint32_t count) {
    const auto mask = codec::radiance::ReliefMaskView::create(place.host->mask);
    if (!mask) throw VulkanError(mask.error().message);
    tiles::radiance::in_parallel(count, 0, [&](size_t i) {
        codec::radiance::make_btf_view(place.host->grid, *mask, place.shape, place.done + static_cast<uint32_t>(i),
                                       place.host->words);
        return true;
    });
}

bool BtfStore::is_missing(LayerId map) const {
    const auto at = btfs_.find(map);
    return at == btfs_.end() || at->second.done < at->second.shape.views();
}

uint64_t BtfStore::bytes_of(const ReliefMap& map) const {
    const auto shape = codec::radiance::btf_shape(options_, !map.is_opaque);
    return shape && map.caster < FACADE_RENDERER_COUNT ? aligned_bytes(*shape) : 0;
}

bool BtfStore::make(const ReliefMap& map) {
    if (map.caster >= FACADE_RENDERER_COUNT || masks_.mask_of(map.map) == kNoLayer) return false;
    const auto shape = codec::radiance::btf_shape(options_, !map.is_opaque);
    if (!shape) return false;
    const uint64_t bytes = aligned_bytes(*shape);
    if (bytes > budget_bytes_) return false;
    std::optional<uint64_t> begin = gap_for(bytes);
    while (!begin && drop_oldest()) begin = gap_for(bytes);
    if (!begin) return false;
    std::unique_ptr<HostBtf> host;
    if (making_.on_host && !(host = begin_on_host(map, *shape))) return false;
    const BufferPlace where = making_.on_host ? BufferPlace::kDeviceHost : BufferPlace::kDevice;
    if (buffer_.handle == VK_NULL_HANDLE) buffer_ = create_buffer(device_, budget_bytes_, where);
    btfs_[map.map] = {*begin, bytes, plans_, *shape, 0, std::move(host)};
    return true;
}

/// First that is wide enough.
std::optional<uint64_t> BtfStore::gap_for(uint64_t bytes) const {
    std::vector<std::pair<uint64_t, uint64_t>> taken;
    for (const auto& [map, place] : btfs_) taken.emplace_back(place.begin, place.begin + place.bytes);
    std::ranges::sort(taken);
    uint64_t begin = 0;
    for (const auto& [from, end] : taken) {
        if (from - begin >= bytes) return begin;
        begin = end;
    }
    if (budget_bytes_ - begin >= bytes) return begin;
    return std::nullopt;
}

/// Of those that the present plan does not name.
bool BtfStore::drop_oldest() {
    const auto oldest = std::ranges::min_element(btfs_, {}, [](const auto& entry) { return entry.second.used; });
    if (oldest == btfs_.end() || oldest->second.used == plans_) return false;
    btfs_.erase(oldest);
    return true;
}

void BtfStore::record(VkCommandBuffer commands) {
    if (todo_.empty()) return;
    std::vector<LayerId> layers;
    for (const Job& job : todo_) layers.insert(layers.end(), {job.map.map, masks_.mask_of(job.map.map)});
    pages_.begin(layers);
    // The buffer's memory may have been another BTF's, which frames before read.
    memory_barrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
                   VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT);
    for (const Job& job : todo_) {
        if (job.first == 0) record_head(commands, job);
    }
    between_passes(commands);
    for (const Job& job : todo_) record_job(commands, job);
    memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                   VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT);
}

void BtfStore::record_head(VkCommandBuffer commands, const Job& job) {
    const Place& place = btfs_.at(job.map.map);
    const std::vector<uint32_t> head = codec::radiance::btf_head(place.shape, job.map.slots, job.map.scales);
    vkCmdUpdateBuffer(commands, buffer_.handle, place.begin, 4 * head.size(), head.data());
    // Views are filled up with texels that no pass writes.
    vkCmdFillBuffer(commands, buffer_.handle, place.begin + 4 * head.size(), 4 * (place.shape.words() - head.size()),
                    0);
}

void BtfStore::record_job(VkCommandBuffer commands, const Job& job) {
    Pass& pass = passes_[job.map.caster];
    if (pass.handle == VK_NULL_HANDLE)
        pass = create_compute_pass(device_, relief_shaders(job.map.caster).btf, sizeof(BtfPassConstants));
    if (mip_pass_.handle == VK_NULL_HANDLE)
        mip_pass_ = create_compute_pass(device_, k_btf_mip_comp, sizeof(BtfPassConstants));
    BtfPassConstants constants{};
    split(pages_.reference(job.map.map), constants.map);
    split(pages_.reference(masks_.mask_of(job.map.map)), constants.mask);
    const Place& place = btfs_.at(job.map.map);
    split((buffer_.address + place.begin) | LAYER_REF_DIRECT, constants.btf);
    const uint32_t view_groups = place.shape.patch() * place.shape.patch() / BTF_GROUP_TEXELS;
    constants.first_group = job.first * view_groups;
    constants.groups = job.count * view_groups;
    dispatch(commands, pass, constants);
    if (job.first + job.count < place.shape.views()) return;
    constants.first_group = 0;
    for (uint32_t mip = 1; mip < place.shape.mips(); ++mip) {
        between_passes(commands);
        constants.mip = mip;
        constants.groups = mip_groups(place.shape, mip);
        dispatch(commands, mip_pass_, constants);
    }
}

void BtfStore::finish() {
    todo_.clear();
}

void BtfStore::forget(LayerId map) {
    btfs_.erase(map);
    std::erase_if(todo_, [&](const Job& job) { return job.map.map == map; });
}

VkDeviceAddress BtfStore::reference(LayerId map) const {
    const auto at = btfs_.find(map);
    return is_missing(map) ? 0 : (buffer_.address + at->second.begin) | LAYER_REF_DIRECT;
}

BtfCounts BtfStore::counts() const {
    BtfCounts counts{btfs_.size(), 0, made_, refused_, rays_};
    for (const auto& [map, place] : btfs_) counts.bytes += place.bytes;
    return counts;
}

}  // namespace citystream::client
