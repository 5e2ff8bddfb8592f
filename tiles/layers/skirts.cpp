#include "tiles/layers/skirts.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::BuildTriangle;

struct BorderEdge {
    uint32_t object = 0, triangle = 0, corner = 0;
    std::array<int64_t, 6> key{};  // both ends, the lesser first
};

bool on_border(const GridPoint& a, const GridPoint& b, const GridPoint& corner, int64_t side) {
    const auto line = [](int64_t p, int64_t q, int64_t at) { return p == at && q == at; };
    return line(a.x, b.x, corner.x) || line(a.x, b.x, corner.x + side) || line(a.y, b.y, corner.y) ||
           line(a.y, b.y, corner.y + side);
}

std::array<int64_t, 6> edge_key(GridPoint a, GridPoint b) {
    if (std::tie(b.x, b.y, b.z) < std::tie(a.x, a.y, a.z)) std::swap(a, b);
    return {a.x, a.y, a.z, b.x, b.y, b.z};
}

SkirtQuad hang(const BuildObject& object, const BorderEdge& edge, int64_t depth) {
    const BuildTriangle& triangle = object.triangles[edge.triangle];
    const size_t from = edge.corner, to = (edge.corner + 1) % 3;
    const GridPoint a = object.vertices[triangle.vertex[from]], b = object.vertices[triangle.vertex[to]];
    SkirtQuad quad;
    quad.corners = {GridPoint{a.x, a.y, a.z - depth}, GridPoint{b.x, b.y, b.z - depth}, b, a};
    quad.texcoords = {triangle.texcoord[from], triangle.texcoord[to], triangle.texcoord[to], triangle.texcoord[from]};
    quad.normal = unit_normal(object.vertices[triangle.vertex[0]], object.vertices[triangle.vertex[1]],
                              object.vertices[triangle.vertex[2]]);
    quad.object = edge.object;
    quad.paint = triangle.paint;
    return quad;
}

}  // namespace

std::array<float, 3> unit_normal(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    const auto n = quadtree::triangle_normal(a, b, c);
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (length <= 0) return {0, 0, 1};
    return {static_cast<float>(n[0] / length), static_cast<float>(n[1] / length), static_cast<float>(n[2] / length)};
}

std::vector<SkirtQuad> make_skirts(std::span<const BuildObject> objects, const GridPoint& corner, int64_t side,
                                   int64_t depth) {
    std::vector<BorderEdge> edges;
    for (uint32_t o = 0; o < objects.size(); ++o) {
        if (!objects[o].ground()) continue;
        for (uint32_t t = 0; t < objects[o].triangles.size(); ++t) {
            const auto& v = objects[o].triangles[t].vertex;
            for (uint32_t k = 0; k < 3; ++k) {
                const GridPoint& a = objects[o].vertices[v[k]];
                const GridPoint& b = objects[o].vertices[v[(k + 1) % 3]];
                if (on_border(a, b, corner, side)) edges.push_back({o, t, k, edge_key(a, b)});
            }
        }
    }
    std::stable_sort(edges.begin(), edges.end(),
                     [](const BorderEdge& a, const BorderEdge& b) { return a.key < b.key; });
    std::vector<SkirtQuad> skirts;
    for (size_t i = 0; i < edges.size();) {
        size_t end = i + 1;
        while (end < edges.size() && edges[end].key == edges[i].key) ++end;
        if (end - i == 1) skirts.push_back(hang(objects[edges[i].object], edges[i], depth));
        i = end;
    }
    return skirts;
}

}  // namespace citystream::tiles::layers
