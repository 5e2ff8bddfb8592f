// How the mips of a set of charts are spread over the steps of an atlas layer, and how many words they take.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

namespace citystream::codec::atlas {

inline constexpr uint32_t kGreatestChartSide = 8192;
inline constexpr uint32_t kBc1BlockWords = 2, kBc4BlockWords = 2, kBc3BlockWords = kBc4BlockWords + kBc1BlockWords;
inline constexpr uint32_t kMipTableAt = 8;  ///< where encoders put the mip table of a layer

struct ChartShape {
    uint32_t width = 0, height = 0;  ///< texels of mip 0, 1..kGreatestChartSide
    bool alpha = false;              ///< BC3 blocks
};

/// Of a chart table's entry.
ChartShape chart_shape(uint32_t size_word, uint32_t flags_word);

inline uint32_t mip_side(uint32_t side, uint32_t mip) {
    return std::max(1u, side >> mip);
}

/// Words of the blocks of a mip.
uint64_t block_words(const ChartShape& chart, uint32_t mip);

/// Mips down to 1 x 1; with alpha down to the last one of kLeastAlphaTexels, at least one.
uint32_t natural_mip_count(const ChartShape& chart);

struct MipPlan {
    uint32_t mip_count = 1;  ///< of the largest chart
    uint32_t step0_mip = 0;  ///< finest mip of step 0; step s holds mip step0_mip - s

    /// Where these end above step 0, more follow (of 1 x 1: the same again): every prefix shows every chart.
    uint32_t chart_mips(const ChartShape& chart) const { return std::max(natural_mip_count(chart), step0_mip + 1); }
};

/// Words of a mip's part: a table of `table_words` and the blocks of the charts that have the mip.
uint64_t part_words(std::span<const ChartShape> charts, uint64_t table_words, const MipPlan& plan, uint32_t mip);

/// Step 0 holds the mips whose parts sum to at most 4 KiB, at least the coarsest.
MipPlan plan_mips(std::span<const ChartShape> charts, uint64_t table_words);

}  // namespace citystream::codec::atlas
