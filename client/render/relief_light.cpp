#include "client/render/relief_light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "client/render/drawn_frame.h"
#include "codec/facade/facade_layout.h"

namespace citystream::client {
namespace {

constexpr double kMetresPerGridUnit = 1.0 / 1024;

codec::radiance::FacadeScales scales_on(const ReliefWall& wall, const FacadeMapFacts& facts) {
    return {static_cast<float>(facts.size[0] / std::hypot(wall.along[0], wall.along[1])),
            static_cast<float>(facts.size[1] / wall.height)};
}

}  // namespace

std::vector<ReliefWall> relief_walls(std::span<const uint32_t> words) {
    if (words.size() < FACADE_LAYER_HEADER_WORDS || words[FACADE_LAYER_WORD_MAGIC] != FACADE_LAYER_MAGIC) return {};
    const uint64_t count = words[FACADE_LAYER_WORD_PLACEMENT_COUNT], first = words[FACADE_LAYER_WORD_PLACEMENTS];
    if (first + count * FACADE_PLACEMENT_WORDS > words.size()) return {};
    std::vector<ReliefWall> walls(count);
    for (uint64_t i = 0; i < count; ++i) {
        const uint32_t* const placement = &words[first + i * FACADE_PLACEMENT_WORDS];
        const auto metres = [&](size_t field) { return static_cast<int32_t>(placement[field]) * kMetresPerGridUnit; };
        walls[i] = {
            {metres(FACADE_PLACEMENT_ORIGIN_X), metres(FACADE_PLACEMENT_ORIGIN_Y), metres(FACADE_PLACEMENT_ORIGIN_Z)},
            {metres(FACADE_PLACEMENT_ALONG_X), metres(FACADE_PLACEMENT_ALONG_Y)},
            placement[FACADE_PLACEMENT_HEIGHT] * kMetresPerGridUnit};
    }
    return walls;
}

WallPixels wall_pixels(const ReliefWall& wall, const std::array<double, 3>& origin, const Camera& camera,
                       uint32_t height) {
    std::array<double, 3> from_camera{};
    for (size_t c = 0; c < 3; ++c) from_camera[c] = origin[c] + wall.corner[c] - camera.position[c];
    // Along its outwards normal the camera is in front of it.
    if (from_camera[0] * wall.along[1] - from_camera[1] * wall.along[0] >= 0) return {};
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
    for (const double share : {0.0, 1.0}) {
        for (const double up : {0.0, wall.height}) {
            const std::array<double, 3> corner = {from_camera[0] + share * wall.along[0],
                                                  from_camera[1] + share * wall.along[1], from_camera[2] + up};
            const double distance = std::inner_product(corner.begin(), corner.end(), camera.forward.begin(), 0.0);
            nearest = std::min(nearest, distance);
            farthest = std::max(farthest, distance);
        }
    }
    if (farthest <= 0) return {};
    const double size = std::max(std::hypot(wall.along[0], wall.along[1]), wall.height);
    const double pixels = size * height / (2 * std::tan(camera.fov_y / 2));
    return {pixels / std::max(nearest, camera.near_plane), pixels / std::max(farthest, camera.near_plane)};
}

ReliefLight::ReliefLight(const Device& device, SlotPool& pool, FacadeRenderer renderer, uint64_t btf_budget_bytes,
                         uint32_t btf_texels, uint64_t most_rays)
    : renderer_(renderer),
      btf_options_{.patch = btf_texels},
      masks_(device, pool, {device.is_cpu, most_rays}),
      btfs_(device, pool, masks_, btf_budget_bytes, btf_options_, {device.is_cpu, most_rays}) {}

void ReliefLight::learn(LayerId layer, std::span<const uint32_t> words) {
    forget(layer);
    std::vector<ReliefWall> walls = relief_walls(words);
    const bool is_facade_layer = !words.empty() && words[0] == FACADE_LAYER_MAGIC;
    if (is_facade_layer && walls.empty()) partial_.insert(layer);
    if (!walls.empty()) walls_[layer] = std::move(walls);
}

void ReliefLight::forget_light(LayerId layer) {
    masks_.forget(layer);
    btfs_.forget(layer);
    scales_.erase(layer);
}

void ReliefLight::forget(LayerId layer) {
    forget_light(layer);
    partial_.erase(layer);
    walls_.erase(layer);
}

// Which maps of the tile are drawn in a way that needs a mask or a BTF.
void ReliefLight::want(const Camera& camera, const TileDraw& tile, std::span<const FacadeMapFacts> facts,
                       uint32_t height) {
    const auto walls = walls_.find(tile.facade);
    if (walls == walls_.end()) return;
    const double patch = btf_options_.patch;
    const size_t count = std::min(walls->second.size(), tile.map_of_placement.size());
    for (size_t i = 0; i < count; ++i) {
        const LayerId layer = tile.facade_maps[tile.map_of_placement[i]].layer;
        if (layer >= facts.size()) continue;
        const auto caster = caster_for(renderer_, facts[layer].form);
        const WallPixels pixels = wall_pixels(walls->second[i], tile.origin, camera, height);
        if (!caster || pixels.most == 0 || facts[layer].size[0] == 0) continue;
        const double middle = std::sqrt(pixels.most * pixels.least);
        ++(middle >= RELIEF_CAST_PIXELS * patch ? cast_ : middle >= RELIEF_WALL_PIXELS ? by_btf_ : by_mean_);
        Wanted& wanted = wanted_[layer];
        if (pixels.most > wanted.pixels)
            wanted.map = {layer, *caster, facts[layer].slots, facts[layer].is_opaque,
                          scales_on(walls->second[i], facts[layer])};
        wanted.mask |= pixels.most > RELIEF_CAST_PIXELS / 2 * patch;
        wanted.btf |= pixels.least < RELIEF_CAST_PIXELS * patch;
        wanted.pixels = std::max(wanted.pixels, pixels.most);
    }
}

// The largest first, of BTFs no more than there is room for: for others no mask is made in vain. Those that are there
// come before, so that maps of one size do not take turns.
std::vector<ReliefLight::Wanted> ReliefLight::wanted_with_room() const {
    std::vector<Wanted> wanted;
    for (const auto& [layer, entry] : wanted_) {
        wanted.push_back(entry);
        wanted.back().map.scales = scales_.at(layer);
    }
    const auto before = [&](const Wanted& a, const Wanted& b) {
        const bool a_is_there = !btfs_.is_missing(a.map.map), b_is_there = !btfs_.is_missing(b.map.map);
        return a_is_there != b_is_there ? a_is_there : a.pixels > b.pixels;
    };
    std::ranges::stable_sort(wanted, before);
    uint64_t bytes = 0;
    for (Wanted& entry : wanted) {
        if (!entry.btf) continue;
        const uint64_t more = btfs_.bytes_of(entry.map);
        entry.btf = more != 0 && more <= btfs_.budget_bytes() - bytes;
        if (entry.btf) bytes += more;
    }
    return wanted;
}

Status ReliefLight::plan(const Camera& camera, std::span<const TileDraw> tiles, std::span<const FacadeMapFacts> facts,
                         const FrameLighting& lighting, uint32_t height) {
    wanted_.clear();
    cast_ = by_btf_ = by_mean_ = 0;
    for (const TileDraw& tile : tiles) {
        if (has_facades(tile) && lighting.local_light(tile.radiance) != kNoLayer) want(camera, tile, facts, height);
    }
    for (const auto& [layer, wanted] : wanted_) scales_.try_emplace(layer, wanted.map.scales);
    std::vector<ReliefMap> with_mask, with_btf;
    std::vector<Wanted> all = wanted_with_room();
    for (const Wanted& wanted : all) {
        if (wanted.btf) with_btf.push_back(wanted.map);
    }
    std::ranges::stable_sort(all, std::greater(), &Wanted::pixels);
    for (const Wanted& wanted : all) {
        const bool makes_btf = wanted.btf && btfs_.is_missing(wanted.map.map);
        if (wanted.mask || makes_btf) with_mask.push_back(wanted.map);
    }
    if (const Status status = masks_.plan(with_mask); !status) return status.error();
    return btfs_.plan(with_btf);
}

TileRelief ReliefLight::of(const TileDraw& tile, const FrameLighting& lighting) const {
    TileRelief relief;
    if (!has_facades(tile)) return relief;
    relief.local = lighting.local_light(tile.radiance);
    if (relief.local == kNoLayer) return relief;
    relief.receivers = lighting.local_receivers(tile.radiance);
    for (const FacadeMapBinding& map : tile.facade_maps) {
        relief.maps.emplace_back();
        if (map.layer == kNoLayer) continue;
        relief.maps.back() = {masks_.mask_of(map.layer), btfs_.reference(map.layer)};
    }
    return relief;
}

void ReliefLight::record(VkCommandBuffer commands) {
    masks_.record(commands);
    btfs_.record(commands);
}

void ReliefLight::finish() {
    masks_.finish();
    btfs_.finish();
}

void ReliefLight::count(FrameCounts& counts) const {
    const ReliefMaskCounts masks = masks_.counts();
    const BtfCounts btfs = btfs_.counts();
    counts.relief_masks = masks.masks;
    counts.relief_mask_bytes = masks.bytes;
    counts.btfs = btfs.btfs;
    counts.btf_bytes = btfs.bytes;
    counts.facades_cast = cast_;
    counts.facades_by_btf = by_btf_;
    counts.facades_by_mean = by_mean_;
}

}  // namespace citystream::client
