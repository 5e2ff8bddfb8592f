// Guards the tessellator against polygons that cross themselves quadratically often.
#pragma once

#include <cstdint>
#include <span>

#include "tiles/city/city_model.h"

namespace citystream::tiles::city {

/// True when the edges of the rings (as in Triangulator::triangulate, projected) cross one another more than 2n + 64
/// times, or when that cannot be told with 2^26 pair tests.
bool too_many_crossings(std::span<const Vec2> points, std::span<const uint32_t> ring_ends);

}  // namespace citystream::tiles::city
