// Borders around charts in a common image, so that filtering and coarser mips see the chart itself beyond its edges;
// and the alignment that keeps a mip's texels and blocks from mixing charts.
//
// Source: "Space-Optimized Texture Atlases" 8.1.5 with Equation 3 (border), 8.1.6 with
// Equation 4 (alignment), as corrected in the notes: Equation 4 reads 4 a (M + 1) and gives 12 at M = 2, which breaks
// blocks; the text's 4, 8, 16 are 4 a 2^M, for sizes and origins alike.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/rectangle_packing.h"

namespace citystream::codec::atlas {

/// Mips are counted as in the paper: M mips besides the finest level, levels 0..M.
constexpr uint32_t kMostMips = 7;

/// Equation 3: 0 for M = 0, else 2^(M - 1). At level M such a border is half a texel, and a bilinear sample inside the
/// chart reads that far and no farther. Precondition: mips <= kMostMips.
uint32_t border_for_mips(uint32_t mips);

/// Which sides of a chart get a border, and how much.
enum class BorderRule : uint8_t {
    /// Equation 3 on all sides of all charts. With M = 0 that is none, and a bilinear sample where tiles of a repeating
    /// chart meet reads a neighbour (pitfall 5): for comparison.
    kPaper,
    /// The same, but at least 1: what the packed coordinate (wrap_coordinate.h), which knows one border, asks for.
    kUniform,
    /// As kUniform along axes that repeat, none along the others: there the sampler clamps, half a texel of its level
    /// in
    /// (transports 1 and 2).
    kWhereRepeating,
};

struct ChartBorder {
    uint32_t u = 0, v = 0;  ///< texels on the left and right, and on the bottom and top
    bool operator==(const ChartBorder&) const = default;
};

ChartBorder border_of(BorderRule rule, uint32_t mips, bool repeat_u, bool repeat_v);

/// Texels that a border of b on all sides adds: 2 b (width + height) + 4 b^2.
uint64_t border_cost(RectangleSize interior, uint32_t b);
uint64_t border_cost(RectangleSize interior, ChartBorder border);

/// What origins and sizes of padded charts are multiples of: 4 * 2^M for block compression, else 2^M; with packed
/// coordinates (wrap_coordinate.h) at least 4.
uint32_t alignment_unit(uint32_t mips, bool blocks, bool packed_coordinates);

/// The padded image: row by row from the bottom, `channels` bytes a texel. Beyond the edges of a repeating axis the
/// tile goes on (also where the border is longer than the tile), beyond the others the edge texel is repeated.
/// Preconditions (programming errors): interior not empty, texels.size() == channels * interior.area().
std::vector<uint8_t> add_border(std::span<const uint8_t> texels, RectangleSize interior, uint32_t channels,
                                ChartBorder border, bool repeat_u, bool repeat_v);

}  // namespace citystream::codec::atlas
