// Builds one CityObject from polygons in grid units: welds vertices, maps textures in metres, drops what is degenerate.
#pragma once

#include <span>
#include <string>

#include "tiles/city/city_model.h"
#include "tiles/city/generator_layout.h"
#include "tiles/city/generator_plots.h"

namespace citystream::tiles::city::procedural {

struct Point3 {
    Units x = 0, y = 0, z = 0;
    friend bool operator==(const Point3&, const Point3&) = default;
};

inline Point3 lift(Point2 at, Units z) {
    return {at.x, at.y, z};
}

class ObjectBuilder {
  public:
    ObjectBuilder(std::string id, ObjectKind kind, const CityCatalog& catalog, Vec2 origin);

    /// A flat convex polygon, counter-clockwise from outside. Its texture runs level along u and up the slope along v,
    /// from the first corner. Corners that repeat their predecessor and polygons without area are dropped.
    void polygon(std::span<const Point3> corners, uint32_t material, SurfaceKind surface);
    void polygon(std::initializer_list<Point3> corners, uint32_t material, SurfaceKind surface) {
        polygon(std::span<const Point3>(corners.begin(), corners.size()), material, surface);
    }

    /// One triangle whose texture coordinates the caller knows.
    void triangle(const std::array<Point3, 3>& corners, const std::array<Vec2, 3>& texcoord, uint32_t material,
                  SurfaceKind surface);

    /// The upright rectangle over the line from `left` to `right` (seen from outside).
    void wall(Point2 left, Point2 right, Units foot, Units head, uint32_t material);
    /// The same; its lower left corner shows `low` of the image, its upper right one `high`.
    void wall(Point2 left, Point2 right, Units foot, Units head, uint32_t material, Vec2 low, Vec2 high);
    void facade(Point2 left, Point2 right, Units foot, Units height, uint32_t map, uint32_t palette);

    CityObject finish() { return std::move(object_); }

  private:
    uint32_t vertex(const Point3& at);
    float metres_per_repeat(uint32_t material) const;

    CityObject object_;
    std::vector<Point3> points_;  // of object_.vertices, in grid units
    const CityCatalog& catalog_;
    Vec2 origin_;
};

/// Units to metres; exact.
constexpr double metres(Units units) {
    return static_cast<double>(units) / static_cast<double>(kMetre);
}

}  // namespace citystream::tiles::city::procedural
