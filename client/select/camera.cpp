#include "client/select/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "codec/grid.h"
#include "codec/vector.h"

namespace citystream::client {
namespace {

using codec::dot;
using codec::Vector;

constexpr int kFractionBits = 6;  // of a grid unit: 2^-16 m
/// Metres: farther away than this, cameras are taken for nearer ones.
constexpr double kFarthest = 0x1p40;

/// A box as centre (relative to the camera) and half extents.
struct CentredBox {
    Vector centre{}, half{};
};

CentredBox centre_box(const Camera& camera, const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) {
    const Vector shift = {origin[0] - camera.position[0], origin[1] - camera.position[1], -camera.position[2]};
    CentredBox box;
    for (size_t i = 0; i < 3; ++i) {
        box.centre[i] = 0.5 * (bounds.min[i] + bounds.max[i]) + shift[i];
        box.half[i] = 0.5 * (bounds.max[i] - bounds.min[i]);
    }
    return box;
}

/// Greatest signed distance (times |normal|) of the box's points along `normal`.
double greatest_along(const CentredBox& box, const Vector& normal) {
    return dot(normal, box.centre) + std::abs(normal[0]) * box.half[0] + std::abs(normal[1]) * box.half[1] +
           std::abs(normal[2]) * box.half[2];
}

Vector scaled_sum(const Vector& a, double s, const Vector& b, double t) {
    return {a[0] * s + b[0] * t, a[1] * s + b[1] * t, a[2] * s + b[2] * t};
}

}  // namespace

Camera Camera::from_sample(const CameraSample& sample, uint32_t width, uint32_t height) {
    constexpr double kRadians = std::numbers::pi / 180;
    const double yaw = sample.yaw * kRadians;
    const double pitch = sample.pitch * kRadians;
    const double sin_yaw = std::sin(yaw), cos_yaw = std::cos(yaw);
    const double sin_pitch = std::sin(pitch), cos_pitch = std::cos(pitch);
    Camera camera;
    camera.position = {sample.x, sample.y, sample.z};
    camera.forward = {sin_yaw * cos_pitch, cos_yaw * cos_pitch, sin_pitch};
    camera.right = {cos_yaw, -sin_yaw, 0};
    camera.up = {-sin_yaw * sin_pitch, -cos_yaw * sin_pitch, cos_pitch};
    camera.fov_y = sample.fov * kRadians;
    camera.width = width;
    camera.height = height;
    return camera;
}

double Camera::pixels_per_metre(double d) const {
    return height / (2 * d * std::tan(fov_y / 2));
}

double Camera::distance_to(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const {
    const CentredBox box = centre_box(*this, bounds, origin);
    double squared = 0;
    for (size_t i = 0; i < 3; ++i) {
        const double outside = std::max(0.0, std::abs(box.centre[i]) - box.half[i]);
        squared += outside * outside;
    }
    return std::sqrt(squared);
}

bool Camera::sees(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const {
    const CentredBox box = centre_box(*this, bounds, origin);
    if (greatest_along(box, forward) < near_plane) return false;
    const double tan_y = std::tan(fov_y / 2);
    const double tan_x = tan_y * width / std::max(1u, height);
    return greatest_along(box, scaled_sum(forward, tan_x, right, -1)) >= 0 &&
           greatest_along(box, scaled_sum(forward, tan_x, right, 1)) >= 0 &&
           greatest_along(box, scaled_sum(forward, tan_y, up, -1)) >= 0 &&
           greatest_along(box, scaled_sum(forward, tan_y, up, 1)) >= 0;
}

CameraCell camera_cell(const std::array<double, 3>& position) {
    CameraCell result;
    for (size_t i = 0; i < 3; ++i) {
        const int64_t fixed =
            std::llround(std::clamp(position[i], -kFarthest, kFarthest) * kGridUnitsPerMetre * (1 << kFractionBits));
        result.cell[i] = fixed >> kFractionBits;
        const int64_t rest = fixed - (result.cell[i] << kFractionBits);
        result.fraction[i] = static_cast<float>(static_cast<double>(rest) * kMetresPerGridUnit / (1 << kFractionBits));
    }
    return result;
}

}  // namespace citystream::client
