#include "tiles/radiance/horizon_mesh.h"

#include <algorithm>
#include <optional>

namespace citystream::tiles::radiance {

namespace {

void add_quad(HorizonMesh& mesh, const std::array<GridPoint, 4>& corners) {
    const auto first = static_cast<uint32_t>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), corners.begin(), corners.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.triangles.push_back({first, first + 2, first + 3});
}

struct Neighbour {
    int64_t x, y;                                ///< cells from this one
    std::array<std::array<int64_t, 2>, 2> edge;  ///< between them, in cells from this one's least corner
};
constexpr std::array<Neighbour, 4> kNeighbours = {
    {{1, 0, {{{1, 0}, {1, 1}}}}, {-1, 0, {{{0, 0}, {0, 1}}}}, {0, 1, {{{0, 1}, {1, 1}}}}, {0, -1, {{{0, 0}, {1, 0}}}}}};

void add_box(HorizonMesh& mesh, const HeightGrid& heights, HeightCell cell, int64_t top) {
    const auto corner = [&](int64_t x, int64_t y, int64_t z) {
        return GridPoint{(cell.x + x) * kHeightCell, (cell.y + y) * kHeightCell, z};
    };
    add_quad(mesh, {corner(0, 0, top), corner(1, 0, top), corner(1, 1, top), corner(0, 1, top)});
    for (const auto& [x, y, edge] : kNeighbours) {
        const auto next = heights.height({cell.x + x, cell.y + y});
        const int64_t foot = std::max(next.value_or(top - kHorizonDepth), top - kHorizonDepth);
        if (foot >= top) continue;
        const auto& [from, to] = edge;
        add_quad(mesh, {corner(from[0], from[1], foot), corner(to[0], to[1], foot), corner(to[0], to[1], top),
                        corner(from[0], from[1], top)});
    }
}

}  // namespace

HorizonMesh horizon_mesh(const HeightGrid& heights, HeightCell low, HeightCell high) {
    HorizonMesh mesh;
    for (int64_t y = std::max(low.y, heights.low().y); y <= std::min(high.y, heights.high().y); ++y) {
        for (int64_t x = std::max(low.x, heights.low().x); x <= std::min(high.x, heights.high().x); ++x) {
            if (const auto top = heights.height({x, y})) add_box(mesh, heights, {x, y}, *top);
        }
    }
    return mesh;
}

}  // namespace citystream::tiles::radiance
