#include "client/stream/chart_boxes.h"

#include <algorithm>
#include <limits>
#include <unordered_map>

#include "codec/chart_word.h"
#include "codec/mesh/mesh_triangles.h"

namespace citystream::client {

using tiles::tileset::Bounds;
using tiles::tileset::Layer;

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

void include(Bounds& box, const std::array<double, 3>& point) {
    for (size_t axis = 0; axis < 3; ++axis) {
        box.min[axis] = std::min(box.min[axis], point[axis]);
        box.max[axis] = std::max(box.max[axis], point[axis]);
    }
}

}  // namespace

bool learns_chart_boxes(const DirectoryCache& directory, NodeIndex node) {
    return directory.manifest().shared_chart_count > 0 && directory.node(node).record->steps(Layer::kFacade).empty();
}

std::array<double, 3> tile_corner(const DirectoryCache& directory, NodeIndex node) {
    const GridPoint at = directory.manifest().tile_origin(*directory.node(node).record);
    const GridPoint& city = directory.manifest().origin;
    return {to_metres(at.x - city.x), to_metres(at.y - city.y), to_metres(at.z)};
}

std::vector<ChartBox> chart_boxes_of(const codec::mesh::MeshContent& mesh, uint32_t steps,
                                     const std::array<double, 3>& corner, double margin) {
    std::unordered_map<uint32_t, Bounds> boxes;
    codec::mesh::for_each_triangle(mesh, steps, [&](const codec::mesh::PlacedTriangle& triangle) {
        if (codec::names_colour(triangle.chart_word)) return;
        Bounds& box =
            boxes.try_emplace(triangle.chart_word, Bounds{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}}).first->second;
        for (const auto& place : triangle.places) {
            include(box, {corner[0] + to_metres(place[0]), corner[1] + to_metres(place[1]),
                          corner[2] + to_metres(place[2])});
        }
    });
    std::vector<ChartBox> out;
    out.reserve(boxes.size());
    for (auto& [chart, box] : boxes) {
        for (size_t axis = 0; axis < 3; ++axis) {
            box.min[axis] -= margin;
            box.max[axis] += margin;
        }
        out.push_back({chart, box});
    }
    std::sort(out.begin(), out.end(),
              [](const ChartBox& a, const ChartBox& b) { return a.chart_in_tile < b.chart_in_tile; });
    return out;
}

}  // namespace citystream::client
