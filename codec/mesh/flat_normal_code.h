// Normals of flat triangles as range coded decisions, where the positions that are known tell them only roughly.
//
// Expected is the normal of the triangle's plane; how far it may be off follows from how thin the triangle is. Where
// that is little, asked is: is it that of the plane; is it, of those met at the triangle's points and of those met
// shortly before, also turned about the vertical by quarters (walls of one building), the one that is nearest to the
// plane's; if not, the difference is told. Where the plane stands upright the normal mostly does, too, and lies on the
// octahedron's equator: a single number.
//
// Where nothing is known of the plane, as where the known bits make a line of the triangle: is it one of those met at
// its points, two of them rather than one; else which way it faces, and for walls by how much it is turned against the
// wall before, up to quarters.
//
// One template for writer and reader (range_coder.h). Lossless on canonical codes; any bytes give some code. O(1).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/bits/mixed_bits.h"
#include "codec/bits/range_coder.h"
#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_residual.h"

namespace citystream::codec::mesh {

class FlatNormalCode {
  public:
    static constexpr uint32_t kDoubts = 16;
    /// Bits a parameter.
    explicit FlatNormalCode(uint32_t bits) : bits_(bits), side_(octahedral_side(bits)) {}

    /// `plane`: the expected code. `doubt`: how far it may be off, as the length of a binary number, below kDoubts.
    /// `met`: codes met at the triangle's points.
    template <typename Coder>
    uint64_t code(Coder& coder, uint64_t plane, uint32_t doubt, std::span<const uint64_t> met, uint64_t code);

  private:
    using Octant = std::array<int32_t, 3>;  ///< on |x| + |y| + |z| = side
    static constexpr uint32_t kRecent = 12;
    struct Nearest {
        Octant direction{};
        uint32_t distance = ~0u;
        bool turned = false;  ///< not just as it was met
    };
    /// Differences in the plane where `mirrored` directions lie in the middle.
    uint32_t distance(const Octant& a, const Octant& b, bool mirrored) const;
    Nearest nearest_to(const Octant& plane, std::span<const uint64_t> met) const;
    void remember(const Octant& direction);
    /// 0..4 side - 1, round the equator.
    int64_t along_equator(const Octant& d) const { return d[1] >= 0 ? side_ - d[0] : int64_t{3} * side_ + d[0]; }
    Octant at_equator(int64_t along) const;
    template <typename Coder>
    bool code_met(Coder& coder, uint32_t doubt, std::span<const uint64_t> met, uint64_t& code);
    template <typename Coder>
    uint64_t code_not_plane(Coder& coder, uint64_t plane, const Nearest& nearest, uint32_t doubt, uint64_t code);
    template <typename Coder>
    uint64_t code_unknown(Coder& coder, uint64_t code);
    template <typename Coder>
    uint64_t code_rest(Coder& coder, uint64_t plane, const Octant& expected, uint32_t doubt, uint64_t code);

    static uint32_t class_of(uint32_t value, uint32_t most) {
        return std::min(static_cast<uint32_t>(std::bit_width(value)), most);
    }

    uint32_t bits_;
    int32_t side_;
    std::array<Octant, kRecent> recent_{};  ///< newest first, none a turn of another
    uint32_t recent_count_ = 0;
    uint32_t history_ = 7;  ///< a bit a triangle: whether its normal was that of the plane
    bits::MixedBits is_plane_{{64, kDoubts * 2, 16 * 2 * 4}, 1};
    bits::MixedBits is_nearest_{{kDoubts * 16, 8 * 16, 2 * 16 * 2}, 1};
    bits::BitModel upright_[kDoubts];
    bits::MixedNumbers along_{{kDoubts, 8}}, across_u_{{kDoubts, 8}}, across_v_{{kDoubts * 8, 8}};
    uint32_t last_size_ = 0;

    static constexpr uint32_t kUnsure = 6, kMostAsked = 4;
    bits::BitModel is_met_[kDoubts][3][kMostAsked];
    enum Facing : uint32_t { kWall, kUp, kDown, kOther, kFacings };
    bits::BitTree facing_[kFacings] = {bits::BitTree(kFacings), bits::BitTree(kFacings), bits::BitTree(kFacings),
                                       bits::BitTree(kFacings)};
    bits::BitTree quarter_{4};
    bits::MixedNumbers turn_{{8}}, slope_u_{{8}}, slope_v_{{8}};
    Facing last_facing_ = kWall;
    int64_t last_wall_ = 0;  ///< along the equator
};

inline uint32_t FlatNormalCode::distance(const Octant& a, const Octant& b, bool mirrored) const {
    const auto place = [&](const Octant& d) -> std::array<int32_t, 2> {
        if ((mirrored ? -d[2] : d[2]) >= 0) return {d[0], d[1]};
        const int32_t u = side_ - std::abs(d[1]), v = side_ - std::abs(d[0]);
        return {d[0] < 0 ? -u : u, d[1] < 0 ? -v : v};
    };
    const auto p = place(a), q = place(b);
    return static_cast<uint32_t>(std::max(std::abs(p[0] - q[0]), std::abs(p[1] - q[1])));
}

inline FlatNormalCode::Nearest FlatNormalCode::nearest_to(const Octant& plane, std::span<const uint64_t> met) const {
    Nearest nearest;
    const bool mirrored = plane[2] < 0;
    const auto consider = [&](const Octant& d, bool turned) {
        const uint32_t off = distance(d, plane, mirrored);
        if (off < nearest.distance) nearest = {d, off, turned};
    };
    for (const uint64_t code : met) {
        if (nearest.distance == 0) return nearest;
        consider(unfold_octahedral(code, bits_), false);
    }
    for (const Octant& d : std::span(recent_).first(recent_count_)) {
        if (nearest.distance == 0) return nearest;
        consider(d, false);
        consider({-d[1], d[0], d[2]}, true);
        consider({-d[0], -d[1], d[2]}, true);
        consider({d[1], -d[0], d[2]}, true);
    }
    return nearest;
}

inline void FlatNormalCode::remember(const Octant& d) {
    uint32_t at = 0;
    const auto is_turn = [&](const Octant& o) {
        return o[2] == d[2] && ((o[0] == d[0] && o[1] == d[1]) || (o[0] == -d[1] && o[1] == d[0]) ||
                                (o[0] == -d[0] && o[1] == -d[1]) || (o[0] == d[1] && o[1] == -d[0]));
    };
    while (at < recent_count_ && !is_turn(recent_[at])) ++at;
    if (at == recent_count_) {
        recent_count_ = std::min(recent_count_ + 1, kRecent);
        at = recent_count_ - 1;
    }
    for (; at > 0; --at) recent_[at] = recent_[at - 1];
    recent_[0] = d;
}

inline FlatNormalCode::Octant FlatNormalCode::at_equator(int64_t along) const {
    const int64_t round = int64_t{4} * side_;
    along = (along % round + round) % round;
    const int64_t x = along <= int64_t{2} * side_ ? side_ - along : along - int64_t{3} * side_;
    const int64_t y = along <= int64_t{2} * side_ ? side_ - std::abs(x) : std::abs(x) - side_;
    return {static_cast<int32_t>(x), static_cast<int32_t>(y), 0};
}

template <typename Coder>
uint64_t FlatNormalCode::code(Coder& coder, uint64_t plane, uint32_t doubt, std::span<const uint64_t> met,
                              uint64_t code) {
    const bool is_unsure = doubt >= kUnsure, trusts_plane = !is_unsure || (history_ & 7) == 7;
    if ((!trusts_plane || doubt + 1 == kDoubts) && code_met(coder, doubt, met, code)) {
        history_ = history_ << 1 | (code == plane ? 1 : 0);
        remember(unfold_octahedral(code, bits_));
        return code;
    }
    if (doubt + 1 == kDoubts) return code_unknown(coder, code);
    const Octant expected = unfold_octahedral(plane, bits_);
    const Nearest nearest = nearest_to(expected, met);
    const uint32_t off = nearest.distance == ~0u ? 15 : class_of(nearest.distance, 14);
    is_plane_.set_contexts(
        {history_ & 63, doubt * 2 + (history_ & 1), (off * 2 + (is_unsure ? 1u : 0u)) * 4 + (history_ & 3)});
    const uint32_t is_plane = is_plane_.code(coder, 0, code == plane ? 1 : 0);
    history_ = history_ << 1 | is_plane;
    if (is_plane != 0) {
        code = plane;
    } else if (!trusts_plane || !is_unsure || !code_met(coder, doubt, met, code)) {
        code = code_not_plane(coder, plane, nearest, doubt, code);
    }
    remember(unfold_octahedral(code, bits_));
    return code;
}

template <typename Coder>
uint64_t FlatNormalCode::code_not_plane(Coder& coder, uint64_t plane, const Nearest& nearest, uint32_t doubt,
                                        uint64_t code) {
    const Octant expected = unfold_octahedral(plane, bits_);
    if (nearest.distance != 0 && nearest.distance != ~0u) {
        const uint64_t told = fold_octahedral(nearest.direction, bits_);
        const uint32_t off = class_of(nearest.distance, 14);
        is_nearest_.set_contexts({doubt * 16 + off, last_size_ * 16 + off,
                                  ((nearest.turned ? 1u : 0u) * 16 + off) * 2 + (expected[2] == 0 ? 1u : 0u)});
        if (is_nearest_.code(coder, 0, code == told ? 1 : 0) != 0) return told;
    }
    return code_rest(coder, plane, expected, doubt, code);
}

/// Whether it is one of those met at the points, first of all at several of them.
template <typename Coder>
bool FlatNormalCode::code_met(Coder& coder, uint32_t doubt, std::span<const uint64_t> met, uint64_t& code) {
    uint32_t asked = 0;
    for (uint32_t times = 3; times > 0; --times) {
        for (size_t i = 0; i < met.size() && asked < kMostAsked; ++i) {
            if (std::count(met.begin(), met.end(), met[i]) != times) continue;
            if (std::find(met.begin(), met.begin() + static_cast<std::ptrdiff_t>(i), met[i]) !=
                met.begin() + static_cast<std::ptrdiff_t>(i))
                continue;
            if (coder.bit(is_met_[doubt][times - 1][asked++], code == met[i] ? 1 : 0) == 0) continue;
            code = met[i];
            return true;
        }
    }
    return false;
}

template <typename Coder>
uint64_t FlatNormalCode::code_unknown(Coder& coder, uint64_t code) {
    Octant d{};
    Facing facing = kOther;
    if constexpr (!Coder::kDecodes) {
        d = unfold_octahedral(code, bits_);
        facing = d[2] == 0 ? kWall : d[2] == side_ ? kUp : d[2] == -side_ ? kDown : kOther;
    }
    facing = static_cast<Facing>(facing_[last_facing_].code(coder, facing));
    last_facing_ = facing;
    if (facing == kWall) {
        const int64_t round = int64_t{4} * side_, turned = (along_equator(d) - last_wall_ + round + side_ / 2) % round;
        const auto quarter = static_cast<int64_t>(quarter_.code(coder, static_cast<uint32_t>(turned / side_)));
        turn_.set_contexts({last_size_});
        const uint32_t folded = turn_.code(coder, bits::zigzag(static_cast<int32_t>(turned % side_ - side_ / 2)));
        last_size_ = class_of(folded, 7);
        d = at_equator(last_wall_ + quarter * side_ + bits::unzigzag(folded));
        last_wall_ = along_equator(d);
    } else if (facing == kOther) {
        const uint64_t up = fold_octahedral({0, 0, side_}, bits_);
        std::array<int32_t, 2> rest = {};
        if constexpr (!Coder::kDecodes) rest = octahedral_residual(code, up, bits_);
        slope_u_.set_contexts({last_size_});
        const uint32_t u = slope_u_.code(coder, bits::zigzag(rest[0]));
        slope_v_.set_contexts({class_of(u, 7)});
        const uint32_t v = slope_v_.code(coder, bits::zigzag(rest[1]));
        const uint64_t told = octahedral_of_residual({bits::unzigzag(u), bits::unzigzag(v)}, up, bits_);
        d = unfold_octahedral(told, bits_);
    } else {
        d = {0, 0, facing == kUp ? side_ : -side_};
    }
    remember(d);
    return fold_octahedral(d, bits_);
}

template <typename Coder>
uint64_t FlatNormalCode::code_rest(Coder& coder, uint64_t plane, const Octant& expected, uint32_t doubt,
                                   uint64_t code) {
    const Octant actual = unfold_octahedral(code, bits_);
    if (expected[2] == 0 && coder.bit(upright_[doubt], actual[2] == 0 ? 1 : 0) != 0) {
        const int64_t from = along_equator(expected), half = int64_t{2} * side_;
        const int64_t round = 2 * half;
        const int64_t change = ((along_equator(actual) - from + half) % round + round) % round - half;
        along_.set_contexts({doubt, last_size_});
        const uint32_t folded = along_.code(coder, bits::zigzag(static_cast<int32_t>(change)));
        last_size_ = class_of(folded, 7);
        return fold_octahedral(at_equator(from + bits::unzigzag(folded)), bits_);
    }
    std::array<int32_t, 2> rest = {};
    if constexpr (!Coder::kDecodes) rest = octahedral_residual(code, plane, bits_);
    across_u_.set_contexts({doubt, last_size_});
    const uint32_t u = across_u_.code(coder, bits::zigzag(rest[0]));
    across_v_.set_contexts({doubt * 8 + class_of(u, 7), last_size_});
    const uint32_t v = across_v_.code(coder, bits::zigzag(rest[1]));
    last_size_ = class_of(std::max(u, v), 7);
    return octahedral_of_residual({bits::unzigzag(u), bits::unzigzag(v)}, plane, bits_);
}

}  // namespace citystream::codec::mesh
