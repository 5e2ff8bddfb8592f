#include "codec/atlas/mip_plan.h"

#include <bit>

#include "codec/atlas/atlas_layout.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint64_t kStep0Bytes = 4096;
static_assert(kGreatestChartSide == 1u << (ATLAS_MAX_MIPS - 1));

}  // namespace

uint64_t block_words(ChartSize chart, uint32_t mip) {
    return uint64_t{(mip_side(chart.width, mip) + 3) / 4} * ((mip_side(chart.height, mip) + 3) / 4) * kBc1BlockWords;
}

uint32_t natural_mip_count(ChartSize chart) {
    return static_cast<uint32_t>(std::bit_width(std::max(chart.width, chart.height)));
}

uint64_t part_words(std::span<const ChartSize> charts, uint64_t table_words, const MipPlan& plan, uint32_t mip) {
    uint64_t words = table_words;
    for (const ChartSize& chart : charts) {
        if (mip < plan.chart_mips(chart)) words += block_words(chart, mip);
    }
    return words;
}

MipPlan plan_mips(std::span<const ChartSize> charts, uint64_t table_words) {
    MipPlan plan;
    for (const ChartSize& chart : charts) plan.mip_count = std::max(plan.mip_count, natural_mip_count(chart));
    for (plan.step0_mip = 0; plan.step0_mip + 1 < plan.mip_count; ++plan.step0_mip) {
        uint64_t words = 0;
        for (uint32_t mip = plan.step0_mip; mip < plan.mip_count; ++mip)
            words += part_words(charts, table_words, plan, mip);
        if (words * sizeof(uint32_t) <= kStep0Bytes) break;
    }
    return plan;
}

}  // namespace citystream::codec::atlas
