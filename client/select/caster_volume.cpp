#include "client/select/caster_volume.h"

#include <algorithm>
#include <cmath>

namespace citystream::client {
namespace {

using codec::cross;
using codec::dot;
using codec::Vector;

Vector sum(const Vector& a, const Vector& b, double t) {
    return {a[0] + b[0] * t, a[1] + b[1] * t, a[2] + b[2] * t};
}

/// The part of an edge between two heights: its ends, or nothing.
void add_between(const Vector& a, const Vector& b, double lowest, double highest, std::vector<Vector>& out) {
    double from = 0, to = 1;
    const double rise = b[2] - a[2];
    for (const double side : {1.0, -1.0}) {
        // side * (a.z + t rise) <= limit
        const double limit = (side > 0 ? highest : -lowest) - side * a[2];
        if (side * rise > 0) {
            to = std::min(to, limit / (side * rise));
        } else if (side * rise < 0) {
            from = std::max(from, limit / (side * rise));
        } else if (limit < 0) {
            return;
        }
    }
    if (from > to) return;
    const Vector edge = sum(b, a, -1);
    out.push_back(sum(a, edge, from));
    out.push_back(sum(a, edge, to));
}

}  // namespace

CasterVolume::CasterVolume(const Camera& camera, const CasterLimits& limits) : camera_(camera), to_sun_(limits.to_sun) {
    const double height = std::max(0.0, limits.highest - limits.lowest);
    reach_ = std::min(limits.reach_metres, height / to_sun_[2]);
    const double tan_y = std::tan(camera.fov_y / 2);
    const double tan_x = tan_y * camera.width / std::max(1U, camera.height);
    std::array<Vector, 4> far{};  // around the pyramid's base
    for (size_t i = 0; i < 4; ++i) {
        const double x = i == 0 || i == 3 ? -tan_x : tan_x, y = i < 2 ? -tan_y : tan_y;
        const Vector ray = sum(sum(camera.forward, camera.right, x), camera.up, y);
        for (size_t c = 0; c < 3; ++c) far[i][c] = ray[c] * limits.view_metres;
    }
    const double lowest = limits.lowest - camera.position[2], highest = limits.highest - camera.position[2];
    for (size_t i = 0; i < 4; ++i) {
        add_between({}, far[i], lowest, highest, corners_);
        add_between(far[i], far[(i + 1) % 4], lowest, highest, corners_);
    }
    if (corners_.empty()) return;
    // Normals of a swept convex body's faces: those of the body, and across the sweep and one of its edges. The axes
    // come first: they are the box's, and the vertical is that of the cuts.
    for (const Vector& axis : {Vector{0, 0, 1}, Vector{1, 0, 0}, Vector{0, 1, 0}}) add_extent(axis);
    const Vector up{0, 0, 1};
    std::vector<Vector> faces = {camera.forward}, edges = {camera.right, camera.up};
    for (size_t i = 0; i < 4; ++i) {
        faces.push_back(cross(far[i], far[(i + 1) % 4]));
        edges.push_back(far[i]);
    }
    for (const Vector& face : faces) edges.push_back(cross(face, up));
    for (const Vector& face : faces) add_extent(face);
    for (const Vector& edge : edges) add_extent(cross(edge, to_sun_));
}

void CasterVolume::add_extent(const Vector& normal) {
    const double length = std::sqrt(dot(normal, normal));
    if (!(length > 0)) return;  // two that are parallel
    Extent extent;
    for (size_t c = 0; c < 3; ++c) extent.normal[c] = normal[c] / length;
    extent.least = extent.greatest = dot(extent.normal, corners_[0]);
    for (const Vector& corner : corners_) {
        extent.least = std::min(extent.least, dot(extent.normal, corner));
        extent.greatest = std::max(extent.greatest, dot(extent.normal, corner));
    }
    const double swept = dot(extent.normal, to_sun_) * reach_;
    extent.least += std::min(0.0, swept);
    extent.greatest += std::max(0.0, swept);
    extents_.push_back(extent);
}

bool CasterVolume::meets(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const {
    if (corners_.empty()) return false;
    const Vector shift = {origin[0] - camera_.position[0], origin[1] - camera_.position[1], -camera_.position[2]};
    Vector centre{}, half{};
    for (size_t c = 0; c < 3; ++c) {
        centre[c] = 0.5 * (bounds.min[c] + bounds.max[c]) + shift[c];
        half[c] = 0.5 * (bounds.max[c] - bounds.min[c]);
    }
    return std::all_of(extents_.begin(), extents_.end(), [&](const Extent& extent) {
        const Vector& n = extent.normal;
        const double middle = dot(n, centre);
        const double width = std::abs(n[0]) * half[0] + std::abs(n[1]) * half[1] + std::abs(n[2]) * half[2];
        return middle + width >= extent.least && middle - width <= extent.greatest;
    });
}

/// The distance from a point that moves along the ray to the sun is convex in the way it has gone.
double CasterVolume::shadow_distance(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const {
    constexpr int kThirds = 24;  // (2/3)^24 of the reach: a tenth of a metre
    const auto distance_after = [&](double way) {
        Camera moved = camera_;
        moved.position = sum(camera_.position, to_sun_, way);
        return moved.distance_to(bounds, origin);
    };
    double from = 0, to = reach_;
    for (int i = 0; i < kThirds; ++i) {
        const double third = (to - from) / 3;
        if (distance_after(from + third) <= distance_after(to - third)) {
            to -= third;
        } else {
            from += third;
        }
    }
    return std::min(distance_after(from), distance_after(to));
}

}  // namespace citystream::client
