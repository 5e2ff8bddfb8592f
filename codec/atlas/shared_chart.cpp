#include "codec/atlas/shared_chart.h"

#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>

#include "codec/atlas/atlas_layout.h"
#include "codec/atlas/block_planes.h"
#include "codec/atlas/mip_plan.h"
#include "codec/bits/zstd_frame.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kTableWords = 1;  // of the one chart, in every part

ChartShape shape_of(uint32_t width, uint32_t height, uint32_t flags) {
    return {width, height, (flags & ATLAS_CHART_ALPHA) != 0};
}

uint32_t words_of_block(const ChartShape& chart) {
    return chart.alpha ? kBc3BlockWords : kBc1BlockWords;
}

MipPlan plan_of(const ChartShape& chart) {
    return plan_mips(std::span(&chart, 1), kTableWords);
}

/// Where in a level the blocks of a mip lie.
struct BlockRun {
    size_t begin = 0, words = 0;
};

/// The mips of a level, coarsest first: each the one word of its table, then its blocks.
std::vector<BlockRun> runs_of_level(const ChartShape& chart, uint32_t step) {
    const MipPlan plan = plan_of(chart);
    assert(step <= plan.step0_mip);
    const uint32_t coarsest = step == 0 ? plan.mip_count - 1 : plan.step0_mip - step;
    size_t begin = step == 0 ? ATLAS_HEADER_WORDS + ATLAS_CHART_WORDS : 0;
    std::vector<BlockRun> runs;
    for (uint32_t mip = coarsest + 1; mip-- > plan.step0_mip - step;) {
        runs.push_back({begin + kTableWords, block_words(chart, mip)});
        begin += part_words(std::span(&chart, 1), kTableWords, plan, mip);
    }
    return runs;
}

/// The words of a level, blocks zero: as encode_atlas writes them.
std::vector<uint32_t> tables_of_level(const ChartShape& chart, uint32_t flags, uint32_t step) {
    std::vector<uint32_t> words(atlas_step_words(chart.width, chart.height, flags, step), 0);
    for (const BlockRun& run : runs_of_level(chart, step)) words[run.begin - kTableWords] = kTableWords;
    if (step > 0) return words;
    const MipPlan plan = plan_of(chart);
    words[ATLAS_WORD_MAGIC] = ATLAS_MAGIC;
    words[ATLAS_WORD_CHART_COUNT] = 1;
    words[ATLAS_WORD_MIP_COUNT] = plan.mip_count;
    words[ATLAS_WORD_STEP0_MIP] = plan.step0_mip;
    words[ATLAS_WORD_MIP_TABLE] = kMipTableAt;
    uint32_t begin = ATLAS_HEADER_WORDS + ATLAS_CHART_WORDS;
    for (uint32_t mip = plan.mip_count; mip-- > 0;) {
        words[kMipTableAt + mip] = begin;
        begin += static_cast<uint32_t>(part_words(std::span(&chart, 1), kTableWords, plan, mip));
    }
    words[ATLAS_HEADER_WORDS + ATLAS_CHART_SIZE] = chart.width | chart.height << 16;
    words[ATLAS_HEADER_WORDS + ATLAS_CHART_FLAGS] = flags | plan.mip_count << 8;
    return words;
}

uint32_t checksum_of_frame(std::span<const std::byte> frame) {
    return static_cast<uint32_t>(XXH3_64bits(frame.data(), frame.size()));
}

}  // namespace

uint32_t atlas_step_count(uint32_t width, uint32_t height, uint32_t flags) {
    return plan_of(shape_of(width, height, flags)).step0_mip + 1;
}

uint32_t atlas_step_finest_mip(uint32_t width, uint32_t height, uint32_t flags, uint32_t step) {
    const uint32_t step0_mip = plan_of(shape_of(width, height, flags)).step0_mip;
    assert(step <= step0_mip);
    return step0_mip - step;
}

uint32_t atlas_step_words(uint32_t width, uint32_t height, uint32_t flags, uint32_t step) {
    const ChartShape chart = shape_of(width, height, flags);
    const MipPlan plan = plan_of(chart);
    assert(step <= plan.step0_mip);
    const auto words_of = [&](uint32_t mip) { return part_words(std::span(&chart, 1), kTableWords, plan, mip); };
    if (step > 0) return static_cast<uint32_t>(words_of(plan.step0_mip - step));
    uint64_t words = ATLAS_HEADER_WORDS + ATLAS_CHART_WORDS;
    for (uint32_t mip = plan.step0_mip; mip < plan.mip_count; ++mip) words += words_of(mip);
    return static_cast<uint32_t>(words);
}

std::vector<std::vector<std::byte>> encode_chart_levels(const LayerSteps& steps, int zstd_level) {
    const ChartShape chart = chart_shape(steps[0].words[ATLAS_HEADER_WORDS + ATLAS_CHART_SIZE],
                                         steps[0].words[ATLAS_HEADER_WORDS + ATLAS_CHART_FLAGS]);
    std::vector<std::vector<std::byte>> payloads;
    for (uint32_t step = 0; step < steps.size(); ++step) {
        std::vector<uint32_t> blocks;
        for (const BlockRun& run : runs_of_level(chart, step)) {
            const auto own = std::span(steps[step].words).subspan(run.begin, run.words);
            blocks.insert(blocks.end(), own.begin(), own.end());
        }
        std::vector<uint32_t> planes(blocks.size());
        split_block_planes(blocks, words_of_block(chart), planes);
        const std::vector<std::byte> frame = bits::compress_frame(std::as_bytes(std::span(planes)), zstd_level);
        std::vector<std::byte>& payload = payloads.emplace_back(kChartChecksumBytes);
        const uint32_t checksum = checksum_of_frame(frame);
        std::memcpy(payload.data(), &checksum, sizeof(checksum));
        payload.insert(payload.end(), frame.begin(), frame.end());
    }
    return payloads;
}

bool chart_level_is_whole(std::span<const std::byte> payload) {
    uint32_t checksum = 0;
    if (payload.size() <= sizeof(checksum)) return false;
    std::memcpy(&checksum, payload.data(), sizeof(checksum));
    return checksum == checksum_of_frame(payload.subspan(kChartChecksumBytes));
}

Result<std::vector<uint32_t>> decode_chart_level(std::span<const std::byte> payload, uint32_t width, uint32_t height,
                                                 uint32_t flags, uint32_t step) {
    if (!chart_level_is_whole(payload)) return Error{"shared chart: checksum of a level differs"};
    const ChartShape chart = shape_of(width, height, flags);
    const std::vector<BlockRun> runs = runs_of_level(chart, step);
    size_t block_words = 0;
    for (const BlockRun& run : runs) block_words += run.words;
    const auto raw = bits::decompress_frame(payload.subspan(kChartChecksumBytes), sizeof(uint32_t) * block_words);
    if (!raw) return raw.error();
    std::vector<uint32_t> planes(block_words), blocks(block_words);
    std::memcpy(planes.data(), raw->data(), raw->size());
    join_block_planes(planes, words_of_block(chart), blocks);
    std::vector<uint32_t> words = tables_of_level(chart, flags, step);
    std::span<const uint32_t> next = blocks;
    for (const BlockRun& run : runs) {
        std::copy_n(next.begin(), run.words, words.begin() + static_cast<ptrdiff_t>(run.begin));
        next = next.subspan(run.words);
    }
    return words;
}

Result<AtlasLayerView> shared_chart_view(std::span<const uint32_t> words, uint32_t width, uint32_t height,
                                         uint32_t flags, uint32_t level_count) {
    std::vector<uint32_t> step_words;
    for (uint32_t step = 0; step < level_count; ++step)
        step_words.push_back(atlas_step_words(width, height, flags, step));
    auto view = AtlasLayerView::create(words, step_words);
    if (!view) return view;
    if (view->chart_count() != 1 || view->width(0) != width || view->height(0) != height ||
        (view->flags(0) & kSharedChartFlags) != flags)
        return Error{"shared chart: not the one that the index lists"};
    if (view->finest_mip() != atlas_step_finest_mip(width, height, flags, level_count - 1))
        return Error{"shared chart: its levels hold other mips than they should"};
    return view;
}

uint32_t coarse_float_bits(float value) {
    assert(std::isfinite(value) && value >= 0);
    constexpr uint32_t kGreatest = 0x7f7f;  // finite
    return std::min((std::bit_cast<uint32_t>(value) + 0x8000u) >> 16, kGreatest);
}

float from_coarse_float_bits(uint32_t bits) {
    return std::bit_cast<float>(bits << 16);
}

}  // namespace citystream::codec::atlas
