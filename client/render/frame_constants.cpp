#include "client/render/frame_constants.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "codec/grid.h"

namespace citystream::client {
namespace {

void split_address(VkDeviceAddress address, uint out[2]) {
    out[0] = static_cast<uint32_t>(address);
    out[1] = static_cast<uint32_t>(address >> 32);
}

void scale_row(const std::array<double, 3>& axis, double scale, float out[3]) {
    for (size_t i = 0; i < 3; ++i) out[i] = static_cast<float>(axis[i] * scale);
}

}  // namespace

FrameConstants make_frame_constants(const Camera& camera, const CameraCell& cell,
                                    const codec::atlas::FacadeTint& tint) {
    const double focal = 1.0 / std::tan(camera.fov_y / 2);
    const double aspect = static_cast<double>(camera.width) / static_cast<double>(camera.height);
    FrameConstants constants{};
    scale_row(camera.right, focal / aspect, constants.clip_x);
    scale_row(camera.up, -focal, constants.clip_y);  // Vulkan's y points down
    scale_row(camera.forward, 1.0, constants.clip_w);
    for (size_t i = 0; i < 3; ++i) constants.camera_fraction[i] = cell.fraction[i];
    constants.near_plane = static_cast<float>(camera.near_plane);
    if (tint.strength > 0) constants.tint = static_cast<float>(codec::atlas::tint_place(camera.position, tint));
    return constants;
}

uint64_t FrameTables::bound(const SlotPool& pool, std::span<const TileDraw> tiles, bool lit) {
    uint64_t words = lit ? tiles.size() * (sizeof(ReliefDraw) / 4 + 1) : 0;
    for (const TileDraw& tile : tiles) {
        if (lit) words += tile.facade_maps.size() * sizeof(ReliefDrawEntry) / 4 + 1;
        words += (sizeof(FacadeTableHead) + tile.facade_maps.size() * sizeof(FacadeMapEntry)) / 4 +
                 tile.map_of_placement.size() + 4;
        if (!tile.shared_charts.empty()) words += tile.chart_count * sizeof(SharedChartEntry) / 4 + 1;
    }
    return words + pool.slots_used * 2 + pool.layers.size() * 2;
}

VkDeviceAddress FrameTables::append(const void* table, size_t bytes) {
    if (words_.size() % 2 != 0) words_.push_back(0);  // tables begin at multiples of 8 bytes
    const VkDeviceAddress address = base_ + words_.size() * 4;
    words_.resize(words_.size() + bytes / 4);
    if (bytes != 0) std::memcpy(words_.data() + words_.size() - bytes / 4, table, bytes);
    return address;
}

Status FrameTables::refer(LayerId id, uint out[2]) {
    out[0] = out[1] = 0;
    if (id == kNoLayer) return Done{};
    if (!is_live(pool_, id) || pool_.layers[id].slots.empty()) {
        return Error{"a tile names layer " + std::to_string(id) + ", which holds nothing"};
    }
    const SlotLayer& layer = pool_.layers[id];
    if (is_contiguous(pool_, layer)) {
        split_address(slot_address(pool_, layer.slots[0]) | LAYER_REF_DIRECT, out);
        return Done{};
    }
    is_direct_ = false;
    auto [found, fresh] = references_.try_emplace(id, 0);
    if (fresh) {
        std::vector<VkDeviceAddress> pages(layer.slots.size());
        for (size_t i = 0; i < pages.size(); ++i) pages[i] = slot_address(pool_, layer.slots[i]);
        found->second = append(pages.data(), pages.size() * sizeof pages[0]);
    }
    split_address(found->second, out);
    return Done{};
}

Status FrameTables::add_shared_charts(const TileDraw& tile, TileConstants& constants) {
    std::vector<SharedChartEntry> charts(tile.chart_count);
    for (const SharedChartBinding& binding : tile.shared_charts) {
        if (binding.chart_in_tile >= charts.size()) return Error{"a shared chart that the tile does not have"};
        SharedChartEntry& entry = charts[binding.chart_in_tile];
        if (Status status = refer(binding.layer, entry.layer); !status) return status.error();
        entry.finest_mip = std::max(static_cast<float>(binding.finest_mip), binding.least_mip);
        entry.colour = binding.colour;
    }
    split_address(append(charts.data(), charts.size() * sizeof(SharedChartEntry)), constants.shared_charts);
    return Done{};
}

Status FrameTables::add_facades(const TileDraw& tile, TileConstants& constants) {
    std::vector<FacadeMapEntry> maps(tile.facade_maps.size());
    for (size_t i = 0; i < maps.size(); ++i) {
        const LayerId layer = tile.facade_maps[i].layer;
        const FacadeMapFacts facts = layer < facts_.size() ? facts_[layer] : FacadeMapFacts();
        maps[i] = {{}, {facts.finest[0], facts.finest[1]}, facts.is_opaque ? 1U : 0U, 0};
        if (Status status = refer(layer, maps[i].layer); !status) return status.error();
    }
    for (const uint32_t map : tile.map_of_placement) {
        if (map >= maps.size())
            return Error{"a placement shows map " + std::to_string(map) + " of a tile that has fewer"};
    }
    FacadeTableHead head = head_;
    split_address(append(tile.map_of_placement.data(), tile.map_of_placement.size() * 4), head.map_of_placement);
    split_address(append(&head, sizeof head), constants.facade_maps);
    append(maps.data(), maps.size() * sizeof(FacadeMapEntry));
    return Done{};
}

Result<RadianceDraw> FrameTables::add_radiance(const TileDraw& tile, VkDeviceAddress light, const TileRelief& relief,
                                               TileConstants& constants) {
    ReliefDraw draw{};
    if (const Status status = refer(tile.radiance, draw.radiance.layer); !status) return status.error();
    split_address(light, draw.radiance.light);
    std::ranges::copy(tile.radiance_offset, draw.radiance.offset);
    if (relief.local == kNoLayer) {
        split_address(append(&draw.radiance, sizeof draw.radiance), constants.mesh_draw);
        return draw.radiance;
    }
    if (const Status status = refer(relief.local, draw.local); !status) return status.error();
    draw.local_receivers = relief.receivers;
    std::vector<ReliefDrawEntry> entries(relief.maps.size());
    for (size_t i = 0; i < entries.size(); ++i) {
        if (const Status status = refer(relief.maps[i].mask, entries[i].mask); !status) return status.error();
        split_address(relief.maps[i].btf, entries[i].btf);
    }
    split_address(append(&draw, sizeof draw), constants.mesh_draw);
    append(entries.data(), entries.size() * sizeof(ReliefDrawEntry));
    return draw.radiance;
}

Result<TileConstants> FrameTables::add_tile(const TileDraw& tile, const CameraCell& camera) {
    TileConstants constants{};
    is_direct_ = true;
    if (Status status = refer(tile.mesh, constants.mesh); !status) return status.error();
    if (Status status = refer(tile.atlas, constants.atlas); !status) return status.error();
    if (Status status = refer(tile.facade, constants.facade); !status) return status.error();
    if (tile.facade != kNoLayer) {
        if (Status status = add_facades(tile, constants); !status) return status.error();
    }
    if (!tile.shared_charts.empty()) {
        if (Status status = add_shared_charts(tile, constants); !status) return status.error();
    }
    constants.atlas_finest_mip = std::max(static_cast<float>(tile.atlas_finest_mip), tile.atlas_least_mip);
    for (size_t i = 0; i < 3; ++i) {
        const int64_t offset = to_grid(tile.origin[i]) - camera.cell[i];
        if (std::abs(offset) > std::numeric_limits<int32_t>::max() / 2)
            return Error{"a tile is more than 1,000 km away"};
        constants.origin[i] = static_cast<int32_t>(offset);
    }
    constants.distance_per_unit = tile.drop_rule.distance_per_unit;
    constants.least_dropped = tile.mesh_least_dropped;
    return constants;
}

}  // namespace citystream::client
