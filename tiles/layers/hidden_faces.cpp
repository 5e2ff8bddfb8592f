#include "tiles/layers/hidden_faces.h"

#include <algorithm>
#include <cmath>

namespace citystream::tiles::layers {
namespace {

constexpr double kDownward = -0.7;

bool is_floor(const quadtree::BuildObject& object, const quadtree::BuildTriangle& triangle, int64_t bottom) {
    const bool marked = triangle.surface == city::SurfaceKind::kGround;
    if (!marked && triangle.surface != city::SurfaceKind::kUnknown) return false;
    const auto n = quadtree::triangle_normal(object.vertices[triangle.vertex[0]], object.vertices[triangle.vertex[1]],
                                             object.vertices[triangle.vertex[2]]);
    if (n[2] > kDownward * std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])) return false;
    return marked || std::all_of(triangle.vertex.begin(), triangle.vertex.end(),
                                 [&](uint32_t v) { return object.vertices[v].z == bottom; });
}

/// Detailed models have gaps round their panes, through which the floor is seen from inside.
bool has_openings(const quadtree::BuildObject& object) {
    return std::any_of(object.triangles.begin(), object.triangles.end(), [](const quadtree::BuildTriangle& t) {
        return t.surface == city::SurfaceKind::kWindow || t.surface == city::SurfaceKind::kDoor;
    });
}

}  // namespace

void drop_hidden_faces(quadtree::BuildObject& object) {
    if (object.kind != city::ObjectKind::kBuilding || has_openings(object)) return;
    const int64_t bottom = object.box().lo.z;
    std::vector<quadtree::BuildTriangle> seen;
    for (const quadtree::BuildTriangle& triangle : object.triangles) {
        if (!is_floor(object, triangle, bottom)) seen.push_back(triangle);
    }
    if (!seen.empty() || !object.facades.empty()) object.triangles = std::move(seen);
}

}  // namespace citystream::tiles::layers
