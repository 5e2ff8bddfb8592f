// Tileable textures of walls, roofs and ground, drawn in integer arithmetic. Contrast is modest, so block compression
// keeps them. Every texture is kTextureSize square; how many metres a repeat covers is said by the caller's material.
#pragma once

#include <array>
#include <cstdint>

#include "tiles/city/city_model.h"

namespace citystream::tiles::city::procedural {

inline constexpr int kTextureSize = 128;
using Rgb = std::array<uint8_t, 3>;

/// Running bond: `across` bricks x `courses` courses (both divide kTextureSize), joints of one texel.
Image brick_texture(Rgb brick, Rgb joint, int across, int courses, uint64_t seed);
/// Smooth render with faint blotches; `strength` is the amplitude in 8-bit levels.
Image plaster_texture(Rgb colour, int strength, uint64_t seed);
/// Dressed stone or slabs: like bricks, each with its own shade, joints of two texels.
Image slab_texture(Rgb stone, Rgb joint, int across, int courses, bool bond, uint64_t seed);
/// Roof tiles or slates in overlapping rows.
Image tile_texture(Rgb tile, int across, int courses, uint64_t seed);
/// Sheet metal with upright seams.
Image sheet_texture(Rgb sheet, int seams, uint64_t seed);
/// Grainy ground: asphalt, gravel, grass. `grain` levels of noise per texel, `blotch` of noise over metres.
Image ground_texture(Rgb colour, int grain, int blotch, uint64_t seed);
/// A carriageway whose whole width is u = 0..1, driven along v: kerb lines, a dashed middle line, for `lanes` > 2 solid
/// middle and dashed lane lines.
Image road_texture(int lanes, uint64_t seed);
/// Zebra crossing: stripes along v, across the whole of u.
Image crossing_texture(uint64_t seed);

}  // namespace citystream::tiles::city::procedural
