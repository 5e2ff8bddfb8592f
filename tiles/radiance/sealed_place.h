// Whether no light of the sky can come to a place, whatever is said about it by the sides of what is around: between
// walls that touch, inside buildings, under the ground.
#pragma once

#include <array>
#include <cstdint>

#include "tiles/radiance/occluder_scene.h"

namespace citystream::tiles::radiance {

/// Whether the sky cannot be seen from where any of about 48 rays into the half space above a surface first meets
/// something, but not further away than `hop` grid units: by 192 rays that go up. Rays that go down and meet nothing do
/// not count: below a city's ground there is nothing. Four of the rays must meet backs of triangles, too: a room that
/// shows its fronts inside is made to be looked at from there. What is in the shade of a roof or a tunnel that is open
/// somewhere near is not sealed: who stands outside sees it. Up to 9,300 rays, most often a few.
bool sealed(const OccluderScene& scene, const GridPoint& point, const std::array<double, 3>& normal, int64_t hop);

}  // namespace citystream::tiles::radiance
