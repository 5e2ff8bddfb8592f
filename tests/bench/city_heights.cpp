#include "tests/bench/city_heights.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "client/stream/layer_decoder.h"
#include "codec/grid.h"
#include "codec/mesh/mesh_triangles.h"

namespace citystream::bench {

using tiles::tileset::Layer;

namespace {

using Corner = std::array<double, 3>;

/// Twice the area of (a, b, p) in the plane, positive where they turn left.
double turn(const Corner& a, const Corner& b, double x, double y) {
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

/// Of a triangle that is not upright, where (x, y) lies in it.
std::optional<double> height_at(const std::array<Corner, 3>& t, double x, double y) {
    const double a = turn(t[1], t[2], x, y), b = turn(t[2], t[0], x, y), c = turn(t[0], t[1], x, y);
    const double sum = a + b + c;
    if (sum == 0 || std::min({a / sum, b / sum, c / sum}) < 0) return std::nullopt;
    return (a * t[0][2] + b * t[1][2] + c * t[2][2]) / sum;
}

}  // namespace

Result<codec::mesh::MeshTile> mesh_of(const SampleCity& city, const tiles::tileset::TileRecord& record) {
    const auto& steps = record.steps(Layer::kMesh);
    std::vector<std::vector<std::byte>> wire;
    uint64_t begin = 0;
    for (const auto& step : steps) {
        const auto bytes = city.layer_bytes(record, Layer::kMesh).subspan(begin, step.end - begin);
        wire.emplace_back(bytes.begin(), bytes.end());
        begin = step.end;
    }
    const auto content = client::decode_mesh_content(wire, steps);
    if (!content) return content.error();
    return codec::mesh::to_tile(*content);
}

Result<CityHeights> CityHeights::of_city(const SampleCity& city) {
    CityHeights heights;
    heights.lowest_ = city.manifest.extent.min[2];
    const double x = to_metres(city.manifest.origin.x), y = to_metres(city.manifest.origin.y);
    for (const tiles::tileset::TileRecord* record : city.leaves()) {
        if (record->steps(Layer::kMesh).empty()) continue;
        auto mesh = mesh_of(city, *record);
        if (!mesh) return mesh.error();
        const GridPoint origin = city.manifest.tile_origin(*record);
        const auto& bounds = record->bounds;
        heights.leaves_.push_back({{bounds.min[0] + x, bounds.min[1] + y},
                                   {bounds.max[0] + x, bounds.max[1] + y},
                                   {to_metres(origin.x), to_metres(origin.y), to_metres(origin.z)},
                                   std::move(*mesh)});
    }
    return heights;
}

double CityHeights::highest_at(double x, double y) const {
    double highest = lowest_;
    for (const Leaf& leaf : leaves_) {
        if (x < leaf.low[0] || x > leaf.high[0] || y < leaf.low[1] || y > leaf.high[1]) continue;
        for (size_t i = 0; i < leaf.mesh.indices.size(); i += 3) {
            std::array<Corner, 3> triangle{};
            for (size_t k = 0; k < 3; ++k) {
                const auto& at = leaf.mesh.vertices[leaf.mesh.indices[i + k]].position;
                for (size_t c = 0; c < 3; ++c) triangle[k][c] = leaf.origin[c] + to_metres(at[c]);
            }
            if (const auto height = height_at(triangle, x, y)) highest = std::max(highest, *height);
        }
    }
    return highest;
}

}  // namespace citystream::bench
