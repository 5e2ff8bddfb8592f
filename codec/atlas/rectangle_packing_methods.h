// The packers behind pack_rectangles (rectangle_packing.h), one file each, and the store of rectangles that two of them
// share. For this folder only.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/rectangle_packing.h"

namespace citystream::codec::atlas {

Packing pack_binary_tree(std::span<const RectangleSize> sizes, RectangleSize bin, PackWhole whole);
Packing pack_guillotine(std::span<const RectangleSize> sizes, RectangleSize bin, uint32_t taste, PackWhole whole);
Packing pack_skyline(std::span<const RectangleSize> sizes, RectangleSize bin, uint32_t taste, PackWhole whole);

/// Rectangles that are not placed yet, by width and then by height.
class RectanglePool {
  public:
    struct Entry {
        uint32_t height, rectangle;
    };
    struct Column {
        uint32_t width;
        std::vector<Entry> entries;  ///< by height, then by index; never empty
    };
    static constexpr size_t kNone = ~size_t{0};

    /// Those that fit the bin.
    RectanglePool(std::span<const RectangleSize> sizes, RectangleSize bin);

    bool empty() const { return columns_.empty(); }
    uint64_t area() const { return area_; }
    std::span<const Column> columns() const { return columns_; }  ///< by width
    /// How many columns, from the first on, are at most this wide.
    size_t columns_up_to(uint32_t width) const;
    /// No entry left is higher.
    uint32_t most_height() const { return most_height_; }
    /// Position in a column of its tallest entry of at most this height, or kNone.
    static size_t tallest(const Column& column, uint32_t most_height);
    /// Takes an entry out and gives its index. Spans from columns() end.
    uint32_t take(size_t column, size_t entry);

  private:
    std::vector<Column> columns_;
    uint64_t area_ = 0;
    uint32_t most_height_ = 0;
};

}  // namespace citystream::codec::atlas
