// The states of a receiver's cells (visibility_cells.h) as decisions of the range coder, written once for both
// directions. FORMAT.md, "Visibility".
//
// A receiver is told by how it differs from two that came before it: what is hidden moves a little from one place to
// the next. Each decision is mixed from several contexts (cell_mixer.h): the two receivers at this cell and around it,
// the cells of the same level before this one, the greater cells around those to come, and whether the two were right
// there. Where both are all visible or all hidden around a cell of the coarsest level it is *calm*: one decision says
// of a face, or else of a row, that its calm cells are as in both, which most are.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <optional>

#include "codec/bits/range_coder.h"
#include "codec/radiance/cell_mixer.h"
#include "codec/radiance/visibility_cells.h"

namespace citystream::codec::radiance {

/// What is known of a receiver before a level of it is: its absent cells, which are those where `present` has no
/// visible bit, and the two receivers by which it is told.
struct KnownStates {
    const CellStates &present, &first, &second;
};

/// Of each row of a face of level 0 the cells that are present and calm, a bit each.
struct CalmCells {
    static constexpr uint32_t kMostAcross = kSamplesAcross * kMostCubeSide / 8;
    std::array<uint16_t, kMostAcross> rows{};
    bool any = false;
};
CalmCells calm_cells(const CellLayout& layout, uint32_t face, const KnownStates& known);
/// Whether two receivers have the same bits at these cells of a row of level 0, whose first byte is given.
bool are_alike(const CellLayout& layout, uint32_t row, uint32_t cells, const CellStates& a, const CellStates& b);
/// Gives cells that are absent the bits of another receiver.
void copy_cells(const CellLayout& layout, uint32_t row, uint32_t cells, const CellStates& from, CellStates& to);

class VisibilityLevelCode {
  public:
    VisibilityLevelCode(const CellLayout& layout, uint32_t level);

    /// Codes a level of a receiver: cells whose greater cell is mixed, or all of level 0. `states` of the levels
    /// before, and of this one if it is to be written, are known. What is read goes into `states`.
    template <typename Coder>
    void code(Coder& coder, const KnownStates& known, CellStates& states);

  private:
    static constexpr uint32_t kIsMixed = 0, kIsVisible = 1;  ///< nodes; the finest level has but one
    static constexpr uint32_t kContexts = 7;
    static std::array<uint32_t, kContexts> context_counts(uint32_t level);
    /// Sets of weights: by the states of the two receivers and how far they were right around; and those of calm cells.
    static constexpr uint32_t kPairs = 16, kRightness = 3, kCalmSet = kPairs * kRightness, kSets = kCalmSet + 3;
    /// Flags are told by what the last three were.
    static constexpr uint32_t kFlagHistories = 8;
    struct Flag {
        std::array<bits::BitModel, kFlagHistories> models;
        uint32_t history = 0;
    };

    /// The first bytes of a row of cells, and of those of the levels around it.
    struct Row {
        uint32_t face = 0, y = 0;
        const uint8_t *first = nullptr, *second = nullptr, *here = nullptr;
        /// Of the receiver itself, not of level 0: the greater cells that the row lies in, and those that the row after
        /// it lies in.
        const uint8_t *greater = nullptr, *greater_below = nullptr;
        const uint8_t* parts = nullptr;  ///< of the first receiver, of level 0 alone: the upper row of parts
    };
    Row row_of(const KnownStates& known, const CellStates& states, uint32_t face, uint32_t y) const;
    /// Of level 0, of the first receiver's cell: the states of its parts, and which sides of the ring around them have
    /// mixed ones; below the face's edge there are none.
    struct Parts {
        uint32_t states, ring;
    };
    Parts parts_around(const Row& row, uint32_t x) const;
    void set_contexts(const Row& row, uint32_t x);
    void set_finest_contexts(const Row& row, uint32_t x);
    uint32_t where(const Row& row, uint32_t x) const;

    template <typename Coder>
    static bool code_flag(Coder& coder, Flag& flag, bool told);
    template <typename Coder>
    void code_greatest(Coder& coder, const KnownStates& known, uint32_t face, CellStates& states);
    template <typename Coder>
    void code_parts(Coder& coder, const KnownStates& known, uint32_t face, CellStates& states);
    template <typename Coder>
    void code_cell(Coder& coder, uint8_t* row, uint32_t x);

    const CellLayout& layout_;
    uint32_t level_;
    CellMixer<kContexts> mixer_;
    Flag face_is_calm_, row_is_calm_;
};

template <typename Coder>
bool VisibilityLevelCode::code_flag(Coder& coder, Flag& flag, bool told) {
    const bool is_set = coder.bit(flag.models[flag.history % kFlagHistories], told ? 1 : 0) != 0;
    flag.history = 2 * flag.history + (is_set ? 1 : 0);
    return is_set;
}

template <typename Coder>
void VisibilityLevelCode::code_cell(Coder& coder, uint8_t* row, uint32_t x) {
    uint8_t& visible = row[x / 8];
    uint8_t& hidden = row[x / 8 + layout_.hidden(level_)];
    uint32_t v = visible >> x % 8 & 1, h = hidden >> x % 8 & 1;
    const bool finest = level_ + 1 == kCellLevels;
    if (!finest && mixer_.code(coder, kIsMixed, v & h) != 0) {
        v = h = 1;
    } else {
        v = mixer_.code(coder, finest ? 0u : kIsVisible, v);
        h = v ^ 1;
    }
    if constexpr (Coder::kDecodes) {
        visible = static_cast<uint8_t>(visible | v << x % 8);
        hidden = static_cast<uint8_t>(hidden | h << x % 8);
    }
}

template <typename Coder>
void VisibilityLevelCode::code_greatest(Coder& coder, const KnownStates& known, uint32_t face, CellStates& states) {
    const CalmCells calm = calm_cells(layout_, face, known);
    std::array<bool, CalmCells::kMostAcross> alike;  // of each row, of the calm cells
    for (uint32_t y = 0; y < layout_.across(0); ++y)
        alike[y] = Coder::kDecodes || are_alike(layout_, layout_.row(0, face, y), calm.rows[y], known.first, states);
    const auto all = std::all_of(alike.begin(), alike.begin() + layout_.across(0), [](bool is) { return is; });
    const bool face_alike = calm.any && code_flag(coder, face_is_calm_, all);
    for (uint32_t y = 0; y < layout_.across(0); ++y) {
        const Row row = row_of(known, states, face, y);
        const uint32_t at = layout_.row(0, face, y), calm_here = calm.rows[y];
        const bool same = calm_here != 0 && (face_alike || code_flag(coder, row_is_calm_, alike[y]));
        if (Coder::kDecodes && same) copy_cells(layout_, at, calm_here, known.first, states);
        const uint8_t* const present = known.present.at(0, at);
        uint32_t left = present[0];
        if (layout_.row_bytes(0) > 1) left |= uint32_t{present[1]} << 8;
        if (same) left &= ~calm_here;
        const auto few = static_cast<uint32_t>(std::min(std::popcount(calm_here) / 2, 2));
        for (; left != 0; left &= left - 1) {
            const auto x = static_cast<uint32_t>(std::countr_zero(left));
            set_contexts(row, x);
            if ((calm_here >> x & 1) != 0) mixer_.set_weights(kCalmSet + few);
            code_cell(coder, states.at(0, at), x);
        }
    }
}

template <typename Coder>
void VisibilityLevelCode::code_parts(Coder& coder, const KnownStates& known, uint32_t face, CellStates& states) {
    const uint32_t greater_hidden = layout_.hidden(level_ - 1);
    for (uint32_t y = 0; y < layout_.across(level_); ++y) {
        // Rows come in pairs.
        if (Coder::kDecodes && y % 2 == 0) states.inherit_row(layout_, level_, face, y / 2, known.present);
        const uint8_t* const greater = states.at(level_ - 1, layout_.row(level_ - 1, face, y / 2));
        const uint32_t at = layout_.row(level_, face, y);
        const uint8_t* const present = known.present.at(level_, at);
        std::optional<Row> of_row;
        for (uint32_t i = 0; i < layout_.row_bytes(level_ - 1); ++i) {
            for (uint32_t mixed = greater[i] & greater[i + greater_hidden]; mixed != 0; mixed &= mixed - 1) {
                if (!of_row) of_row = row_of(known, states, face, y);
                const Row& row = *of_row;
                const uint32_t x = 16 * i + 2 * static_cast<uint32_t>(std::countr_zero(mixed));
                for (uint32_t two = row_bits(present, static_cast<int32_t>(x), 2); two != 0; two &= two - 1) {
                    const uint32_t column = x + static_cast<uint32_t>(std::countr_zero(two));
                    if (level_ + 1 == kCellLevels)
                        set_finest_contexts(row, column);
                    else
                        set_contexts(row, column);
                    code_cell(coder, states.at(level_, at), column);
                }
            }
        }
    }
}

template <typename Coder>
void VisibilityLevelCode::code(Coder& coder, const KnownStates& known, CellStates& states) {
    if (Coder::kDecodes && level_ == 0) states.clear(0);
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        if (level_ == 0)
            code_greatest(coder, known, face, states);
        else
            code_parts(coder, known, face, states);
    }
}

}  // namespace citystream::codec::radiance
