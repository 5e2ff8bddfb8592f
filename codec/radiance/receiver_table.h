// A tile's receivers in GPU memory, and which of them light a point of its surface. RECEIVERS.md has the format.
// The lookup's twin is shaders/receiver_lookup.glsl.
//
// Receivers lie on a lattice (tiles/radiance/receiver_lattice.h): of a class of normals, in a column, at a depth. A
// point is lit by those of the four columns around it that lie on its own surface, or one much like it, weighted as
// bilinear interpolation weights the columns.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/receiver_layout.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// Where a receiver is looked up; counted from the tile's origin, which is a multiple of the spacing on all axes.
struct ReceiverPlace {
    uint32_t surface_class = 0;       ///< 0..5: +x -x +y -y +z -z
    std::array<int32_t, 2> column{};  ///< i, j: on the axes after the class's own, x before y before z before x
    int32_t depth = 0;                ///< grid units, on the class's own axis
    std::array<int8_t, 2> tilt{};     ///< the normal's components on the column's axes, its own being TILT_ONE
    friend bool operator==(const ReceiverPlace&, const ReceiverPlace&) = default;
};

/// Words of the table; receiver i is places[i], which come sorted by class, j, i, depth. `spacing_log2`:
/// RECEIVER_LEAST_SPACING..RECEIVER_MOST_SPACING. Error: places that are out of order, more than RECEIVER_MOST, 2^16 in
/// one row or columns beyond 2^15, depths of a class that span 1,023 spacings or more.
Result<std::vector<uint32_t>> write_receiver_table(std::span<const ReceiverPlace> places, uint32_t spacing_log2);

/// The receivers that light a point; weights add up to 1, or none is found.
struct ReceiverShares {
    uint32_t count = 0;
    bool own_surface = true;  ///< false: the point's surface has none here, another's stands in
    /// Of the receiver that stands in, any length. What part of the open sky's light on its own normal reaches it is
    /// what reaches the point of the open sky's light on the point's normal.
    std::array<float, 3> normal{};
    std::array<uint32_t, 4> receiver{};
    std::array<float, 4> weight{};
};

/// A checked view: neither it nor the shader can read outside the words, whatever they are.
class ReceiverTableView {
  public:
    /// Looks at everything but the entries, which may be anything, in linear time. Error: what is wrong, and the byte.
    static Result<ReceiverTableView> create(std::span<const uint32_t> words);

    uint32_t count() const { return words_[RECEIVER_WORD_COUNT]; }
    float spacing() const { return static_cast<float>(1U << words_[RECEIVER_WORD_SPACING]); }
    /// As they were written, but for depths: rounded to a 64th of the spacing. O(rows).
    std::vector<ReceiverPlace> places() const;

    /// `point`: grid units from the tile's origin. `normal`: of the surface (not a smoothed one), any length but 0.
    /// Anything may be given, also what is not finite. O(log of a column's receivers), times 6 where another surface's
    /// stands in.
    ReceiverShares shares(const std::array<float, 3>& point, const std::array<float, 3>& normal) const;

  private:
    struct Question;
    struct Choice;
    explicit ReceiverTableView(std::span<const uint32_t> words) : words_(words) {}
    uint32_t entry(uint32_t receiver) const;
    uint32_t begin_of(uint32_t begins, uint32_t column) const;
    /// The receivers of a column: first and end.
    std::array<uint32_t, 2> column(uint32_t surface_class, int32_t i, int32_t j) const;
    Question question(uint32_t surface_class, const std::array<float, 3>& point,
                      const std::array<float, 3>& normal) const;
    /// The one that serves, of those of a column.
    Choice best(const Question& question, int32_t i, int32_t j) const;
    ReceiverShares shares_of(const Question& question) const;
    ReceiverShares stand_in(const std::array<float, 3>& point, const std::array<float, 3>& normal,
                            uint32_t own_class) const;

    std::span<const uint32_t> words_;
};

}  // namespace citystream::codec::radiance
