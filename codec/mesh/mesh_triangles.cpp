#include "codec/mesh/mesh_triangles.h"

#include <algorithm>
#include <cassert>

#include "codec/mesh/octahedral.h"
#include "codec/mesh/precision.h"
#include "codec/mesh/triangle_plane.h"

namespace citystream::codec::mesh {

namespace {

constexpr uint32_t kCorners = 3;

/// A triangle of the surface or of a prism; `corners` is null for the latter.
using VisitCorners = std::function<void(const PlacedTriangle&, const MeshTriangle* corners)>;

void visit_all(const MeshContent& content, uint32_t steps, const VisitCorners& visit) {
    assert(steps >= 1 && steps <= content.dropped.size());
    const uint32_t dropped = content.dropped[steps - 1];
    PlacedTriangle out;
    for (const MeshPrism& prism : content.prisms) {
        for_each_prism_triangle(prism.shape, [&](const std::array<GridPoint, kCorners>& words, PrismFace face) {
            for (uint32_t k = 0; k < kCorners; ++k) out.places[k] = shown_place(words[k], dropped);
            out.chart_word = chart_of(prism, face);
            visit(out, nullptr);
        });
    }
    for (const MeshTriangle& triangle : content.triangles) {
        for (uint32_t k = 0; k < kCorners; ++k) {
            const uint32_t point = triangle.corners[k].point;
            const uint32_t most = content.most_dropped.empty() ? dropped : content.most_dropped[point];
            out.places[k] = shown_place(content.points[point], std::min(dropped, most));
        }
        out.chart_word = triangle.chart_word;
        out.dressed = triangle.dressed;
        visit(out, &triangle);
    }
}

void add_vertex(MeshTile& tile, const GridPoint& place, const Direction& normal, const std::array<int32_t, 2>& at) {
    MeshVertex vertex{};
    for (size_t c = 0; c < 3; ++c) {
        vertex.position[c] = place[c];
        vertex.normal[c] = static_cast<float>(normal[c]);
    }
    std::copy(at.begin(), at.end(), vertex.texcoord);
    tile.indices.push_back(static_cast<uint32_t>(tile.vertices.size()));
    tile.vertices.push_back(vertex);
}

}  // namespace

void for_each_prism_triangle(const Prism& prism,
                             const std::function<void(const std::array<GridPoint, 3>&, PrismFace)>& visit) {
    std::vector<std::array<int32_t, 2>> places;
    for (const Ring& ring : prism.rings) places.insert(places.end(), ring.points.begin(), ring.points.end());
    const auto at = [&](uint32_t place, int32_t height) {
        return GridPoint{places[place][0], places[place][1], height};
    };
    uint32_t begin = 0;
    for (const Ring& ring : prism.rings) {
        const auto n = static_cast<uint32_t>(ring.points.size());
        for (uint32_t i = 0; i < n; ++i) {
            const PrismWall& wall = prism.walls[begin + i];
            if (wall.kind == WallKind::kOpen) continue;
            const uint32_t p = begin + i, q = begin + (i + 1) % n;
            const GridPoint p0 = at(p, wall.base), q0 = at(q, wall.base), p1 = at(p, prism.top), q1 = at(q, prism.top);
            const bool rising = wall.kind == WallKind::kRising;
            visit({p0, q0, rising ? q1 : p1}, PrismFace::kWall);
            visit({rising ? p0 : q0, q1, p1}, PrismFace::kWall);
        }
        begin += n;
    }
    for (const auto& [a, b, c] : prism.top_triangles)
        visit({at(a, prism.top), at(b, prism.top), at(c, prism.top)}, PrismFace::kTop);
    for (const auto& [a, b, c] : prism.floor_triangles)
        visit({at(a, prism.base), at(b, prism.base), at(c, prism.base)}, PrismFace::kFloor);
}

uint32_t chart_of(const MeshPrism& prism, PrismFace face) {
    if (face == PrismFace::kWall) return prism.wall_chart;
    return face == PrismFace::kTop ? prism.top_chart : prism.floor_chart;
}

GridPoint shown_place(const GridPoint& word, uint32_t dropped) {
    const auto offset = static_cast<int32_t>(reading_offset(Reconstruction::kThirds, dropped));
    GridPoint place{};
    for (size_t c = 0; c < 3; ++c) place[c] = (word[c] >> dropped << dropped) + offset - kMeshBias;
    return place;
}

void for_each_triangle(const MeshContent& content, uint32_t steps,
                       const std::function<void(const PlacedTriangle&)>& visit) {
    visit_all(content, steps, [&](const PlacedTriangle& triangle, const MeshTriangle*) { visit(triangle); });
}

uint64_t triangle_count(const MeshContent& content) {
    uint64_t count = content.triangles.size();
    for (const MeshPrism& prism : content.prisms) {
        const Prism& shape = prism.shape;
        for (const PrismWall& wall : shape.walls) count += wall.kind == WallKind::kOpen ? 0 : 2;
        count += shape.top_triangles.size() + shape.floor_triangles.size();
    }
    return count;
}

MeshTile to_tile(const MeshContent& content, uint32_t steps) {
    MeshTile tile;
    // Two rounds: dressed triangles may stand anywhere in the content.
    for (const bool dressed : {false, true}) {
        if (dressed) tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
        visit_all(content, steps, [&](const PlacedTriangle& triangle, const MeshTriangle* surface) {
            if ((surface != nullptr && surface->dressed) != dressed) return;
            const Direction plane = plane_normal(triangle.places);
            for (uint32_t k = 0; k < kCorners; ++k) {
                if (surface == nullptr) {
                    add_vertex(tile, triangle.places[k], plane, {});
                } else {
                    const MeshCorner& corner = surface->corners[k];
                    add_vertex(tile, triangle.places[k], unpack_octahedral(corner.normal, content.normal_bits),
                               corner.texcoord);
                }
            }
            tile.triangle_chart.push_back(triangle.chart_word);
        });
    }
    return tile;
}

}  // namespace citystream::codec::mesh
