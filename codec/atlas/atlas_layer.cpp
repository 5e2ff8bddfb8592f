#include "codec/atlas/atlas_layer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "codec/atlas/alpha_mask.h"
#include "codec/atlas/atlas_layout.h"
#include "codec/atlas/bc1.h"
#include "codec/atlas/bc4.h"
#include "codec/atlas/box_taps.h"
#include "codec/atlas/linear_bytes.h"
#include "codec/atlas/mip_plan.h"
#include "codec/atlas/shared_chart.h"
#include "codec/atlas/step_blocks.h"

namespace citystream::codec::atlas {

namespace {

static_assert(kMipTableAt + 16 == ATLAS_HEADER_WORDS);

/// The weighted mean of one output texel, channel by channel, rounded half up.
void filter_texel(const ChartImage& fine, uint32_t x, uint32_t y, uint8_t out[3]) {
    const BoxTaps across = box_taps(x, fine.width);
    const BoxTaps up = box_taps(y, fine.height);
    const LinearBytes& light = LinearBytes::tables();
    uint64_t sum[3] = {};
    for_each_tap(across, up, [&](uint32_t i, uint32_t j, uint64_t weight) {
        const uint8_t* texel = &fine.rgb[3 * (size_t{2 * y + j} * fine.width + 2 * x + i)];
        for (int c = 0; c < 3; ++c) sum[c] += weight * light.linear(texel[c]);
    });
    const uint64_t total = uint64_t{across.total} * up.total;
    for (int c = 0; c < 3; ++c) out[c] = light.mean(sum[c], total);
}

/// The common case: both sides even.
void filter_even_row(const ChartImage& fine, uint32_t y, uint32_t width, uint8_t* out) {
    const uint8_t* low = &fine.rgb[3 * size_t{2 * y} * fine.width];
    const uint8_t* high = low + 3 * size_t{fine.width};
    const LinearBytes& light = LinearBytes::tables();
    for (uint32_t x = 0; x < width; ++x, low += 6, high += 6, out += 3) {
        for (int c = 0; c < 3; ++c)
            out[c] = light.mean_of_four(light.linear(low[c]) + light.linear(low[c + 3]) + light.linear(high[c]) +
                                        light.linear(high[c + 3]));
    }
}

ChartShape shape_of(const ChartImage& chart) {
    return {chart.width, chart.height, !chart.alpha.empty()};
}

/// The largest texel of any chart when mip `mip` is the finest there is.
float mip_error(std::span<const ChartImage> charts, uint32_t mip) {
    float error = 0;
    for (const ChartImage& chart : charts) {
        const uint32_t own = std::min(mip, natural_mip_count(shape_of(chart)) - 1);
        error = std::max(error, std::ldexp(chart.metres_per_texel, static_cast<int>(own)));
    }
    return error;
}

/// The charts of a layer as its table lists them, and their mips.
class LayerEncoding {
  public:
    LayerEncoding(std::span<const ChartImage> charts, std::span<const SharedChartUse> shared,
                  const AtlasOptions& options)
        : charts_(charts), shared_(shared), options_(options), total_(charts.size() + shared.size()) {
        for (const ChartImage& chart : charts) shapes_.push_back(shape_of(chart));
        plan_ = plan_mips(shapes_, total_);
        place_charts();
        mips_.resize(charts.size());
        for (size_t i = 0; i < charts.size(); ++i) {
            assert(charts[i].width >= 1 && charts[i].width <= kGreatestChartSide);
            assert(charts[i].height >= 1 && charts[i].height <= kGreatestChartSide);
            assert(charts[i].rgb.size() == 3 * size_t{charts[i].width} * charts[i].height);
            assert(charts[i].alpha.empty() || 3 * charts[i].alpha.size() == charts[i].rgb.size());
            mips_[i].push_back(charts[i]);
            while (mips_[i].size() < plan_.chart_mips(shapes_[i])) mips_[i].push_back(downsample(mips_[i].back()));
        }
    }

    LayerSteps steps() const {
        LayerSteps steps(1);
        steps[0].words = header_words();
        StepBlocks step0_blocks(steps[0].words, options_.rate_distortion);
        for (uint32_t mip = plan_.mip_count; mip-- > plan_.step0_mip;) append_part(steps[0].words, step0_blocks, mip);
        steps[0].error = mip_error(charts_, plan_.step0_mip);
        for (uint32_t mip = plan_.step0_mip; mip-- > 0;) {
            LayerStep& step = steps.emplace_back();
            StepBlocks blocks(step.words, options_.rate_distortion);
            append_part(step.words, blocks, mip);
            step.error = mip_error(charts_, mip);
        }
        return steps;
    }

  private:
    /// Where in the table the local charts go: what the shared ones leave.
    void place_charts() {
        auto shared = shared_.begin();
        for (uint32_t place = 0; place < total_; ++place) {
            if (shared != shared_.end() && shared->chart_in_tile == place) {
                ++shared;
            } else {
                places_.push_back(place);
            }
        }
        assert(shared == shared_.end() && places_.size() == charts_.size());
    }

    std::vector<uint32_t> header_words() const {
        std::vector<uint32_t> words(ATLAS_HEADER_WORDS + ATLAS_CHART_WORDS * total_, 0);
        words[ATLAS_WORD_MAGIC] = ATLAS_MAGIC;
        words[ATLAS_WORD_CHART_COUNT] = static_cast<uint32_t>(total_);
        words[ATLAS_WORD_MIP_COUNT] = plan_.mip_count;
        words[ATLAS_WORD_STEP0_MIP] = plan_.step0_mip;
        words[ATLAS_WORD_MIP_TABLE] = kMipTableAt;
        const auto entry = [&words](uint32_t place) { return &words[ATLAS_HEADER_WORDS + ATLAS_CHART_WORDS * place]; };
        for (size_t i = 0; i < charts_.size(); ++i) {
            const ChartImage& chart = charts_[i];
            const uint32_t repeat =
                (chart.repeat_u ? ATLAS_CHART_REPEAT_U : 0u) | (chart.repeat_v ? ATLAS_CHART_REPEAT_V : 0u);
            entry(places_[i])[ATLAS_CHART_SIZE] = chart.width | chart.height << 16;
            const uint32_t alpha = shapes_[i].alpha ? ATLAS_CHART_ALPHA : 0u;
            entry(places_[i])[ATLAS_CHART_FLAGS] = repeat | alpha | plan_.chart_mips(shapes_[i]) << 8;
        }
        for (const SharedChartUse& use : shared_) {
            entry(use.chart_in_tile)[ATLAS_CHART_SIZE] = use.number;
            entry(use.chart_in_tile)[ATLAS_CHART_FLAGS] = ATLAS_CHART_SHARED | coarse_float_bits(use.metres_per_texel)
                                                                                   << 16;
        }
        // Coarsest first, so that the parts of later steps only follow.
        uint64_t begin = words.size();
        for (uint32_t mip = plan_.mip_count; mip-- > 0;) {
            words[kMipTableAt + mip] = static_cast<uint32_t>(begin);
            begin += part_words(shapes_, total_, plan_, mip);
        }
        assert(begin <= ~uint32_t{0});
        return words;
    }

    void append_part(std::vector<uint32_t>& words, StepBlocks& blocks, uint32_t mip) const {
        const size_t begin = words.size();
        words.resize(begin + total_, 0);
        for (const bool alpha : {false, true}) {
            for (size_t i = 0; i < charts_.size(); ++i) {
                if (shapes_[i].alpha != alpha || mip >= mips_[i].size()) continue;
                words[begin + places_[i]] = static_cast<uint32_t>(words.size() - begin);
                blocks.append(mips_[i][mip]);
            }
        }
    }

    std::span<const ChartImage> charts_;
    std::span<const SharedChartUse> shared_;
    AtlasOptions options_;
    uint64_t total_;
    std::vector<ChartShape> shapes_;
    MipPlan plan_;
    std::vector<uint32_t> places_;
    std::vector<std::vector<ChartImage>> mips_;
};

}  // namespace

ChartImage downsample(const ChartImage& image) {
    if (!image.alpha.empty()) return downsample_masked(image);
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

LayerSteps encode_atlas(std::span<const ChartImage> charts, const AtlasOptions& options,
                        std::span<const SharedChartUse> shared) {
    return LayerEncoding(charts, shared, options).steps();
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
    if (table < kMipTableAt || table + 16 > end)
        return error_at("mip table reaches outside step 0", ATLAS_WORD_MIP_TABLE);
    if (words[ATLAS_WORD_CHART_COUNT] > (end - ATLAS_HEADER_WORDS) / ATLAS_CHART_WORDS) {
        return error_at("chart table reaches outside step 0", ATLAS_WORD_CHART_COUNT);
    }
    return Done{};
}

ChartShape shape_in_table(std::span<const uint32_t> words, uint64_t entry) {
    return chart_shape(words[entry + ATLAS_CHART_SIZE], words[entry + ATLAS_CHART_FLAGS]);
}

/// Of a chart's flags word; 0 for shared charts.
uint32_t mips_of(uint32_t flags) {
    return flags >> 8 & 0xffu;
}

Status check_shared_chart(std::span<const uint32_t> words, uint64_t entry, uint64_t dictionary_size) {
    const uint32_t flags = words[entry + ATLAS_CHART_FLAGS];
    if (words[entry + ATLAS_CHART_SIZE] >= dictionary_size)
        return error_at("shared chart that the dictionary has not", entry + ATLAS_CHART_SIZE);
    if ((flags & 0xffffu) != ATLAS_CHART_SHARED)
        return error_at("shared chart with mips or other flags", entry + ATLAS_CHART_FLAGS);
    const float metres = from_coarse_float_bits(flags >> 16);
    if (!std::isfinite(metres) || std::signbit(metres))
        return error_at("shared chart without a length of its texels", entry + ATLAS_CHART_FLAGS);
    return Done{};
}

Status check_local_chart(std::span<const uint32_t> words, uint64_t entry) {
    const ChartShape size = shape_in_table(words, entry);
    if (size.width == 0 || size.height == 0 || size.width > kGreatestChartSide || size.height > kGreatestChartSide)
        return error_at("chart size out of range", entry + ATLAS_CHART_SIZE);
    const uint32_t flags = words[entry + ATLAS_CHART_FLAGS];
    if (mips_of(flags) <= words[ATLAS_WORD_STEP0_MIP] || mips_of(flags) > words[ATLAS_WORD_MIP_COUNT]) {
        return error_at("chart without a mip in step 0, or with more than the atlas has", entry + ATLAS_CHART_FLAGS);
    }
    if ((flags & 0xffff00ffu & ~(ATLAS_CHART_REPEAT_U | ATLAS_CHART_REPEAT_V | ATLAS_CHART_ALPHA)) != 0)
        return error_at("unknown chart flags", entry + ATLAS_CHART_FLAGS);
    return Done{};
}

Status check_chart_table(std::span<const uint32_t> words, uint64_t dictionary_size) {
    for (uint64_t chart = 0; chart < words[ATLAS_WORD_CHART_COUNT]; ++chart) {
        const uint64_t entry = ATLAS_HEADER_WORDS + chart * ATLAS_CHART_WORDS;
        const bool shared = (words[entry + ATLAS_CHART_FLAGS] & ATLAS_CHART_SHARED) != 0;
        const Status status =
            shared ? check_shared_chart(words, entry, dictionary_size) : check_local_chart(words, entry);
        if (!status) return status;
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
        const uint64_t offset = words[part + chart];
        if (mip >= mips_of(words[entry + ATLAS_CHART_FLAGS])) {
            if (offset != 0) return error_at("blocks of a mip that the chart has not", part + chart);
            continue;
        }
        const uint64_t room = end - part;
        if (offset < charts || offset > room || block_words(shape_in_table(words, entry), mip) > room - offset) {
            return error_at("blocks of mip " + std::to_string(mip) + " reach outside their step", part + chart);
        }
    }
    return Done{};
}

}  // namespace

Result<AtlasLayerView> AtlasLayerView::create(std::span<const uint32_t> words, std::span<const uint32_t> step_words,
                                              uint64_t dictionary_size) {
    if (const Status status = check_header(words, step_words); !status) return status.error();
    if (const Status status = check_chart_table(words, dictionary_size); !status) return status.error();
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
    return mips_of(flags(chart));
}

bool AtlasLayerView::has_alpha(uint32_t chart) const {
    return (flags(chart) & (ATLAS_CHART_SHARED | ATLAS_CHART_ALPHA)) == ATLAS_CHART_ALPHA;
}

bool AtlasLayerView::is_shared(uint32_t chart) const {
    return (flags(chart) & ATLAS_CHART_SHARED) != 0;
}

std::vector<SharedChartUse> AtlasLayerView::shared_charts() const {
    std::vector<SharedChartUse> uses;
    for (uint32_t chart = 0; chart < chart_count(); ++chart) {
        if (!is_shared(chart)) continue;
        const size_t entry = ATLAS_HEADER_WORDS + size_t{chart} * ATLAS_CHART_WORDS;
        uses.push_back({chart, words_[entry + ATLAS_CHART_SIZE], from_coarse_float_bits(flags(chart) >> 16)});
    }
    return uses;
}

const uint32_t* AtlasLayerView::block_of(uint32_t chart, uint32_t mip, uint32_t x, uint32_t y) const {
    assert(!is_shared(chart) && mip >= finest_mip_ && mip < mip_count(chart));
    assert(x < mip_side(width(chart), mip) && y < mip_side(height(chart), mip));
    const size_t part = words_[words_[ATLAS_WORD_MIP_TABLE] + mip];
    const size_t blocks_across = (mip_side(width(chart), mip) + 3) / 4;
    const size_t block = y / 4 * blocks_across + x / 4;
    return &words_[part + words_[part + chart] + block * (has_alpha(chart) ? kBc3BlockWords : kBc1BlockWords)];
}

void AtlasLayerView::texel(uint32_t chart, uint32_t mip, uint32_t x, uint32_t y, uint8_t rgb[3]) const {
    const uint32_t* block = block_of(chart, mip, x, y);
    decode_bc1_texel(has_alpha(chart) ? block + kBc4BlockWords : block, y % 4 * 4 + x % 4, rgb);
}

uint8_t AtlasLayerView::alpha(uint32_t chart, uint32_t mip, uint32_t x, uint32_t y) const {
    return has_alpha(chart) ? decode_bc4_texel(block_of(chart, mip, x, y), y % 4 * 4 + x % 4) : uint8_t{255};
}

}  // namespace citystream::codec::atlas
