// The states of a receiver's cells (visibility_cells.h) as decisions of the range coder, written once for both
// directions. FORMAT.md, "Visibility".
//
// A receiver is told by how it differs from two that came before it: what is hidden moves a little from one place to
// the next. Each decision is mixed from several contexts (codec/bits/mixed_bits.h): the two receivers at this cell and
// around it, the cells of the same level before this one, the greater cells around those to come, and whether the
// first of the two was right there.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/bits/mixed_bits.h"
#include "codec/radiance/visibility_cells.h"

namespace citystream::codec::radiance {

class VisibilityLevelCode {
  public:
    VisibilityLevelCode(const CellLayout& layout, uint32_t level);

    /// Codes a level of a receiver: cells whose greater cell is mixed, or all of level 0. `present` has the receiver's
    /// absent cells; `states` of the levels before, and of this one if it is to be written, are known. What is read
    /// goes into `states`.
    template <typename Coder>
    void code(Coder& coder, const CellStates& present, const CellStates& first, const CellStates& second,
              CellStates& states);

  private:
    enum Node : uint32_t { kIsMixed, kIsVisible, kNodes };
    static constexpr uint32_t kSets = kCellStates * kCellStates;
    /// The receivers that one is told by, and itself.
    struct Receivers {
        const CellStates &first, &second, &states;
    };
    template <typename Coder>
    uint8_t code_cell(Coder& coder, uint8_t told);
    void set_contexts(const Receivers& receivers, uint32_t face, uint32_t x, uint32_t y);

    const CellLayout& layout_;
    uint32_t level_;
    bits::MixedBits bits_;
    std::vector<uint32_t> mixed_;  ///< of a row of greater cells, those that are mixed
};

template <typename Coder>
uint8_t VisibilityLevelCode::code_cell(Coder& coder, uint8_t told) {
    const bool finest = level_ + 1 == kCellLevels;
    if (!finest && bits_.code(coder, kIsMixed, told == kMixed ? 1 : 0) != 0) return kMixed;
    return bits_.code(coder, kIsVisible, told == kAllVisible ? 1 : 0) != 0 ? kAllVisible : kAllHidden;
}

template <typename Coder>
void VisibilityLevelCode::code(Coder& coder, const CellStates& present, const CellStates& first,
                               const CellStates& second, CellStates& states) {
    const Receivers receivers{first, second, states};
    const uint32_t across = layout_.across(level_);
    const auto code_at = [&](uint32_t face, uint32_t x, uint32_t y) {
        const uint32_t place = layout_.place(level_, face, x, y);
        if (present.at(level_, place) == kAbsent) return;
        set_contexts(receivers, face, x, y);
        states.at(level_, place) = code_cell(coder, states.at(level_, place));
    };
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        for (uint32_t y = 0; y < across; ++y) {
            if (level_ == 0) {
                for (uint32_t x = 0; x < across; ++x) code_at(face, x, y);
                continue;
            }
            // Cells of greater ones that are not mixed are as those; rows come in pairs.
            if (y % 2 == 0) {
                states.list_mixed(layout_, level_ - 1, face, y / 2, mixed_);
                if constexpr (Coder::kDecodes) states.inherit_row(layout_, level_, face, y / 2, present);
            }
            for (const uint32_t greater : mixed_) {
                code_at(face, 2 * greater, y);
                if (2 * greater + 1 < across) code_at(face, 2 * greater + 1, y);
            }
        }
    }
}

}  // namespace citystream::codec::radiance
