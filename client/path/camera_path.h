// Recorded camera paths: CSV with the header t,x,y,z,yaw,pitch,fov.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "codec/result.h"

namespace citystream::client {

/// One camera: position in metres of the city's CRS; degrees: yaw clockwise from north, pitch up, vertical field of
/// view.
struct CameraSample {
    double t = 0;  ///< seconds
    double x = 0, y = 0, z = 0;
    double yaw = 0, pitch = 0, fov = 60;
};

/// A path with at least one sample, times strictly growing.
struct CameraPath {
    std::vector<CameraSample> samples;
    double duration() const { return samples.back().t - samples.front().t; }
    /// Linear in between (yaw the short way round), clamped to the ends.
    CameraSample at(double t) const;
};

/// Parses CSV text; columns may come in any order. One clear error with line and column name on bad input.
Result<CameraPath> parse_camera_path(std::span<const char> text);
Result<CameraPath> read_camera_path(const std::string& file);

}  // namespace citystream::client
