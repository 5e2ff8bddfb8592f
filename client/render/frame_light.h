// The light of a frame, for scenes that ask for it (citystream-fly --environment): the seam between client/light, which
// makes it, and the renderer. Without it a frame is lit as lighting_layout.h says, and nothing of the radiance layer is
// asked for, made or bound.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "client/light/environment_map.h"
#include "client/light/spherical_harmonics.h"
#include "client/light/sun.h"
#include "codec/radiance/source_light.h"

namespace citystream::client {

/// Everything but `exposure` and `sun` is the same where `number` is the same: the light passes run for a tile when it
/// has not seen this number yet, or when its words are new.
struct FrameLight {
    uint64_t number = 0;
    codec::radiance::WholeLight sky;  ///< 6 n^2 texels without the sun, radiance times solid angle
    uint32_t texels_across = 0;       ///< n, of the city's radiance layers
    HarmonicLight ambient;            ///< of the same sky: for surfaces without receivers
    EnvironmentMap background;        ///< of the same sky, in the world's axes (yaw 0)
    std::optional<Sun> sun;           ///< apart from the sky
    float exposure = 1;               ///< factor from radiance to what tone.glsl takes
};

}  // namespace citystream::client
