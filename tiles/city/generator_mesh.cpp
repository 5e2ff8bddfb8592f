#include "tiles/city/generator_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace citystream::tiles::city::procedural {
namespace {

Vec3 difference(const Point3& a, const Point3& b) {
    return {metres(a.x - b.x), metres(a.y - b.y), metres(a.z - b.z)};
}
double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vec3 scaled(const Vec3& a, double factor) {
    return {a.x * factor, a.y * factor, a.z * factor};
}

/// Texture coordinates on a fine grid: sums that differ in the last place do not reach the output.
double rounded(double repeats) {
    return std::floor(repeats * 4096 + 0.5) / 4096;
}

}  // namespace

ObjectBuilder::ObjectBuilder(std::string id, ObjectKind kind, const CityCatalog& catalog, Vec2 origin)
    : catalog_(catalog), origin_(origin) {
    object_.id = std::move(id);
    object_.kind = kind;
}

uint32_t ObjectBuilder::vertex(const Point3& at) {
    const auto found = std::find(points_.rbegin(), points_.rend(), at);
    if (found != points_.rend()) return static_cast<uint32_t>(points_.rend() - found - 1);
    points_.push_back(at);
    object_.vertices.push_back({origin_.x + metres(at.x), origin_.y + metres(at.y), metres(at.z)});
    return static_cast<uint32_t>(points_.size() - 1);
}

float ObjectBuilder::metres_per_repeat(uint32_t material) const {
    const Material& found = catalog_.materials[material];
    return found.image < 0 ? 0 : found.metres_per_repeat;
}

void ObjectBuilder::triangle(const std::array<Point3, 3>& corners, const std::array<Vec2, 3>& texcoord,
                             uint32_t material, SurfaceKind surface) {
    Triangle made;
    for (size_t i = 0; i < 3; ++i) made.vertex[i] = vertex(corners[i]);
    if (metres_per_repeat(material) > 0) made.texcoord = texcoord;
    made.material = material;
    made.surface = surface;
    object_.triangles.push_back(made);
}

void ObjectBuilder::polygon(std::span<const Point3> corners, uint32_t material, SurfaceKind surface) {
    std::array<Point3, 8> distinct;
    size_t count = 0;
    for (const Point3& corner : corners)
        if (count == 0 || !(corner == distinct[count - 1])) distinct[count++] = corner;
    while (count > 1 && distinct[count - 1] == distinct[0]) --count;
    if (count < 3) return;
    Vec3 normal{};
    for (size_t i = 2; i < count; ++i) {
        const Vec3 part = cross(difference(distinct[i - 1], distinct[0]), difference(distinct[i], distinct[0]));
        normal = {normal.x + part.x, normal.y + part.y, normal.z + part.z};
    }
    const double area = std::sqrt(dot(normal, normal));
    if (area < 1e-4) return;
    normal = scaled(normal, 1 / area);
    const double level = std::sqrt(normal.x * normal.x + normal.y * normal.y);
    const Vec3 u = level < 0.02 ? Vec3{1, 0, 0} : scaled({-normal.y, normal.x, 0}, 1 / level);
    const Vec3 v = level < 0.02 ? Vec3{0, 1, 0} : cross(normal, u);
    const double repeats = metres_per_repeat(material) > 0 ? 1.0 / static_cast<double>(metres_per_repeat(material)) : 0;
    std::array<Vec2, 8> texcoord;
    for (size_t i = 0; i < count; ++i) {
        const Vec3 at = difference(distinct[i], distinct[0]);
        texcoord[i] = {rounded(dot(at, u) * repeats), rounded(dot(at, v) * repeats)};
    }
    for (size_t i = 2; i < count; ++i)
        triangle({distinct[0], distinct[i - 1], distinct[i]}, {texcoord[0], texcoord[i - 1], texcoord[i]}, material,
                 surface);
}

void ObjectBuilder::wall(Point2 left, Point2 right, Units foot, Units head, uint32_t material) {
    polygon({lift(left, foot), lift(right, foot), lift(right, head), lift(left, head)}, material, SurfaceKind::kWall);
}

void ObjectBuilder::wall(Point2 left, Point2 right, Units foot, Units head, uint32_t material, Vec2 low, Vec2 high) {
    low = {rounded(low.x), rounded(low.y)};
    high = {rounded(high.x), rounded(high.y)};
    const std::array<Point3, 4> corner = {lift(left, foot), lift(right, foot), lift(right, head), lift(left, head)};
    triangle({corner[0], corner[1], corner[2]}, {low, {high.x, low.y}, high}, material, SurfaceKind::kWall);
    triangle({corner[0], corner[2], corner[3]}, {low, high, {low.x, high.y}}, material, SurfaceKind::kWall);
}

void ObjectBuilder::facade(Point2 left, Point2 right, Units foot, Units height, uint32_t map, uint32_t palette) {
    FacadeWall wall;
    wall.lower_left = {origin_.x + metres(left.x), origin_.y + metres(left.y), metres(foot)};
    wall.along = {metres(right.x - left.x), metres(right.y - left.y)};
    wall.height = metres(height);
    wall.map = map;
    wall.palette = palette;
    object_.facades.push_back(wall);
}

}  // namespace citystream::tiles::city::procedural
