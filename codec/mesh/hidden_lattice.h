// The coarser lattice that coordinates were on before they came to our grid.
//
// Most models were written with centimetres or as the points of a map tile, then projected and moved: of the places of
// a fine grid only few are in use. Here such a lattice is found from the points alone: spacing, direction, and how both
// drift over the area (a polynomial of second degree in the lattice's own numbers, as map projections are locally). A
// point is then two small numbers on the lattice, and what is left over, mostly 0.
//
// Finding: spacings are tried against the differences along rings (how far these are from multiples of a spacing,
// against what any integers would give); then points are numbered from ring to ring, each predicted from all before it
// by recursive least squares. Deterministic: doubles with +, -, *, / only.
//
// Placing a point is done in integers, so that both sides agree to the bit.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace citystream::codec::mesh {

class HiddenLattice {
  public:
    using Point = std::array<int32_t, 2>;
    using Place = std::array<int64_t, 2>;

    /// Of each axis the coefficients of 1, i, j in 2^-32 and of i i, i j, j j in 2^-48 grid units, each below 2^62.
    /// Bits that do not matter for numbers below 2^reach are 0: the lowest dropped_bits(term).
    struct Axis {
        std::array<int64_t, 6> terms{};
    };
    std::array<Axis, 2> axes;
    uint32_t reach = 30;  ///< 0..30
    uint32_t dropped_bits(size_t term) const;

    /// Where lattice point (i, j), each below 2^30 in magnitude, lies, in 2^-16 grid units; beyond 2^46 it is cut off.
    Place place_of(Point number) const;
    /// The lattice point about nearest to a point.
    Point nearest(Point point) const;
};

/// The lattice that the points are on, or none. Rings in an order in which neighbours mostly follow each other; about
/// O(n) for n points.
std::optional<HiddenLattice> find_hidden_lattice(std::span<const std::vector<HiddenLattice::Point>> rings);

}  // namespace citystream::codec::mesh
