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

}  // namespace citystream::client
