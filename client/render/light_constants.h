// A frame's light (frame_light.h) as the numbers that shaders take, but for what lies in buffers.
#pragma once

#include "client/render/frame_light.h"
#include "client/render/light_layout.h"
#include "codec/result.h"

namespace citystream::client {

/// What is wrong with a light: sky and map of other sizes than they say or than the passes take, values that are
/// negative or not finite, a sun whose direction is no unit vector.
Status check_light(const FrameLight& light);
/// The same of what may change while a light's number stays.
Status check_sun_and_exposure(const FrameLight& light);

/// Above the horizon, and not dark. From below it nothing of a city is reached: the ground is in the way.
bool lights_surfaces(const Sun& sun);

/// Ambient terms, sun and disc. Of a sun that lights no surfaces there is the disc alone. `irradiance_unit`: what a
/// value of 1 in irradiance words stands for; `map_scale`: map_texels.h. Addresses and cascades are left 0.
LightConstants light_constants(const FrameLight& light, const std::array<float, 3>& irradiance_unit, float map_scale);

/// Shown light of a white surface under the open sky: what shaders/surface_light.glsl makes of the terms, never
/// negative.
std::array<double, 3> open_sky_light(const LightConstants& constants, const std::array<double, 3>& unit_normal);

}  // namespace citystream::client
