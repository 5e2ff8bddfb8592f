#include "codec/mesh/prism_planes.h"

#include <algorithm>
#include <bit>
#include <map>

#include "codec/mesh/lattice_code.h"

namespace citystream::codec::mesh {

namespace {

constexpr int64_t kCoordinateLimit = int64_t{1} << 30;
constexpr uint32_t kMostBits = 30;

uint32_t class_of(int64_t value, uint32_t most) {
    return std::min(static_cast<uint32_t>(std::bit_width(static_cast<uint64_t>(std::abs(value)))), most);
}

/// Takes prisms without the bits (`coarse`, in whose place the bits are put) and, when writing, with them (`fine`).
template <typename Coder>
class PlaneCoder {
  public:
    PlaneCoder(Coder& coder, uint32_t bits) : coder_(coder), bits_(bits), cell_(int64_t{1} << bits) {}

    void code(Prism& coarse, const Prism& fine) {
        const int32_t height = coarse.top - coarse.base, base = coarse.base;
        coarse.base = code_near(coarse.base, fine.base, last_base_);
        last_base_ = coarse.base;
        coarse.top = code_height(coarse.top, fine.top, height, coarse.base);
        if (coarse.top < coarse.base) coarse.top = coarse.base;
        for (size_t i = 0; i < coarse.walls.size(); ++i) code_wall(coarse, i, base, fine);
        for (size_t r = 0; r < coarse.rings.size(); ++r)
            code_ring(coarse.rings[r], Coder::kDecodes ? coarse.rings[r] : fine.rings[r], r == 0);
    }
    bool off_grid() const { return off_grid_; }
    void code_lattices(LatticeCode lattices) {
        lattices_ = std::move(lattices);
        lattices_.code_lattices(coder_);
        if (lattices_.empty() || lattices_.dropped() + bits_ <= kMostBits) return;
        lattices_.clear();
        off_grid_ = true;
    }

  private:
    /// The number in the cell of `coarse` that is next to a guess.
    int64_t in_cell(int32_t coarse, int64_t guess) const {
        return std::clamp(guess, coarse * cell_, coarse * cell_ + cell_ - 1);
    }
    int32_t checked(int32_t coarse, int64_t value) {
        value = in_cell(coarse, value);
        if (std::abs(value) < kCoordinateLimit) return static_cast<int32_t>(value);
        off_grid_ = true;
        return 0;
    }
    int32_t code_plain(int32_t coarse, int32_t fine) {
        const uint32_t low = coder_.plain_bits(bits_, static_cast<uint32_t>(fine - coarse * cell_));
        return checked(coarse, coarse * cell_ + low);
    }
    /// As the guess, or any.
    int32_t code_near(int32_t coarse, int32_t fine, int64_t guess) {
        const int64_t near = in_cell(coarse, guess);
        const uint32_t likely = near == guess ? 1 : 0;
        if (coder_.bit(as_guessed_[likely], fine == near ? 1 : 0) != 0) return checked(coarse, near);
        return code_plain(coarse, fine);
    }
    /// Something `coarse_height` above `base`: mostly as high as the last one of that height.
    int32_t code_height(int32_t coarse, int32_t fine, int32_t coarse_height, int32_t base) {
        const auto known = heights_.find(coarse_height);
        const int64_t guess = base + (known != heights_.end() ? known->second : coarse_height * cell_ + cell_ / 2);
        const int32_t told = code_near(coarse, fine, guess);
        heights_[coarse_height] = int64_t{told} - base;
        return told;
    }
    void code_wall(Prism& prism, size_t i, int32_t coarse_base, const Prism& fine) {
        PrismWall& wall = prism.walls[i];
        if (wall.kind == WallKind::kOpen) {
            wall.base = prism.base;
            return;
        }
        const int32_t wanted = Coder::kDecodes ? 0 : fine.walls[i].base;
        const bool own = wall.base != coarse_base || coder_.bit(own_base_, wanted != prism.base ? 1 : 0) != 0;
        wall.base = own ? std::min(code_near(wall.base, wanted, last_wall_base_), prism.top) : prism.base;
        if (own) last_wall_base_ = wall.base;
    }

    /// Where few lattice points are in a cell, the bits follow from the nearest.
    void code_on_lattice(Ring& ring, const Ring& fine) {
        for (size_t i = 0; i < ring.points.size(); ++i) {
            const auto coarse = ring.points[i];
            // In the lattices' own grid, which has more bits.
            const uint32_t dropped = lattices_.dropped();
            const auto middle = [&](size_t axis) {
                const int64_t at = (2 * coarse[axis] + 1) * (cell_ << dropped) / 2;
                return static_cast<int32_t>(std::clamp(at, 1 - kCoordinateLimit, kCoordinateLimit - 1));
            };
            const auto guess = lattices_.nearest_point({middle(0), middle(1)});
            for (size_t axis = 0; axis < 2; ++axis)
                ring.points[i][axis] = code_off(coarse[axis], fine.points[i][axis], guess[axis] >> dropped, 0);
        }
    }
    void code_ring(Ring& ring, const Ring& fine, bool outer) {
        if (!lattices_.empty()) return code_on_lattice(ring, fine);
        const std::vector<std::array<int32_t, 2>> coarse = ring.points;
        const size_t n = coarse.size();
        for (size_t axis = 0; axis < 2; ++axis)
            ring.points[0][axis] = code_plain(coarse[0][axis], fine.points[0][axis]);
        for (size_t i = 1; i < n; ++i) {
            const PlaneVector at = PlaneVector::of(ring.points[i - 1]);
            const PlaneVector middle = {coarse[i][0] * cell_ + cell_ / 2, coarse[i][1] * cell_ + cell_ / 2};
            const uint32_t quarter = frame_.quarter_of(middle - at);
            const size_t along = quarter & 1, across = 1 - along;
            const PlaneVector home = (PlaneVector::of(ring.points[0]) - at).turned(4 - quarter);
            PlaneVector edge = (middle - at).turned(4 - quarter);
            const bool last = i + 1 == n && n > 3;
            if (last) edge.x = frame_.along(home).whole;
            const int64_t guess = (at + PlaneVector{edge.x, 0}.turned(quarter)).*kAxes[along];
            ring.points[i][along] = last ? code_off(coarse[i][along], fine.points[i][along], guess, 0)
                                         : code_plain(coarse[i][along], fine.points[i][along]);
            // With the length known, the rest follows from the direction.
            edge.x = (PlaneVector::of(ring.points[i]) - at).*kAxes[along];
            if (quarter > 1) edge.x = -edge.x;
            const int64_t aside = frame_.across(edge.x).whole;
            const int64_t side = (at + PlaneVector{edge.x, aside}.turned(quarter)).*kAxes[across];
            ring.points[i][across] = code_off(coarse[i][across], fine.points[i][across], side, i == 1 ? 1 : 2);
            const PlaneVector told = (PlaneVector::of(ring.points[i]) - at).turned(4 - quarter);
            if (i == 1 && outer)
                frame_.start(told);
            else
                frame_.learn(told);
        }
    }
    /// A number off from a guess.
    int32_t code_off(int32_t coarse, int32_t fine, int64_t guess, uint32_t kind) {
        const int64_t near = in_cell(coarse, guess);
        const uint32_t from_cell = class_of(guess - near, 7);
        off_.set_contexts({kind, kind * 8 + from_cell, kind * 8 + last_off_});
        const int64_t off = off_.code(coder_, fine - near);
        last_off_ = class_of(off, 7);
        return checked(coarse, near + off);
    }

    static constexpr int64_t PlaneVector::*kAxes[2] = {&PlaneVector::x, &PlaneVector::y};
    Coder& coder_;
    uint32_t bits_;
    int64_t cell_;
    bits::BitModel as_guessed_[2], own_base_;
    MixedSigned off_{3, 24, 24};
    FootprintFrame frame_;
    LatticeCode lattices_;
    std::map<int32_t, int64_t> heights_;  ///< of what was told last for each coarse height
    int64_t last_base_ = 0, last_wall_base_ = 0;
    uint32_t last_off_ = 0;
    bool off_grid_ = false;
};

}  // namespace

void encode_prism_planes(bits::RangeEncoder& encoder, std::span<const Prism> told,
                         std::span<const HiddenLattice> lattices, uint32_t bits, uint32_t dropped) {
    LatticeCode lattice_code;
    lattice_code.take(lattices, dropped);
    if (lattice_code.spacing() < static_cast<double>(uint64_t{1} << (bits + dropped))) lattice_code.clear();
    PlaneCoder<bits::RangeEncoder> coder(encoder, bits);
    coder.code_lattices(std::move(lattice_code));
    for (const Prism& prism : told) {
        Prism coarse = without_low_bits(prism, dropped + bits);
        coder.code(coarse, without_low_bits(prism, dropped));
    }
}

Status decode_prism_planes(bits::RangeDecoder& decoder, std::vector<Prism>& prisms, uint32_t bits) {
    PlaneCoder<bits::RangeDecoder> coder(decoder, bits);
    coder.code_lattices({});
    for (Prism& prism : prisms) {
        coder.code(prism, prism);
        if (!decoder.ok() || coder.off_grid()) return Error{"the bits of prisms make no sense", decoder.position()};
    }
    return Done{};
}

}  // namespace citystream::codec::mesh
