#include "client/render/shadow_cascades.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "codec/grid.h"
#include "codec/vector.h"

namespace citystream::client {
namespace {

using codec::cross;
using codec::dot;
using codec::Vector;

Vector scaled(const Vector& a, double s) {
    return {a[0] * s, a[1] * s, a[2] * s};
}

Vector sum(const Vector& a, const Vector& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

/// Across the light: it hangs on the sun alone.
Vector right_of(const Vector& to_sun) {
    const Vector across = {-to_sun[1], to_sun[0], 0};
    const double length = std::hypot(across[0], across[1]);
    return length > 1e-6 ? scaled(across, 1 / length) : Vector{1, 0, 0};
}

/// Of the slice that ends at a distance along the view: where its sphere's middle is on the view axis, and its radius.
struct SliceSphere {
    double along = 0, radius = 0;
};

SliceSphere slice_sphere(const Camera& camera, double end) {
    const double tangent = std::tan(camera.fov_y / 2);
    const double corner = end * tangent * std::hypot(1, static_cast<double>(camera.width) / camera.height);
    // Through the camera and the far corners, or around the far corners where that is less.
    const double along = std::min((end * end + corner * corner) / (2 * end), end);
    return {along, std::hypot(end - along, corner)};
}

Vector rounded_to(const CascadeView& view, const Vector& point) {
    Vector result{};
    for (const Vector& axis : {view.right, view.up, view.to_sun}) {
        const double steps = std::round(dot(point, axis) / view.texel_metres);
        result = sum(result, scaled(axis, steps * view.texel_metres));
    }
    return result;
}

/// Where the camera is, as its cell says.
Vector position_of(const CameraCell& cell) {
    Vector position{};
    for (size_t i = 0; i < 3; ++i)
        position[i] = std::ldexp(static_cast<double>(cell.cell[i]), -kGridBits) + static_cast<double>(cell.fraction[i]);
    return position;
}

Vector from_camera(const CascadeView& view, const CameraCell& cell) {
    return sum(view.centre, scaled(position_of(cell), -1));
}

void set_row(const Vector& axis, double scale, float row[3]) {
    for (size_t i = 0; i < 3; ++i) row[i] = static_cast<float>(axis[i] * scale);
}

/// scale * axis . (p - from) + at
void set_plane(const Vector& axis, double scale, const Vector& from, double at, float row[4]) {
    set_row(axis, scale, row);
    row[3] = static_cast<float>(at - scale * dot(axis, from));
}

}  // namespace

uint32_t shadow_side(uint32_t width, uint32_t height) {
    return std::bit_ceil(std::clamp(std::max(width, height), 512U, 2048U));
}

std::array<CascadeView, SHADOW_CASCADES> shadow_cascades(const Camera& camera, const std::array<double, 3>& to_sun,
                                                         uint32_t side) {
    // Texels that the rounding of the centre, the filter and its offset take at each side.
    constexpr double kRim = 5;
    std::array<CascadeView, SHADOW_CASCADES> views;
    for (size_t i = 0; i < views.size(); ++i) {
        CascadeView& view = views[i];
        view.to_sun = to_sun;
        view.right = right_of(to_sun);
        view.up = cross(view.to_sun, view.right);
        const SliceSphere sphere = slice_sphere(camera, kCascadeEnds[i]);
        view.texel_metres = 2 * sphere.radius / (side - 2 * kRim);
        view.depth_metres = 2 * (sphere.radius + kCasterReach);
        view.centre = rounded_to(view, sum(camera.position, scaled(camera.forward, sphere.along)));
    }
    return views;
}

FrameConstants shadow_frame(const CascadeView& view, const CameraCell& cell, uint32_t side) {
    FrameConstants frame{};
    const double half = view.texel_metres * side / 2;
    set_row(view.right, 1 / half, frame.clip_x);
    set_row(view.up, 1 / half, frame.clip_y);
    set_row(view.to_sun, 1 / view.depth_metres, frame.clip_w);
    const Vector from = from_camera(view, cell);
    for (size_t i = 0; i < 3; ++i)
        frame.camera_fraction[i] = static_cast<float>(from[i] + static_cast<double>(cell.fraction[i]));
    return frame;
}

ShadowCascade shadow_lookup(const CascadeView& view, const CameraCell& cell, uint32_t side) {
    ShadowCascade lookup{};
    const Vector from = from_camera(view, cell);
    set_plane(view.right, 1 / view.texel_metres, from, side / 2.0, lookup.column);
    set_plane(view.up, 1 / view.texel_metres, from, side / 2.0, lookup.row);
    set_plane(view.to_sun, 1 / view.depth_metres, from, 0.5, lookup.depth);
    lookup.texel_metres = static_cast<float>(view.texel_metres);
    return lookup;
}

}  // namespace citystream::client
