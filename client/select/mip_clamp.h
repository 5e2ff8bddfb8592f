// The finest mip that may be shown where texels may be larger than a pixel. Without it the picture changes at once when
// a finer mip arrives. With it the mip follows the distance: a step arrives just when its mip begins to be shown, and a
// tile that takes over from its parent begins with texels as large as the parent's. At tolerances of a pixel and less
// the renderer's own choice of mips is as continuous, and no clamp is needed.
#pragma once

#include <vector>

#include "tiles/tileset/directory.h"

namespace citystream::client {

/// Of an atlas with these steps, of which the last holds mip 0, where texels may be `texel` metres large (> 0): mips
/// between two steps by the logarithm of their errors, of which selection takes the shortest prefix (shortest_prefix).
/// Mip 0 where the steps say no error. O(steps).
float clamped_mip(const std::vector<tiles::tileset::StepRecord>& steps, double texel);

/// The same of a shared chart, whose mip 0 has texels of that many metres.
float clamped_mip(double metres_per_texel, double texel);

}  // namespace citystream::client
