// What the sun's shadow maps show: cascades of squares seen along parallel light, each around a slice of what the
// camera sees (W. Engel, Cascaded Shadow Maps, ShaderX5, 2006). A slice's square holds the slice's sphere, so that its
// size does not change with the camera's turns, and its texels lie where multiples of their size lie in the world, so
// that shadows' rims do not move with the camera (M. Valient, Stable Rendering of Cascaded Shadow Maps, ShaderX6,
// 2008).
#pragma once

#include <array>

#include "client/render/draw_layout.h"
#include "client/render/light_layout.h"
#include "client/select/camera.h"

namespace citystream::client {

/// Metres from the camera where slices end.
inline constexpr std::array<double, SHADOW_CASCADES> kCascadeEnds = {60, 240, 960, 3840};
/// Metres towards the sun from which casters are seen, beyond the slice's sphere, and as far behind it.
inline constexpr double kCasterReach = 2048;

struct CascadeView {
    std::array<double, 3> right{}, up{}, to_sun{};  ///< orthonormal
    std::array<double, 3> centre{};                 ///< metres, absolute, at a multiple of texel_metres on each axis
    double texel_metres = 1;
    double depth_metres = 1;  ///< from depth 0 to 1, which is nearest to the sun; the centre has 0.5
};

/// Texels of a map for a frame of so many samples: its greater side rounded up to a power of two, 512..2048.
uint32_t shadow_side(uint32_t width, uint32_t height);

/// `to_sun`: unit vector; `side`: texels of a map, at least 64. A multiple of a texel that the camera moves by moves
/// the centres by the same.
std::array<CascadeView, SHADOW_CASCADES> shadow_cascades(const Camera& camera, const std::array<double, 3>& to_sun,
                                                         uint32_t side);

/// Of the pass that draws a cascade; positions count from the camera's cell.
FrameConstants shadow_frame(const CascadeView& view, const CameraCell& cell, uint32_t side);
/// Of its lookup, from metres counted from the camera. The address is left 0.
ShadowCascade shadow_lookup(const CascadeView& view, const CameraCell& cell, uint32_t side);

}  // namespace citystream::client
