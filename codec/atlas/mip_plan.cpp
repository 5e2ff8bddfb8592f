#include "codec/atlas/mip_plan.h"

#include <bit>

#include "codec/atlas/alpha_mask.h"
#include "codec/atlas/atlas_layout.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint64_t kStep0Bytes = 4096;
static_assert(kGreatestChartSide == 1u << (ATLAS_MAX_MIPS - 1));

}  // namespace

ChartShape chart_shape(uint32_t size_word, uint32_t flags_word) {
    return {size_word & 0xffffU, size_word >> 16, (flags_word & ATLAS_CHART_ALPHA) != 0};
}

uint64_t block_words(const ChartShape& chart, uint32_t mip) {
    const uint64_t blocks = uint64_t{(mip_side(chart.width, mip) + 3) / 4} * ((mip_side(chart.height, mip) + 3) / 4);
    return blocks * (chart.alpha ? kBc3BlockWords : kBc1BlockWords);
}

uint32_t natural_mip_count(const ChartShape& chart) {
    auto count = static_cast<uint32_t>(std::bit_width(std::max(chart.width, chart.height)));
    const auto texels = [&](uint32_t mip) {
        return uint64_t{mip_side(chart.width, mip)} * mip_side(chart.height, mip);
    };
    while (chart.alpha && count > 1 && texels(count - 1) < kLeastAlphaTexels) --count;
    return count;
}

uint64_t part_words(std::span<const ChartShape> charts, uint64_t table_words, const MipPlan& plan, uint32_t mip) {
    uint64_t words = table_words;
    for (const ChartShape& chart : charts) {
        if (mip < plan.chart_mips(chart)) words += block_words(chart, mip);
    }
    return words;
}

MipPlan plan_mips(std::span<const ChartShape> charts, uint64_t table_words) {
    MipPlan plan;
    for (const ChartShape& chart : charts) plan.mip_count = std::max(plan.mip_count, natural_mip_count(chart));
    for (plan.step0_mip = 0; plan.step0_mip + 1 < plan.mip_count; ++plan.step0_mip) {
        uint64_t words = 0;
        for (uint32_t mip = plan.step0_mip; mip < plan.mip_count; ++mip)
            words += part_words(charts, table_words, plan, mip);
        if (words * sizeof(uint32_t) <= kStep0Bytes) break;
    }
    return plan;
}

}  // namespace citystream::codec::atlas
