// Where light is gathered: a lattice of the world, not of the mesh, laid over each tile's surfaces.
//
// A *class* is one of the six directions +x -x +y -y +z -z (numbers as the cube's faces, source_directions.h). A
// surface is of the class that its normal leans to most; near ties (within 1 : kTie) it is of both, so that whoever
// looks a point up need not round as this code does. Seen along its class, a surface lies over the *columns* of a
// lattice of spacing s in the two other axes: (y, z), (z, x) or (x, y). Column (i, j) is at the world's grid
// coordinates (i * s, j * s), so neighbouring tiles have columns in common.
//
// Every surface in the open square of side 2s around a column, where bilinear interpolation gives the column a weight,
// wants a *receiver* of the column: a point of the surface, as near to the column as can be that is not buried
// (occluder_scene.h); where all points that are tried are, the nearest one, unless it is enclosed: models have walls
// that face the wrong way, ground goes on below buildings, and walls below the ground. Surfaces that lie closer to each
// other than s / 2 at the column (their planes there: the receiver's `depth`) and whose normals are less than
// kShareDegrees apart share one: the nearest to the column that is not buried has it, of equals the outermost. So
// walls, roofs and ground have receivers of their own, creases split, and the mesh's vertices, triangles, levels and
// steps need to know nothing of it.
//
// A receiver lights as far as its column's weight goes, and stands where its surface's light is typical
// (standing_place.h): so the dark line under an eave or beside a chimney does not darken a whole wall or roof. Its
// plane and tilts stay those of the surface nearest to the column. One of whose surface nothing can be seen, such as a
// wall that a neighbour's wall covers, or the ground inside a house, is left out: what lies beside it is lit by others.
//
// What receivers a column has is decided slab by slab, of s in depth, even slabs before odd ones: it depends on nothing
// but the triangles within a few s of it. Two tiles that are given the same triangles around a column they share make
// the same receivers of it, in whatever order the triangles come.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/receiver_table.h"
#include "tiles/radiance/occluder_scene.h"
#include "tiles/radiance/surface_triangle.h"

namespace citystream::tiles::radiance {

inline constexpr uint32_t kReceiverClasses = 6;
inline constexpr int64_t kTie = 64;
inline constexpr double kShareDegrees = 28;
/// A normal's two lesser components over the greatest one, in units of 1 / kTiltOne: -kTiltOne..kTiltOne.
inline constexpr int32_t kTiltOne = 127;
/// Around a column triangles within this many spacings decide about its receivers; what is buried is decided by the
/// scene's reach besides.
inline constexpr int64_t kDecisiveSpacings = 10;

struct Receiver {
    uint8_t surface_class = 0;
    std::array<int64_t, 2> column{};  ///< i, j
    int64_t depth = 0;                ///< grid coordinate on the class's axis of the surface's plane at the column
    std::array<int8_t, 2> tilt{};     ///< on the column's axes
    GridPoint point;                  ///< on the surface
    friend bool operator==(const Receiver&, const Receiver&) = default;
};

/// The axes 0 x, 1 y, 2 z of a class: its own, and those of its columns.
constexpr std::array<uint32_t, 3> class_axes(uint32_t surface_class) {
    const uint32_t own = surface_class / 2;
    return {own, (own + 1) % 3, (own + 2) % 3};
}
constexpr int64_t class_sign(uint32_t surface_class) {
    return surface_class % 2 == 0 ? 1 : -1;
}

/// Unit normal that class and tilt stand for.
std::array<double, 3> receiver_normal(uint32_t surface_class, const std::array<int8_t, 2>& tilt);

/// Order of receivers in a tile: class, j, i, depth, then what is left.
std::strong_ordering operator<=>(const Receiver& a, const Receiver& b);

struct LatticeOptions {
    int64_t spacing = int64_t{2} << kGridBits;  ///< grid units: a power of two, 2^6..2^20
    uint32_t jobs = 0;                          ///< threads; 0: one a core. The receivers do not depend on it
    /// Receivers that less light hangs on than this are left out: parts of spacing^2, of the surface seen along the
    /// class, weighted as bilinear interpolation weights it. Others of the surface light it then, or, where it is small
    /// altogether, a neighbouring surface's (codec/radiance/RECEIVERS.md). 0: none is left out.
    double least_share = 1.0 / 32;
};

/// The receivers that the surfaces `own` want, in order. `around`: triangles of neighbouring tiles, at least all within
/// kDecisiveSpacings. `scene` holds both, also what is further away but within reach. Triangles that are thinner than
/// kThinnest want none. O(columns under triangles), 50 rays each point that is tried, and 2,800 rays a receiver; 9,300
/// for one that is left out because nothing of it can be seen.
std::vector<Receiver> place_receivers(std::span<const SurfaceTriangle> own, std::span<const SurfaceTriangle> around,
                                      const OccluderScene& scene, const LatticeOptions& options);

/// As the GPU's table has them (codec/radiance/receiver_table.h): counted from `origin`, a multiple of the spacing on
/// each axis that is within 2^31 grid units of them.
std::vector<codec::radiance::ReceiverPlace> places_of(std::span<const Receiver> receivers, const GridPoint& origin,
                                                      int64_t spacing);

/// Grid units (4 mm): rounding turns the planes of thinner triangles by degrees.
inline constexpr int64_t kThinnest = 4;

}  // namespace citystream::tiles::radiance
