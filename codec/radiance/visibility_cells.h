// A receiver's sample bits as a quadtree of squares on the cube's faces: what visibility_wire.h codes, coarse to fine.
//
// Levels 0 to 3 have cells of 8, 4, 2 and 1 samples across; those at the edge of a face may be cut off. A cell's state
// says what its samples above the receiver's plane are: none visible, all visible, some, or that there are none.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/source_directions.h"

namespace citystream::codec::radiance {

inline constexpr uint32_t kCellLevels = 4;

enum CellState : uint8_t { kAllHidden, kAllVisible, kMixed, kAbsent };
inline constexpr uint32_t kCellStates = 4;

/// Where the cells of a level lie in an array: each face's square with a border of absent cells around it.
class CellLayout {
  public:
    /// For a source of `side` texels on a side.
    explicit CellLayout(uint32_t side);

    uint32_t samples_across() const { return samples_across_; }
    /// Cells on a side of a face.
    uint32_t across(uint32_t level) const { return across_[level]; }
    uint32_t cell_samples(uint32_t level) const { return 8u >> level; }
    /// From a cell to the one below it.
    uint32_t row(uint32_t level) const { return across_[level] + 2; }
    uint32_t place(uint32_t level, uint32_t face, uint32_t x, uint32_t y) const {
        return (face * row(level) + y + 1) * row(level) + x + 1;
    }
    uint32_t size(uint32_t level) const { return kCubeFaces * row(level) * row(level); }

  private:
    uint32_t samples_across_;
    std::array<uint32_t, kCellLevels> across_{};
};

/// A state for each cell of each level.
class CellStates {
  public:
    /// All absent.
    explicit CellStates(const CellLayout& layout);

    /// From a receiver's words and those of the samples above its plane.
    void set_from_bits(const CellLayout& layout, std::span<const uint32_t> bits, std::span<const uint32_t> above);
    /// The bits by the first `levels` levels (1..kCellLevels): of cells that are still mixed every other sample, as on
    /// a chessboard. None that is not in `above`. `bits` come in as zeros.
    void write_bits(const CellLayout& layout, uint32_t levels, std::span<const uint32_t> above,
                    std::span<uint32_t> bits) const;

    /// Columns of the mixed cells of a row.
    void list_mixed(const CellLayout& layout, uint32_t level, uint32_t face, uint32_t y,
                    std::vector<uint32_t>& columns) const;
    /// Gives the cells of a level (1..) within the cells of row `y` of the level before the states of these; cells that
    /// `present` does not have stay absent.
    void inherit_row(const CellLayout& layout, uint32_t level, uint32_t face, uint32_t y, const CellStates& present);

    uint8_t& at(uint32_t level, uint32_t place) { return states_[level][place]; }
    uint8_t at(uint32_t level, uint32_t place) const { return states_[level][place]; }

  private:
    /// A level from the one after it.
    void join_cells(const CellLayout& layout, uint32_t level);

    std::array<std::vector<uint8_t>, kCellLevels> states_;
};

}  // namespace citystream::codec::radiance
