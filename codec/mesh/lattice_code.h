// Points as numbers on hidden lattices (hidden_lattice.h): centimetres in our grid, map tiles' points in these, and so
// on until no coarser lattice is found; and how both travel.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/mesh/footprint_code.h"
#include "codec/mesh/hidden_lattice.h"

namespace citystream::codec::mesh {

/// Rings whose lattices were found. Variants of a layer, with more steps or fewer, have the same rings.
struct KnownLattices {
    std::vector<std::vector<HiddenLattice::Point>> rings;
    std::vector<HiddenLattice> lattices;
};

class LatticeCode {
  public:
    using Point = HiddenLattice::Point;
    static constexpr size_t kMostLattices = 3;

    /// The lattices of the rings' points, each found in the numbers of the one before; the rings become numbers on the
    /// last. Points will be told without their lowest `dropped` bits (0..30). Finding takes most of an encoder's
    /// time: `known`, if given, is asked first, and then has these rings.
    void find(std::vector<std::vector<Point>>& rings, uint32_t dropped = 0, KnownLattices* known = nullptr);
    /// Lattices that were found before.
    void take(std::span<const HiddenLattice> found, uint32_t dropped);
    /// Codes the lattices themselves; a decoder takes them over.
    template <typename Coder>
    void code_lattices(Coder& coder);
    /// Codes what a point (an encoder's) is off, given its number on the last lattice; `told` becomes the point without
    /// the dropped bits. False when a decoder's point leaves the grid.
    template <typename Coder>
    bool code_point(Coder& coder, Point number, Point point, Point& told);

    bool empty() const { return lattices_.empty(); }
    const std::vector<HiddenLattice>& lattices() const { return lattices_; }
    void clear() { lattices_.clear(); }
    uint32_t dropped() const { return dropped_; }
    /// The point of the last lattice nearest to `point`, as a point; not on the grid if `point` is far outside of it.
    Point nearest_point(Point point) const;
    /// Grid units between neighbours on the last lattice, at least.
    double spacing() const;

  private:
    static std::vector<HiddenLattice> find_lattices(std::vector<std::vector<Point>> rings);

    std::vector<HiddenLattice> lattices_;
    uint32_t dropped_ = 0;
    MixedSigned off_{16, 4 * 12, 6 * 16};
    std::array<uint32_t, 2> last_off_{};
};

}  // namespace citystream::codec::mesh
