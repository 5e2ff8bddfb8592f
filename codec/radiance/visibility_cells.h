// A receiver's sample bits as a quadtree of squares on the cube's faces: what visibility_wire.h codes, coarse to fine.
//
// Levels 0 to 3 have cells of 8, 4, 2 and 1 samples across; those at the edge of a face may be cut off. Of a cell two
// bits are known: whether any of its samples above the receiver's plane is visible, and whether any is hidden. With
// neither it is *absent*, with both it is *mixed*. A row's bits lie together, so that eight cells are worked on at
// once.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/source_directions.h"

namespace citystream::codec::radiance {

inline constexpr uint32_t kCellLevels = 4;
/// Absent, visible, hidden, mixed.
inline constexpr uint32_t kCellStates = 4;

/// Where the cells of a level lie in an array of bytes: row by row, face by face. A row has its visible bits, a byte of
/// zeros, its hidden bits and a byte of zeros, columns from the lowest bit of the first byte on. Before and behind the
/// rows of each face is one of zeros: so all around a face cells are absent.
class CellLayout {
  public:
    /// For a source of `side` texels on a side.
    explicit CellLayout(uint32_t side);

    uint32_t samples_across() const { return samples_across_; }
    /// Cells on a side of a face.
    uint32_t across(uint32_t level) const { return across_[level]; }
    uint32_t cell_samples(uint32_t level) const { return 8u >> level; }
    /// Of a row's visible bits, and of its hidden ones.
    uint32_t row_bytes(uint32_t level) const { return (across_[level] + 7) / 8; }
    /// From a row's visible bits to its hidden ones.
    uint32_t hidden(uint32_t level) const { return row_bytes(level) + 1; }
    /// From a row to the next.
    uint32_t stride(uint32_t level) const { return 2 * hidden(level); }
    /// The first byte of row y.
    uint32_t row(uint32_t level, uint32_t face, uint32_t y) const {
        return 1 + (face * (across_[level] + 1) + y + 1) * stride(level);
    }
    /// In bytes.
    uint32_t size(uint32_t level) const { return 2 + (kCubeFaces * (across_[level] + 1) + 1) * stride(level); }

  private:
    uint32_t samples_across_;
    std::array<uint32_t, kCellLevels> across_{};
};

/// The bits of `count` columns (1..9) of a row from column x on, x >= -8: two bytes, also where one would do.
inline uint32_t row_bits(const uint8_t* row, int32_t x, uint32_t count) {
    const auto from_border = static_cast<uint32_t>(x + 8);
    const uint8_t* const bytes = row - 1 + from_border / 8;
    const uint32_t two = bytes[0] | static_cast<uint32_t>(bytes[1]) << 8;
    return two >> from_border % 8 & ((1u << count) - 1);
}

/// The bits of each cell of each level.
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

    /// Makes a level's cells absent.
    void clear(uint32_t level);
    /// Gives the cells of a level (1..) within those of row `y` of the level before the bits of these, but none within
    /// mixed ones and where `present` has no visible bit.
    void inherit_row(const CellLayout& layout, uint32_t level, uint32_t face, uint32_t y, const CellStates& present);

    uint8_t* at(uint32_t level, uint32_t byte) { return &bytes_[level][byte]; }
    const uint8_t* at(uint32_t level, uint32_t byte) const { return &bytes_[level][byte]; }

  private:
    /// A level from the one after it.
    void join_cells(const CellLayout& layout, uint32_t level);

    std::array<std::vector<uint8_t>, kCellLevels> bytes_;
};

}  // namespace citystream::codec::radiance
