// The walls of a building that can carry relief: vertical planes with the rectangle that wall, window and door polygons
// cover on them, and their coordinates.
#pragma once

#include <cmath>
#include <vector>

#include "tiles/city/city_model.h"
#include "tiles/layers/relief_extraction.h"

namespace citystream::tiles::layers::relief {

/// Metres in a wall's frame: u to the right, v up, w outwards; (0, 0, 0) is the rectangle's lower left corner.
struct Point {
    double u = 0, v = 0, w = 0;
};

inline Point operator-(const Point& a, const Point& b) {
    return {a.u - b.u, a.v - b.v, a.w - b.w};
}
inline Point operator+(const Point& a, const Point& b) {
    return {a.u + b.u, a.v + b.v, a.w + b.w};
}
inline Point operator*(const Point& a, double s) {
    return {a.u * s, a.v * s, a.w * s};
}
inline double dot(const Point& a, const Point& b) {
    return a.u * b.u + a.v * b.v + a.w * b.w;
}
inline Point cross(const Point& a, const Point& b) {
    return {a.v * b.w - a.w * b.v, a.w * b.u - a.u * b.w, a.u * b.v - a.v * b.u};
}
inline double length(const Point& a) {
    return std::sqrt(dot(a, a));
}

struct WallFrame {
    city::Vec3 origin;
    city::Vec2 along;  ///< unit; the outward normal is (along.y, -along.x)
    double width = 0, height = 0;
    double area = 0;  ///< of the polygons that made it

    Point local(const city::Vec3& p) const {
        const double x = p.x - origin.x, y = p.y - origin.y;
        return {x * along.x + y * along.y, p.z - origin.z, x * along.y - y * along.x};
    }
    city::Vec3 world(const Point& p) const {
        return {origin.x + along.x * p.u + along.y * p.w, origin.y + along.y * p.u - along.x * p.w, origin.z + p.v};
    }
};

/// Planes of at least `options.least_area`, largest first. Triangles of walls, windows and doors are grouped by
/// direction (4 degrees) and offset (0.6 m); a group's direction is the mean of those within a degree of its largest
/// triangle, its offset the median, both weighted by area. O(triangles x planes).
std::vector<WallFrame> find_wall_frames(const city::CityObject& object, const ReliefExtractionOptions& options);

}  // namespace citystream::tiles::layers::relief
