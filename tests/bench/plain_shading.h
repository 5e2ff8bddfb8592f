// What renderers do without a transfer: light that knows of shadows little or nothing.
#pragma once

#include "tests/bench/irradiance_model.h"

namespace citystream::bench {

/// Ambient light in nine spherical harmonics by the normal alone, no shadow (Ramamoorthi and Hanrahan 2001). 0 bytes.
IrradianceModel ambient_light(const RadianceSample& sample);

/// A shadow map and nothing else: the brightest texel is a sun, which a receiver sees by quarters as its bits have it
/// (a shadow map with percentage-closer filtering gives no more); the rest as ambient_light. 0 bytes.
IrradianceModel shadow_map_only(const RadianceSample& sample);

/// Ambient occlusion and bent normal (Landis, Production-Ready Global Illumination, 2002): the part of a uniform sky's
/// light that arrives, and the mean direction that it comes from, at which unshadowed light is looked up. Four bytes a
/// receiver, 8 bits each, entropy coded.
IrradianceModel bent_normals(const RadianceSample& sample);

}  // namespace citystream::bench
