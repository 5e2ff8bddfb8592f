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

    template <typename Coder>
    uint8_t code_cell(Coder& coder, uint8_t told);
    void set_contexts(const CellStates& first, const CellStates& second, const CellStates& states, uint32_t face,
                      uint32_t x, uint32_t y, uint32_t place);

    const CellLayout& layout_;
    uint32_t level_;
    bits::MixedBits bits_;
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
    const uint32_t across = layout_.across(level_);
    for (uint32_t face = 0; face < kCubeFaces; ++face) {
        for (uint32_t y = 0; y < across; ++y) {
            for (uint32_t x = 0; x < across; ++x) {
                const uint32_t place = layout_.place(level_, face, x, y);
                if (present.at(level_, place) == kAbsent) continue;
                if (level_ > 0) {
                    const uint8_t greater = states.at(level_ - 1, layout_.place(level_ - 1, face, x / 2, y / 2));
                    if (greater != kMixed) {
                        states.at(level_, place) = greater;
                        continue;
                    }
                }
                set_contexts(first, second, states, face, x, y, place);
                states.at(level_, place) = code_cell(coder, states.at(level_, place));
            }
        }
    }
}

}  // namespace citystream::codec::radiance
