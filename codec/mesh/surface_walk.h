// The walk over a mesh by which its triangles and points are coded: one template for writer and reader (range_coder.h).
//
// A piece begins with one whole triangle. From then on the walk stands at a gate (mesh_border.h) and says what is
// beyond it: nothing, a new point, the point before or after on the border, or another known point. The place of a new
// point is coded at once (point_coder.h), so that what is beyond the next gate is guessed from the shape of what is
// known: the angles at both ends, how near the border comes to the completed parallelogram, how many triangles the ends
// have, and whether a point is exactly there. On an even mesh that leaves under 0.1 bits a triangle for the topology.
//
// Gates are taken newest first and, beyond a triangle, its right edge first: so successive triangles mostly share an
// edge, as in a strip that winds along the border.
//
// A known point that is not next to the gate is named by its rank among those near the expected place (near_points.h),
// first among points on the border, else among enclosed ones, else by its index. Triangles with equal corners come
// last, corner by corner.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "codec/bits/mixed_bits.h"
#include "codec/mesh/grid_mesh.h"
#include "codec/mesh/mesh_border.h"
#include "codec/mesh/near_points.h"
#include "codec/mesh/place_predictor.h"
#include "codec/mesh/point_coder.h"

namespace citystream::codec::mesh {

/// What is beyond a gate, in the order in which the walk asks.
enum class Beyond : uint8_t { kAfter, kBefore, kNew, kNothing, kKnown };

/// What both sides know beforehand.
struct WalkFrame {
    GridPoint extent{};      ///< coordinates are 0..extent[axis]
    uint32_t cell_bits = 1;  ///< of NearPoints; 1..30
    uint32_t most_points = 0, most_triangles = 0;
};

/// One corner that the walk comes to: the writer sets it, the reader's is filled.
struct WalkCorner {
    Beyond beyond = Beyond::kNothing;  ///< a writer may say kKnown for kAfter and kBefore
    uint32_t index = 0;                ///< of a known point, in the order of the walk
    GridPoint place{};                 ///< of a new one
};

/// How a point was met first: as the apex of a gate, or (all vertices the one before it) as a corner of a whole
/// triangle.
struct Origin {
    GateVertices gate;
    bool is_apex;
};

class SurfaceWalk {
  public:
    explicit SurfaceWalk(const WalkFrame& frame);

    /// Codes whether one more piece, or triangle with equal corners, follows.
    template <typename Coder>
    bool code_more(Coder& coder, bool more = false);
    /// Codes the first triangle of a piece, of three different points. False here and below: the bytes are damaged.
    template <typename Coder>
    bool code_start(Coder& coder, std::array<WalkCorner, 3> corners = {});
    /// The gate to go on with, kNone when the piece is complete.
    uint32_t gate() { return border_.next_gate(); }
    /// Codes what is beyond a gate and goes there.
    template <typename Coder>
    bool code_gate(Coder& coder, uint32_t gate, WalkCorner apex = {});
    /// Codes a triangle with equal corners, after all pieces.
    template <typename Coder>
    bool code_flat(Coder& coder, std::array<WalkCorner, 3> corners = {});

    const MeshBorder& border() const { return border_; }
    const std::vector<GridPoint>& points() const { return points_; }
    const std::vector<std::array<uint32_t, 3>>& triangles() const { return triangles_; }
    const std::vector<Origin>& origins() const { return origins_; }
    /// Of what was written so far, how many bits say where points are.
    double position_bits() const { return position_bits_; }

  private:
    template <typename Coder>
    bool code_corner(Coder& coder, std::span<const uint32_t> earlier, bool distinct, WalkCorner& corner);
    template <typename Coder>
    bool code_triangle(Coder& coder, std::array<WalkCorner, 3>& corners, bool distinct);
    template <typename Coder>
    bool code_beyond(Coder& coder, uint32_t gate, WalkCorner& apex);
    template <typename Coder>
    bool code_first_known(Coder& coder, uint32_t& index);
    template <typename Coder>
    bool code_known(Coder& coder, const GridPoint& place, std::span<const uint32_t> except, uint32_t& index);
    template <typename Coder>
    bool code_new(Coder& coder, PointRole role, const GatePlaces& places, const Origin& origin, WalkCorner& corner);

    GateVertices vertices_of(uint32_t gate) const;
    void set_gate_contexts(uint32_t gate, const GatePlaces& places);
    uint32_t presence_at(const GridPoint& place) const;
    void set_rank_contexts(const GridPoint& place, uint32_t kind);
    void gather(const GridPoint& place, std::span<const uint32_t> except, bool enclosed);
    bool find_rank(const GridPoint& place, std::span<const uint32_t> except, uint32_t index, bool enclosed,
                   uint32_t& rank);

    WalkFrame frame_;
    MeshBorder border_;
    NearPoints near_;
    PointCoder point_coder_;
    bits::MixedBits beyond_, known_, kind_of_known_;
    bits::BitModel more_;
    bits::MixedNumbers ranks_;
    bits::NumberModel first_known_;
    std::vector<GridPoint> points_;
    std::vector<Vector> errors_;  ///< of the place expected for each point
    std::vector<Origin> origins_;
    std::vector<std::array<uint32_t, 3>> triangles_;
    std::vector<std::pair<uint32_t, uint32_t>> found_;  ///< distance, index
    uint32_t history_ = 0;                              ///< what was beyond the last gates, three bits each
    uint32_t last_start_ = 0;                           ///< first point of the piece before
    uint32_t last_known_start_ = 0;
    double position_bits_ = 0;
};

template <typename Coder>
bool SurfaceWalk::code_more(Coder& coder, bool more) {
    return coder.bit(more_, more ? 1 : 0) != 0;
}

template <typename Coder>
bool SurfaceWalk::code_known(Coder& coder, const GridPoint& place, std::span<const uint32_t> except, uint32_t& index) {
    enum Kind : uint32_t { kOnBorder, kEnclosed, kAnywhere };
    uint32_t kind = kOnBorder, rank = 0;
    if constexpr (!Coder::kDecodes) {
        kind = border_.enclosed(index) ? kEnclosed : kOnBorder;
        if (!find_rank(place, except, index, kind == kEnclosed, rank)) kind = kAnywhere;
    }
    kind_of_known_.set_contexts({history_ & 511, (history_ & 7) * 3 + presence_at(place)});
    const bool anywhere = kind_of_known_.code(coder, 0, kind == kAnywhere ? 1 : 0) != 0;
    if (anywhere) {
        const auto count = static_cast<uint32_t>(points_.size());
        index = coder.plain_bits(size_class(count), index);
        return index < count;
    }
    kind = kind_of_known_.code(coder, 1, kind);
    if constexpr (Coder::kDecodes) gather(place, except, kind == kEnclosed);
    set_rank_contexts(place, kind);
    rank = ranks_.code(coder, rank);
    if constexpr (Coder::kDecodes) {
        if (rank >= found_.size()) return false;
        const auto place_of_rank = found_.begin() + rank;
        if (rank == 0)  // mostly, and found in one pass
            std::iter_swap(place_of_rank, std::min_element(found_.begin(), found_.end()));
        else
            std::nth_element(found_.begin(), place_of_rank, found_.end());
        index = place_of_rank->second;
    }
    return true;
}

/// The known point that a piece begins at, by how far it is from the one before in the order of the walk.
template <typename Coder>
bool SurfaceWalk::code_first_known(Coder& coder, uint32_t& index) {
    const uint32_t step = bits::zigzag(static_cast<int32_t>(index - last_known_start_));
    index = last_known_start_ + static_cast<uint32_t>(bits::unzigzag(first_known_.code(coder, step)));
    if (index >= points_.size()) return false;
    last_known_start_ = index;
    return true;
}

template <typename Coder>
bool SurfaceWalk::code_new(Coder& coder, PointRole role, const GatePlaces& places, const Origin& origin,
                           WalkCorner& corner) {
    if (points_.size() >= frame_.most_points) return false;
    double before = 0;
    if constexpr (!Coder::kDecodes) before = coder.cost();
    if (!point_coder_.code(coder, role, places, corner.place)) return false;
    if constexpr (!Coder::kDecodes) position_bits_ += coder.cost() - before;
    corner.index = border_.add_vertex();
    points_.push_back(corner.place);
    errors_.push_back(point_coder_.last_error());
    near_.add(corner.place);
    origins_.push_back(origin);
    return true;
}

/// A corner of a triangle that is not entered through a gate; whether it differs from the earlier corners is known.
template <typename Coder>
bool SurfaceWalk::code_corner(Coder& coder, std::span<const uint32_t> earlier, bool distinct, WalkCorner& corner) {
    const auto ordinal = static_cast<uint32_t>(earlier.size());
    const uint32_t last = ordinal > 0 ? earlier.back() : last_start_;
    const GridPoint a = points_.empty() ? GridPoint{} : points_[last];
    const GridPoint b = ordinal > 0 ? points_[earlier.front()] : a;
    known_.set_contexts({ordinal * 8 + (history_ & 7)});
    const bool known = !points_.empty() && known_.code(coder, 0, corner.beyond == Beyond::kKnown ? 1 : 0) != 0;
    history_ = history_ << 1 | (known ? 1 : 0);
    if (known && ordinal == 0) return code_first_known(coder, corner.index);
    if (known) return code_known(coder, a, earlier.first(distinct ? ordinal : 0), corner.index);
    const GatePlaces places = {a, b, b, a, b, a, b, {}, {}, {}};
    return code_new(coder, static_cast<PointRole>(ordinal), places, {{last, last, last, last, last, last, last}, false},
                    corner);
}

template <typename Coder>
bool SurfaceWalk::code_triangle(Coder& coder, std::array<WalkCorner, 3>& corners, bool distinct) {
    if (triangles_.size() >= frame_.most_triangles) return false;
    std::array<uint32_t, 3> t{};
    for (size_t i = 0; i < 3; ++i) {
        if (!code_corner(coder, std::span(t).first(i), distinct, corners[i])) return false;
        t[i] = corners[i].index;
    }
    last_start_ = t[0];
    triangles_.push_back(t);
    return !distinct || (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
}

template <typename Coder>
bool SurfaceWalk::code_start(Coder& coder, std::array<WalkCorner, 3> corners) {
    if (!code_triangle(coder, corners, true)) return false;
    border_.start(triangles_.back());
    return true;
}

template <typename Coder>
bool SurfaceWalk::code_flat(Coder& coder, std::array<WalkCorner, 3> corners) {
    return code_triangle(coder, corners, false);
}

/// Asks one question after the other; the last one is not asked.
template <typename Coder>
bool SurfaceWalk::code_beyond(Coder& coder, uint32_t index, WalkCorner& apex) {
    const GateVertices gate = vertices_of(index);
    const GatePlaces places = places_of(gate, points_, errors_);
    const uint32_t before = gate.before, after = gate.after;
    const bool can_after = after != gate.a, can_before = before != gate.b && before != after;
    if (apex.beyond == Beyond::kKnown && can_after && apex.index == after) apex.beyond = Beyond::kAfter;
    if (apex.beyond == Beyond::kKnown && can_before && apex.index == before) apex.beyond = Beyond::kBefore;
    set_gate_contexts(index, places);
    const auto is = [&](Beyond beyond) {
        const uint32_t asked = apex.beyond == beyond ? 1 : 0;
        if (beyond_.code(coder, static_cast<uint32_t>(beyond), asked) == 0) return false;
        apex.beyond = beyond;
        return true;
    };
    if (!(can_after && is(Beyond::kAfter)) && !(can_before && is(Beyond::kBefore)) && !is(Beyond::kNew) &&
        !is(Beyond::kNothing))
        apex.beyond = Beyond::kKnown;
    history_ = history_ << 3 | static_cast<uint32_t>(apex.beyond);
    if (apex.beyond == Beyond::kAfter) apex.index = after;
    if (apex.beyond == Beyond::kBefore) apex.index = before;
    if (apex.beyond == Beyond::kNew) return code_new(coder, PointRole::kApex, places, {gate, true}, apex);
    if (apex.beyond != Beyond::kKnown) return true;
    const std::array<uint32_t, 5> except = {gate.a, gate.b, gate.c, before, after};
    return code_known(coder, point_coder_.parallelogram(places), except, apex.index) && apex.index != gate.a &&
           apex.index != gate.b;
}

template <typename Coder>
bool SurfaceWalk::code_gate(Coder& coder, uint32_t index, WalkCorner apex) {
    const uint32_t from = border_.gate(index).from, to = border_.gate(index).to;
    if (!code_beyond(coder, index, apex)) return false;
    if (apex.beyond == Beyond::kNothing) {
        border_.leave(index);
        return true;
    }
    if (triangles_.size() >= frame_.most_triangles) return false;
    border_.attach(index, apex.index);
    triangles_.push_back({to, from, apex.index});
    return true;
}

}  // namespace citystream::codec::mesh
