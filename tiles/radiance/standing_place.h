// Where a receiver stands: at a place of its surface whose light is typical of what it lights.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "tiles/radiance/lattice_piece.h"
#include "tiles/radiance/occluder_scene.h"
#include "tiles/radiance/receiver_lattice.h"

namespace citystream::tiles::radiance {

/// The receiver's own point, unless an even sky's light there is more than 4 % of the open sky's off what is fitted to
/// its surface at the column: a plane through the light of 6 x 6 places of the surface's bounds in the column's square
/// by least squares, weighted as interpolation does, without those that see nothing. Then, of the places that come
/// nearest to that, one that is not buried. Nothing where no place is lit and the point is sealed (sealed_place.h):
/// nobody sees it. `surface`: what the receiver lights, triangles of its class; they count as far as their normals are
/// its own but for 8 degrees. 75 rays a place, 50 for each that is tried.
std::optional<GridPoint> standing_place(const OccluderScene& scene, const Receiver& receiver,
                                        std::span<const ClassTriangle* const> surface, int64_t spacing);

}  // namespace citystream::tiles::radiance
