#include "client/stream/occluders.h"

#include <algorithm>
#include <cmath>

#include "client/cache/decode_scratch.h"
#include "client/select/selection.h"
#include "client/stream/layer_decoder.h"
#include "client/stream/residency_counters.h"
#include "codec/mesh/mesh_triangles.h"

namespace citystream::client {

using tiles::tileset::Layer;

namespace {

using Triangle = std::array<int32_t, 9>;

/// Squared, of twice the triangle, in grid units.
double squared_double_area(const Triangle& t) {
    const std::array<double, 3> a = {static_cast<double>(t[3]) - t[0], static_cast<double>(t[4]) - t[1],
                                     static_cast<double>(t[5]) - t[2]};
    const std::array<double, 3> b = {static_cast<double>(t[6]) - t[0], static_cast<double>(t[7]) - t[1],
                                     static_cast<double>(t[8]) - t[2]};
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    return x * x + y * y + z * z;
}

/// Keeps the largest `count` of [begin, end of the vector), in their order.
void keep_largest(std::vector<Triangle>& triangles, size_t begin, size_t count) {
    if (triangles.size() - begin <= count) return;
    std::vector<double> areas;
    for (size_t i = begin; i < triangles.size(); ++i) areas.push_back(squared_double_area(triangles[i]));
    std::nth_element(areas.begin(), areas.begin() + static_cast<ptrdiff_t>(count), areas.end(), std::greater<>());
    const double least = areas[count];
    const auto kept = std::remove_if(triangles.begin() + static_cast<ptrdiff_t>(begin), triangles.end(),
                                     [&](const Triangle& t) { return squared_double_area(t) <= least; });
    triangles.erase(kept, triangles.end());
}

}  // namespace

/// The dressed triangles, or the others, that are large enough and solid, appended.
void Occluders::take_large(const codec::mesh::MeshContent& mesh, uint32_t steps, NodeIndex node, bool dressed,
                           std::vector<Triangle>& out) const {
    const double least = 2 * kLeastOccluderMetres2 * std::pow(kGridUnitsPerMetre, 2);
    const TileKnowledge& tile = knowledge_.tiles[node];
    const bool all_solid = !shows_alpha(knowledge_, tile);
    codec::mesh::for_each_triangle(mesh, steps, [&](const codec::mesh::PlacedTriangle& triangle) {
        if (triangle.dressed != dressed) return;
        Triangle t{};
        for (size_t i = 0; i < t.size(); ++i) t[i] = triangle.places[i / 3][i % 3];
        const bool solid = all_solid || !shows_alpha(knowledge_, tile, triangle.chart_word);
        if (solid && squared_double_area(t) >= least * least) out.push_back(t);
    });
}

void Occluders::begin_update() {
    ++update_;
    for (auto at = tiles_.begin(); at != tiles_.end();) {
        if (update_ - at->second.drawn_by <= kKeptUpdates) {
            ++at;
            continue;
        }
        host_.fixed -= at->second.bytes();
        at = tiles_.erase(at);
    }
}

/// Triangles of a prefix; null where they cannot be had.
Occluders::Surfaces* Occluders::surfaces_of(NodeIndex node, uint32_t count) {
    const auto found = tiles_.find(node);
    if (found != tiles_.end() && found->second.steps == count) return &found->second;
    // Which of its surfaces are solid is known with its atlas.
    const bool has_atlas = !directory_.node(node).record->steps(Layer::kAtlas).empty();
    if (has_atlas && names_charts(directory_.manifest()) && !knowledge_.tiles[node].charts_known) return nullptr;
    const CachedLayer* entry = cache_.find(layer_key(node, Layer::kMesh));
    if (entry == nullptr || count == 0 || entry->wire.size() < count) return nullptr;
    const auto steps = std::span(directory_.node(node).record->steps(Layer::kMesh)).first(count);
    uint64_t decoded = 0;
    for (const auto& step : steps) decoded += step.decoded_bytes;
    const uint64_t scratch_bytes = decode_scratch_bytes(Layer::kMesh, decoded);
    if (!cache_.free_host(scratch_bytes + kMostOccluders * 2 * sizeof(Triangle))) return nullptr;
    const Scratch scratch(host_, scratch_bytes);
    const auto mesh = decode_mesh_content(entry->wire, steps);
    if (!mesh) return nullptr;
    Surfaces surfaces;
    surfaces.steps = count;
    take_large(*mesh, count, node, false, surfaces.triangles);
    keep_largest(surfaces.triangles, 0, kMostOccluders);
    surfaces.dressed_begin = static_cast<uint32_t>(surfaces.triangles.size());
    take_large(*mesh, count, node, true, surfaces.triangles);
    keep_largest(surfaces.triangles, surfaces.dressed_begin, kMostOccluders);
    surfaces.triangles.shrink_to_fit();
    Surfaces& kept = tiles_[node];
    if (found != tiles_.end()) host_.fixed -= kept.bytes();
    kept = std::move(surfaces);
    host_.fixed += kept.bytes();
    host_.note_peak();
    return &kept;
}

void Occluders::draw(NodeIndex node, uint32_t steps, bool flat, DepthPicture& picture) {
    Surfaces* surfaces = surfaces_of(node, steps);
    if (surfaces == nullptr) return;
    surfaces->drawn_by = update_;
    const GridPoint origin = directory_.manifest().tile_origin(*directory_.node(node).record);
    const size_t count = flat ? surfaces->triangles.size() : surfaces->dressed_begin;
    for (size_t i = 0; i < count; ++i) {
        const Triangle& t = surfaces->triangles[i];
        std::array<std::array<double, 3>, 3> corners{};
        for (size_t corner = 0; corner < 3; ++corner) {
            corners[corner] = {to_metres(origin.x + t[3 * corner]), to_metres(origin.y + t[3 * corner + 1]),
                               to_metres(origin.z + t[3 * corner + 2])};
        }
        picture.add(corners);
    }
}

void draw_back_of(const codec::facade::Placement& wall, const GridPoint& origin, double depth, DepthPicture& picture) {
    const double along_x = to_metres(wall.along[0]), along_y = to_metres(wall.along[1]);
    const double length = std::hypot(along_x, along_y);
    if (!(length > 0)) return;
    const double x = to_metres(origin.x + wall.origin[0]) - along_y / length * depth;
    const double y = to_metres(origin.y + wall.origin[1]) + along_x / length * depth;
    const double low = to_metres(origin.z + wall.origin[2]), high = low + to_metres(wall.height);
    const std::array<std::array<double, 3>, 4> corners = {
        {{x, y, low}, {x + along_x, y + along_y, low}, {x + along_x, y + along_y, high}, {x, y, high}}};
    picture.add(corners);
}

}  // namespace citystream::client
