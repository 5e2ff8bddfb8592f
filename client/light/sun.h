// A sun: parallel light, apart from the sky's, so that shadow maps can draw its sharp shadows.
#pragma once

#include "client/light/environment_map.h"

namespace citystream::client {

/// Half of the disc's 0.533 degrees.
inline constexpr double kSunRadius = 0.00465;

struct Sun {
    Direction direction{0, 0, 1};        ///< unit vector towards it
    LightSum irradiance{};               ///< on a surface that faces it: radiance times solid angle
    double angular_radius = kSunRadius;  ///< radians
};

}  // namespace citystream::client
