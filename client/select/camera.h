// A camera ready for selection and drawing: double-precision position, orthonormal axes, projection.
#pragma once

#include <array>
#include <cstdint>

#include "client/path/camera_path.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

struct Camera {
    std::array<double, 3> position{};  ///< metres, absolute CRS
    std::array<double, 3> right{}, up{}, forward{};
    double fov_y = 1;                ///< radians
    uint32_t width = 0, height = 0;  ///< pixels
    double near_plane = 0.1;         ///< metres; reversed-z, infinite far plane

    /// Yaw clockwise from north (+y), pitch up; right-handed, z up.
    static Camera from_sample(const CameraSample& sample, uint32_t width, uint32_t height);
    /// Pixels that one metre at distance `d` covers: height / (2 d tan(fov_y / 2)).
    double pixels_per_metre(double d) const;
    /// Distance from the camera to the nearest point of a box (bounds relative to `origin` in metres, z absolute).
    double distance_to(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const;
    /// Conservative box-frustum test (five planes).
    bool sees(const tiles::tileset::Bounds& bounds, const std::array<double, 2>& origin) const;
};

/// The camera's place as a whole grid cell and the rest, so that tiles are placed by exact integers. The position is
/// rounded to 2^-16 m first: a city far from the origin, whose camera positions carry rounding of their own, then draws
/// the same frames as one at the origin.
struct CameraCell {
    std::array<int64_t, 3> cell{};    ///< grid units
    std::array<float, 3> fraction{};  ///< metres, 0..2^-10
};
CameraCell camera_cell(const std::array<double, 3>& position);

}  // namespace citystream::client
