#include "client/render/frame_tiles.h"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace citystream::client {
namespace {

VkDeviceAddress joined(const uint32_t words[2]) {
    return words[0] | VkDeviceAddress{words[1]} << 32;
}

// Distance from the camera to the tile's origin decides the order: exact enough for early depth tests, and the same in
// every run.
double origin_distance(const Camera& camera, const TileDraw& tile) {
    double sum = 0;
    for (size_t i = 0; i < 3; ++i) {
        const double d = tile.origin[i] - camera.position[i];
        sum += d * d;
    }
    return sum;
}

std::vector<size_t> front_to_back(const Camera& camera, std::span<const TileDraw> tiles) {
    std::vector<double> distance(tiles.size());
    for (size_t i = 0; i < tiles.size(); ++i) distance[i] = origin_distance(camera, tiles[i]);
    std::vector<size_t> order(tiles.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return distance[a] < distance[b]; });
    return order;
}

bool in_pages(const TileDraw& tile) {
    return tile.atlas != kNoLayer && tile.atlas_form == codec::atlas::AtlasForm::kPages;
}

}  // namespace

void FrameTiles::learn(LayerId layer, std::span<const uint32_t> words) {
    map_facts_.resize(sources_.pool->layers.size());
    map_facts_[layer] = facade_map_facts(words);
}

void FrameTiles::reserve(uint64_t words) {
    const uint64_t bytes = words * 4;
    if (tables_.bytes >= bytes && tables_.bytes > 0) return;
    destroy_buffer(*sources_.device, tables_);
    tables_ = create_buffer(*sources_.device, std::max<uint64_t>(64 << 10, bytes + bytes / 2), BufferPlace::kUpload);
}

uint32_t FrameTiles::casters_of(const TileDraw& tile) const {
    uint32_t casters = 0;
    if (!has_facades(tile)) return 0;
    for (const FacadeMapBinding& map : tile.facade_maps) {
        if (map.layer >= map_facts_.size()) continue;
        const auto caster = caster_for(renderer_, map_facts_[map.layer].form);
        if (caster) casters |= 1u << *caster;
    }
    return casters;
}

// A tile whose atlas is in pages takes the coordinates of its transport, too.
Result<DrawnTile> FrameTiles::add(FrameTables& tables, const TileDraw& tile, const CameraCell& cell, FrameKind kind,
                                  const FrameLighting* lighting, const ReliefLight* relief, FrameCounts& counts) {
    const auto constants = tables.add_tile(tile, cell);
    if (!constants) return constants.error();
    DrawnTile drawn;
    drawn.tile = &tile;
    drawn.constants = *constants;
    drawn.casters = casters_of(tile);
    const auto first_strip = sources_.strips->add(tile, joined(constants->mesh), !has_facades(tile));
    if (!first_strip) return first_strip.error();
    drawn.first_strip = *first_strip;
    CoordinateLayers& layers = *sources_.coordinates;
    if (in_pages(tile)) {
        const CoordinateLayers::Coordinates& coordinates = layers.of(tile, *sources_.pool);
        const Status named = tables.add_coordinates(coordinates.layer, drawn.constants);
        if (!named) return named.error();
        drawn.mesh.form = codec::atlas::AtlasForm::kPages;
        drawn.mesh.transport = coordinates.transport;
        if (coordinates.transport == ChartTransport::kUniform) drawn.runs = &coordinates.runs;
        ++counts.page_tiles;
        if (tile.mesh != kNoLayer && coordinates.transport != layers.wanted()) ++counts.fallback_tiles;
    }
    const bool lit = kind == FrameKind::kLit;
    if (lit) {
        const TileRelief of_tile = relief != nullptr ? relief->of(tile, *lighting) : TileRelief();
        const auto radiance = tables.add_radiance(tile, lighting->address(), of_tile, drawn.constants);
        if (!radiance) return radiance.error();
        drawn.radiance = *radiance;
        drawn.relief = of_tile.local != kNoLayer;
    }
    drawn.mesh.reading = tables.is_direct() ? LayerReading::kDirect : LayerReading::kPaged;
    drawn.mesh.alpha_test = tile.alpha_test;
    drawn.mesh.tint = tint_;
    drawn.mesh.lit = lit;
    drawn.mesh.sun = lit && lighting->has_sun();
    drawn.mesh.receivers = lit && tile.radiance != kNoLayer;
    return drawn;
}

Result<DrawnFrame> FrameTiles::write(const Camera& camera, std::span<const TileDraw> tiles, FrameKind kind,
                                     const FrameLighting* lighting, const ReliefLight* relief,
                                     const FacadeTableHead& head, FrameCounts& counts) {
    counts = {};
    // Coordinates take slots, which the tables' bound counts.
    for (const TileDraw& tile : tiles) {
        if (in_pages(tile)) sources_.coordinates->of(tile, *sources_.pool);
    }
    counts.coordinate_bytes = sources_.coordinates->slots_used() * kSlotBytes;
    reserve(FrameTables::bound(*sources_.pool, tiles, kind == FrameKind::kLit));
    const CameraCell cell = camera_cell(camera.position);
    DrawnFrame frame{kind, make_frame_constants(camera, cell, tint_), head, {}};
    sources_.strips->begin_frame();
    FrameTables tables(*sources_.pool, tables_.address, map_facts_, head);
    for (const size_t i : front_to_back(camera, tiles)) {
        const Result<DrawnTile> drawn = add(tables, tiles[i], cell, kind, lighting, relief, counts);
        if (!drawn) return drawn.error();
        frame.tiles.push_back(*drawn);
    }
    if (!tables.words().empty()) std::memcpy(tables_.mapped, tables.words().data(), tables.words().size_bytes());
    return frame;
}

}  // namespace citystream::client
