#include "codec/atlas/atlas_layer.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <optional>
#include <string>

#include "codec/atlas/atlas_layout.h"
#include "codec/atlas/bc1.h"
#include "codec/atlas/bc1_rate.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kMaxSide = 8192;
constexpr uint64_t kStep0Bytes = 4096;
constexpr uint32_t kMipTable = 8;  ///< where the encoder puts the 16 words
constexpr uint32_t kBlockWords = 2;
static_assert(kMipTable + 16 == ATLAS_HEADER_WORDS);
static_assert(kMaxSide == 1u << (ATLAS_MAX_MIPS - 1));

uint32_t mip_side(uint32_t side, uint32_t mip) {
    return std::max(1u, side >> mip);
}

uint64_t block_words(uint32_t width, uint32_t height, uint32_t mip) {
    return uint64_t{(mip_side(width, mip) + 3) / 4} * ((mip_side(height, mip) + 3) / 4) * kBlockWords;
}

/// Mips down to 1 x 1.
uint32_t natural_mip_count(uint32_t width, uint32_t height) {
    return static_cast<uint32_t>(std::bit_width(std::max(width, height)));
}

/// One output texel's taps along one axis: texels 2i, 2i + 1, 2i + 2 of the finer mip, weights adding up to `total`.
struct Taps {
    uint32_t weight[3];
    uint32_t total;
};

Taps box_taps(uint32_t i, uint32_t fine_side) {
    if (fine_side == 1) return {{1, 0, 0}, 1};
    if (fine_side % 2 == 0) return {{1, 1, 0}, 2};
    const uint32_t half = fine_side / 2;
    return {{half - i, half, i + 1}, fine_side};
}

/// The weighted mean of one output texel, channel by channel, rounded half up.
void filter_texel(const ChartImage& fine, uint32_t x, uint32_t y, uint8_t out[3]) {
    const Taps across = box_taps(x, fine.width);
    const Taps up = box_taps(y, fine.height);
    uint64_t sum[3] = {};
    for (uint32_t j = 0; j < 3; ++j) {
        for (uint32_t i = 0; i < 3; ++i) {
            const uint64_t weight = uint64_t{across.weight[i]} * up.weight[j];
            if (weight == 0) continue;
            const uint8_t* texel = &fine.rgb[3 * (size_t{2 * y + j} * fine.width + 2 * x + i)];
            for (int c = 0; c < 3; ++c) sum[c] += weight * texel[c];
        }
    }
    const uint64_t total = uint64_t{across.total} * up.total;
    for (int c = 0; c < 3; ++c) out[c] = static_cast<uint8_t>((2 * sum[c] + total) / (2 * total));
}

/// The common case: both sides even.
void filter_even_row(const ChartImage& fine, uint32_t y, uint32_t width, uint8_t* out) {
    const uint8_t* low = &fine.rgb[3 * size_t{2 * y} * fine.width];
    const uint8_t* high = low + 3 * size_t{fine.width};
    for (uint32_t x = 0; x < width; ++x, low += 6, high += 6, out += 3) {
        for (int c = 0; c < 3; ++c)
            out[c] = static_cast<uint8_t>((low[c] + low[c + 3] + high[c] + high[c + 3] + 2) / 4);
    }
}

/// The blocks of one step. With rate-distortion optimisation, images of several blocks have each chosen by those
/// before.
class StepBlocks {
  public:
    StepBlocks(std::vector<uint32_t>& words, const AtlasOptions& options) : words_(words) {
        if (options.rate_distortion == 0) return;
        Bc1RateOptions rate;
        rate.lambda = options.rate_distortion;
        rate_.emplace(rate);
    }

    /// Appends the blocks of an image, bottom row first; beyond its edges the last column and row repeat.
    void append(const ChartImage& image) {
        const uint32_t rows = std::max(4u, kBlocksAtOnce / ((image.width + 3) / 4) * 4);
        for (uint32_t y = 0; y < image.height; y += rows) {
            const uint32_t height = std::min(rows, image.height - y);
            const size_t row = 3 * size_t{image.width};
            append(std::span(image.rgb).subspan(y * row, height * row), image.width, height);
        }
    }

  private:
    void append(std::span<const uint8_t> rgb, uint32_t width, uint32_t height) {
        // One block may be the colour of a whole wall, where any loss shows (FLIP of Ingolstadt at strength 4: 0.0098
        // instead of 0.0072): these are the best ones, for a thousandth of the bytes.
        const bool rated = rate_ && (width > 4 || height > 4);
        const auto blocks =
            rated ? rate_->encode(bc1_blocks_of(rgb, width, height)) : encode_bc1_image(rgb, width, height);
        words_.insert(words_.end(), blocks.begin(), blocks.end());
    }

    static constexpr uint32_t kBlocksAtOnce = 4096;  // bounds what an image takes beside its texels
    std::vector<uint32_t>& words_;
    std::optional<Bc1RateEncoder> rate_;
};

/// How the mips of a set of charts are spread over steps.
struct MipPlan {
    uint32_t mip_count = 1;  ///< of the largest chart
    uint32_t step0_mip = 0;  ///< finest mip of step 0

    /// A chart has mips down to 1 x 1, and repeats that one until it has a mip in step 0: every prefix shows every
    /// chart.
    uint32_t chart_mips(const ChartImage& chart) const {
        return std::max(natural_mip_count(chart.width, chart.height), step0_mip + 1);
    }
};

uint64_t part_words(std::span<const ChartImage> charts, const MipPlan& plan, uint32_t mip) {
    uint64_t words = charts.size();
    for (const ChartImage& chart : charts) {
        if (mip < plan.chart_mips(chart)) words += block_words(chart.width, chart.height, mip);
    }
    return words;
}

MipPlan plan_mips(std::span<const ChartImage> charts) {
    MipPlan plan;
    for (const ChartImage& chart : charts)
        plan.mip_count = std::max(plan.mip_count, natural_mip_count(chart.width, chart.height));
    for (plan.step0_mip = 0; plan.step0_mip + 1 < plan.mip_count; ++plan.step0_mip) {
        uint64_t words = 0;
        for (uint32_t mip = plan.step0_mip; mip < plan.mip_count; ++mip) words += part_words(charts, plan, mip);
        if (words * sizeof(uint32_t) <= kStep0Bytes) break;
    }
    return plan;
}

/// The largest texel of any chart when mip `mip` is the finest there is.
float mip_error(std::span<const ChartImage> charts, uint32_t mip) {
    float error = 0;
    for (const ChartImage& chart : charts) {
        const uint32_t own = std::min(mip, natural_mip_count(chart.width, chart.height) - 1);
        error = std::max(error, std::ldexp(chart.metres_per_texel, static_cast<int>(own)));
    }
    return error;
}

void append_part(std::vector<uint32_t>& words, StepBlocks& blocks, std::span<const std::vector<ChartImage>> mips,
                 uint32_t mip) {
    const size_t begin = words.size();
    words.resize(begin + mips.size(), 0);
    for (size_t chart = 0; chart < mips.size(); ++chart) {
        if (mip >= mips[chart].size()) continue;
        words[begin + chart] = static_cast<uint32_t>(words.size() - begin);
        blocks.append(mips[chart][mip]);
    }
}

std::vector<uint32_t> header_words(std::span<const ChartImage> charts, const MipPlan& plan) {
    std::vector<uint32_t> words(ATLAS_HEADER_WORDS, 0);
    words[ATLAS_WORD_MAGIC] = ATLAS_MAGIC;
    words[ATLAS_WORD_CHART_COUNT] = static_cast<uint32_t>(charts.size());
    words[ATLAS_WORD_MIP_COUNT] = plan.mip_count;
    words[ATLAS_WORD_STEP0_MIP] = plan.step0_mip;
    words[ATLAS_WORD_MIP_TABLE] = kMipTable;
    for (const ChartImage& chart : charts) {
        const uint32_t repeat =
            (chart.repeat_u ? ATLAS_CHART_REPEAT_U : 0u) | (chart.repeat_v ? ATLAS_CHART_REPEAT_V : 0u);
        words.push_back(chart.width | chart.height << 16);
        words.push_back(repeat | plan.chart_mips(chart) << 8);
    }
    // Coarsest first, so that the parts of later steps only follow.
    uint64_t begin = words.size();
    for (uint32_t mip = plan.mip_count; mip-- > 0;) {
        words[kMipTable + mip] = static_cast<uint32_t>(begin);
        begin += part_words(charts, plan, mip);
    }
    assert(begin <= ~uint32_t{0});
    return words;
}

}  // namespace

ChartImage downsample(const ChartImage& image) {
    ChartImage coarse;
    coarse.width = mip_side(image.width, 1);
    coarse.height = mip_side(image.height, 1);
    coarse.repeat_u = image.repeat_u;
    coarse.repeat_v = image.repeat_v;
    coarse.metres_per_texel = 2 * image.metres_per_texel;
    coarse.rgb.resize(3 * size_t{coarse.width} * coarse.height);
    const bool even = image.width % 2 == 0 && image.height % 2 == 0;
    for (uint32_t y = 0; y < coarse.height; ++y) {
        uint8_t* row = &coarse.rgb[3 * size_t{y} * coarse.width];
        if (even) {
            filter_even_row(image, y, coarse.width, row);
            continue;
        }
        for (uint32_t x = 0; x < coarse.width; ++x) filter_texel(image, x, y, row + 3 * size_t{x});
    }
    return coarse;
}

LayerSteps encode_atlas(std::span<const ChartImage> charts, const AtlasOptions& options) {
    const MipPlan plan = plan_mips(charts);
    std::vector<std::vector<ChartImage>> mips(charts.size());
    for (size_t i = 0; i < charts.size(); ++i) {
        const ChartImage& chart = charts[i];
        assert(chart.width >= 1 && chart.width <= kMaxSide && chart.height >= 1 && chart.height <= kMaxSide);
        assert(chart.rgb.size() == 3 * size_t{chart.width} * chart.height);
        mips[i].push_back(chart);
        while (mips[i].size() < plan.chart_mips(chart)) mips[i].push_back(downsample(mips[i].back()));
    }
    LayerSteps steps(1);
    steps[0].words = header_words(charts, plan);
    StepBlocks step0_blocks(steps[0].words, options);
    for (uint32_t mip = plan.mip_count; mip-- > plan.step0_mip;) append_part(steps[0].words, step0_blocks, mips, mip);
    steps[0].error = mip_error(charts, plan.step0_mip);
    for (uint32_t mip = plan.step0_mip; mip-- > 0;) {
        LayerStep& step = steps.emplace_back();
        StepBlocks blocks(step.words, options);
        append_part(step.words, blocks, mips, mip);
        step.error = mip_error(charts, mip);
    }
    return steps;
}

namespace {

Error error_at(std::string message, uint64_t word) {
    return Error{"atlas layer: " + std::move(message), word * 4};
}

Status check_header(std::span<const uint32_t> words, std::span<const uint32_t> step_words) {
    uint64_t sum = 0;
    for (const uint32_t count : step_words) sum += count;
    if (step_words.empty() || sum != words.size()) {
        return error_at(
            "steps of " + std::to_string(sum) + " words in all, but " + std::to_string(words.size()) + " are there",
            words.size());
    }
    if (words.size() > ~uint32_t{0}) return error_at("too large for 32-bit offsets", 0);
    const uint64_t end = step_words[0];
    if (end < ATLAS_HEADER_WORDS) return error_at("step 0 is shorter than its header", end);
    if (words[ATLAS_WORD_MAGIC] != ATLAS_MAGIC) return error_at("wrong magic", ATLAS_WORD_MAGIC);
    const uint32_t mips = words[ATLAS_WORD_MIP_COUNT];
    if (mips == 0 || mips > ATLAS_MAX_MIPS) return error_at("mip count out of range", ATLAS_WORD_MIP_COUNT);
    if (words[ATLAS_WORD_STEP0_MIP] >= mips) return error_at("step 0 holds no mip", ATLAS_WORD_STEP0_MIP);
    if (step_words.size() - 1 > words[ATLAS_WORD_STEP0_MIP])
        return error_at("more steps than mips", ATLAS_WORD_STEP0_MIP);
    const uint64_t table = words[ATLAS_WORD_MIP_TABLE];
    if (table < kMipTable || table + 16 > end)
        return error_at("mip table reaches outside step 0", ATLAS_WORD_MIP_TABLE);
    if (words[ATLAS_WORD_CHART_COUNT] > (end - ATLAS_HEADER_WORDS) / ATLAS_CHART_WORDS) {
        return error_at("chart table reaches outside step 0", ATLAS_WORD_CHART_COUNT);
    }
    return Done{};
}

Status check_chart_table(std::span<const uint32_t> words) {
    for (uint64_t chart = 0; chart < words[ATLAS_WORD_CHART_COUNT]; ++chart) {
        const uint64_t entry = ATLAS_HEADER_WORDS + chart * ATLAS_CHART_WORDS;
        const uint32_t width = words[entry + ATLAS_CHART_SIZE] & 0xffffu;
        const uint32_t height = words[entry + ATLAS_CHART_SIZE] >> 16;
        if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide) {
            return error_at("chart size out of range", entry + ATLAS_CHART_SIZE);
        }
        const uint32_t flags = words[entry + ATLAS_CHART_FLAGS];
        const uint32_t mips = flags >> 8;
        if (mips <= words[ATLAS_WORD_STEP0_MIP] || mips > words[ATLAS_WORD_MIP_COUNT]) {
            return error_at("chart without a mip in step 0, or with more than the atlas has",
                            entry + ATLAS_CHART_FLAGS);
        }
        if ((flags & 0xffu & ~(ATLAS_CHART_REPEAT_U | ATLAS_CHART_REPEAT_V)) != 0) {
            return error_at("unknown chart flags", entry + ATLAS_CHART_FLAGS);
        }
    }
    return Done{};
}

/// The part of one mip lies in [begin, end), the words of its step, with the blocks of every chart that has the mip.
Status check_part(std::span<const uint32_t> words, uint32_t mip, uint64_t begin, uint64_t end) {
    const uint64_t table_word = words[ATLAS_WORD_MIP_TABLE] + mip;
    const uint64_t part = words[table_word];
    const uint64_t charts = words[ATLAS_WORD_CHART_COUNT];
    if (part < begin || part > end || charts > end - part) {
        return error_at("mip " + std::to_string(mip) + " reaches outside its step", table_word);
    }
    for (uint64_t chart = 0; chart < charts; ++chart) {
        const uint64_t entry = ATLAS_HEADER_WORDS + chart * ATLAS_CHART_WORDS;
        const uint32_t size = words[entry + ATLAS_CHART_SIZE];
        const uint64_t offset = words[part + chart];
        if (mip >= words[entry + ATLAS_CHART_FLAGS] >> 8) {
            if (offset != 0) return error_at("blocks of a mip that the chart has not", part + chart);
            continue;
        }
        const uint64_t room = end - part;
        if (offset < charts || offset > room || block_words(size & 0xffffu, size >> 16, mip) > room - offset) {
            return error_at("blocks of mip " + std::to_string(mip) + " reach outside their step", part + chart);
        }
    }
    return Done{};
}

}  // namespace

Result<AtlasLayerView> AtlasLayerView::create(std::span<const uint32_t> words, std::span<const uint32_t> step_words) {
    if (const Status status = check_header(words, step_words); !status) return status.error();
    if (const Status status = check_chart_table(words); !status) return status.error();
    const uint32_t step0_mip = words[ATLAS_WORD_STEP0_MIP];
    const uint64_t tables_end = ATLAS_HEADER_WORDS + uint64_t{words[ATLAS_WORD_CHART_COUNT]} * ATLAS_CHART_WORDS;
    for (uint32_t mip = step0_mip; mip < words[ATLAS_WORD_MIP_COUNT]; ++mip) {
        if (const Status status = check_part(words, mip, tables_end, step_words[0]); !status) return status.error();
    }
    uint64_t begin = step_words[0];
    for (uint32_t s = 1; s < step_words.size(); ++s) {
        const uint64_t end = begin + step_words[s];
        if (const Status status = check_part(words, step0_mip - s, begin, end); !status) return status.error();
        begin = end;
    }
    AtlasLayerView view;
    view.words_ = words;
    view.finest_mip_ = step0_mip + 1 - static_cast<uint32_t>(step_words.size());
    return view;
}

uint32_t AtlasLayerView::chart_count() const {
    return words_[ATLAS_WORD_CHART_COUNT];
}
uint32_t AtlasLayerView::finest_mip() const {
    return finest_mip_;
}

uint32_t AtlasLayerView::width(uint32_t chart) const {
    return words_[ATLAS_HEADER_WORDS + size_t{chart} * ATLAS_CHART_WORDS + ATLAS_CHART_SIZE] & 0xffffu;
}

uint32_t AtlasLayerView::height(uint32_t chart) const {
    return words_[ATLAS_HEADER_WORDS + size_t{chart} * ATLAS_CHART_WORDS + ATLAS_CHART_SIZE] >> 16;
}

uint32_t AtlasLayerView::flags(uint32_t chart) const {
    return words_[ATLAS_HEADER_WORDS + size_t{chart} * ATLAS_CHART_WORDS + ATLAS_CHART_FLAGS];
}

uint32_t AtlasLayerView::mip_count(uint32_t chart) const {
    return flags(chart) >> 8;
}

void AtlasLayerView::texel(uint32_t chart, uint32_t mip, uint32_t x, uint32_t y, uint8_t rgb[3]) const {
    assert(mip >= finest_mip_ && mip < mip_count(chart));
    assert(x < mip_side(width(chart), mip) && y < mip_side(height(chart), mip));
    const size_t part = words_[words_[ATLAS_WORD_MIP_TABLE] + mip];
    const size_t blocks_across = (mip_side(width(chart), mip) + 3) / 4;
    const size_t block = part + words_[part + chart] + (y / 4 * blocks_across + x / 4) * kBlockWords;
    decode_bc1_texel(&words_[block], y % 4 * 4 + x % 4, rgb);
}

}  // namespace citystream::codec::atlas
