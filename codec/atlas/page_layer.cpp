#include "codec/atlas/page_layer.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "codec/atlas/bc1.h"
#include "codec/atlas/chart_border.h"
#include "codec/atlas/chart_content.h"
#include "codec/atlas/linear_bytes.h"
#include "codec/atlas/resample.h"
#include "codec/atlas/step_blocks.h"
#include "codec/atlas/wrap_coordinate_layout.h"

namespace citystream::codec::atlas {
namespace {

constexpr uint32_t kGreatestPage = 4096;
constexpr uint32_t kBlockWords = 2;
constexpr uint32_t kMostPages = 1u << 16;
static_assert(PAGES_MOST_MIPS == kMostMips);
static_assert(PAGES_CHART_REPEAT_U == 1 && PAGES_CHART_REPEAT_V == 2);

uint64_t level_words(uint32_t width, uint32_t height, uint32_t mip) {
    return uint64_t{width >> mip >> 2} * (height >> mip >> 2) * kBlockWords;
}

/// A page's texels at one level.
struct PagePicture {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgb;
};

/// 2 x 2 box in linear light, as chart mips are made.
PagePicture halved(const PagePicture& fine) {
    PagePicture coarse{fine.width / 2, fine.height / 2, {}};
    coarse.rgb.resize(size_t{3} * coarse.width * coarse.height);
    const size_t row = size_t{3} * fine.width;
    uint8_t* out = coarse.rgb.data();
    const LinearBytes& light = LinearBytes::tables();
    for (uint32_t y = 0; y < coarse.height; ++y) {
        const uint8_t* low = fine.rgb.data() + 2 * y * row;
        for (uint32_t x = 0; x < coarse.width; ++x, low += 6) {
            for (size_t c = 0; c < 3; ++c)
                *out++ = light.mean_of_four(light.linear(low[c]) + light.linear(low[c + 3]) +
                                            light.linear(low[row + c]) + light.linear(low[row + c + 3]));
        }
    }
    return coarse;
}

/// The charts that take room on pages, in their places.
class PageBuilder {
  public:
    PageBuilder(std::span<const ChartImage> charts, const PageOptions& options, std::span<const float> asked)
        : charts_(charts), options_(options), asked_(asked) {}

    Result<LayerSteps> run() {
        if (Status status = check_options(); !status) return status.error();
        border_ = border_of(BorderRule::kUniform, options_.mips, true, true).u;
        if (Status status = place_charts(); !status) return status.error();
        std::vector<std::vector<PagePicture>> pages(packing_.pages.size());
        for (uint32_t page = 0; page < pages.size(); ++page) pages[page] = levels_of(page);
        return write(pages);
    }

  private:
    Status check_options() const {
        if (options_.mips > kMostMips)
            return Error{"pages of " + std::to_string(options_.mips) + " mips; at most 7 are possible"};
        const uint32_t unit = 4u << options_.mips;
        if (options_.max_page_side == 0 || options_.max_page_side > kGreatestPage || options_.max_page_side % unit != 0)
            return Error{"page side of " + std::to_string(options_.max_page_side) + " texels is no multiple of " +
                         std::to_string(unit) + " up to 4096"};
        return Done{};
    }

    Status place_charts() {
        const uint32_t greatest = longest_page_chart(options_.mips) + 2 * border_;
        const uint32_t padded = std::min(greatest, options_.max_page_side), longest = padded - 2 * border_;
        std::vector<ChartRequest> requests;
        for (uint32_t i = 0; i < charts_.size(); ++i) {
            const ChartImage& chart = charts_[i];
            assert(chart.width >= 1 && chart.height >= 1 && chart.rgb.size() == size_t{3} * chart.width * chart.height);
            if (flat_colour(chart.rgb)) continue;
            const RectangleSize size{std::min(chart.width, longest), std::min(chart.height, longest)};
            requests.push_back({asked_size(i, size), size, chart.repeat_u, chart.repeat_v});
            shown_.push_back(i);
        }
        AtlasPackingOptions packing;
        packing.mips = options_.mips;
        packing.max_page_side = options_.max_page_side;
        packing.max_chart_side = padded;
        packing.shape = options_.shape;
        if (options_.shape == PageShape::kPowerOfTwo) {
            packing.stretch = true;
            packing.fill = FillMode::kSubtrees;
            packing.fill_beyond_source = true;
        }
        auto packed = pack_atlas(requests, packing);
        if (!packed) return packed.error();
        packing_ = std::move(packed).value();
        if (packing_.pages.size() > kMostPages) return Error{"more than 65,536 pages"};
        return Done{};
    }

    /// The size at which a chart that may have `size` has texels as long as it is asked for.
    RectangleSize asked_size(uint32_t index, RectangleSize size) const {
        const ChartImage& chart = charts_[index];
        if (options_.shape == PageShape::kTight || asked_.empty() || chart.metres_per_texel <= 0) return size;
        if (asked_[index] <= chart.metres_per_texel) return size;
        const double share = double{chart.metres_per_texel} / double{asked_[index]};
        const auto side = [share](uint32_t own, uint32_t most) {
            return std::clamp(static_cast<uint32_t>(std::ceil(own * share)), 1U, most);
        };
        return {side(chart.width, size.width), side(chart.height, size.height)};
    }

    std::vector<PagePicture> levels_of(uint32_t page) const {
        const AtlasPage& size = packing_.pages[page];
        std::vector<PagePicture> levels = {{size.width, size.height, {}}};
        levels[0].rgb.resize(size_t{3} * size.width * size.height);
        for (size_t i = 0; i < shown_.size(); ++i) {
            if (packing_.charts[i].page == page) draw(charts_[shown_[i]], packing_.charts[i], levels[0]);
        }
        while (levels.size() <= options_.mips) levels.push_back(halved(levels.back()));
        return levels;
    }

    static void draw(const ChartImage& chart, const PackedChart& place, PagePicture& page) {
        const RectangleSize size = place.interior.size();
        std::vector<uint8_t> resized;
        std::span<const uint8_t> interior = chart.rgb;
        if (size.width != chart.width || size.height != chart.height) {
            const Edges edges{chart.repeat_u, chart.repeat_v};
            resized = srgb_bytes(resample(chart, size.width, size.height, Shrink::kLanczos, edges));
            interior = resized;
        }
        const auto padded = add_border(interior, size, 3, place.border, chart.repeat_u, chart.repeat_v);
        const size_t row = size_t{3} * place.padded.width;
        for (uint32_t y = 0; y < place.padded.height; ++y) {
            std::copy_n(padded.begin() + static_cast<ptrdiff_t>(y * row), row,
                        page.rgb.begin() +
                            static_cast<ptrdiff_t>(3 * (size_t{place.padded.y + y} * page.width + place.padded.x)));
        }
    }

    std::array<uint32_t, PAGES_CHART_WORDS> entry(uint32_t chart, const PackedChart* place) const {
        const ChartImage& image = charts_[chart];
        uint32_t flags = (image.repeat_u ? PAGES_CHART_REPEAT_U : 0u) | (image.repeat_v ? PAGES_CHART_REPEAT_V : 0u);
        if (place == nullptr) {
            const auto colour = *flat_colour(image.rgb);
            return {colour[0] | uint32_t{colour[1]} << 8 | uint32_t{colour[2]} << 16, 0, flags | PAGES_CHART_FLAT};
        }
        const auto packed = encode_wrap_coordinate(place->padded, border_, 0, 0);
        assert(packed.ok());
        return {packed->u, packed->v, flags | place->page << 16};
    }

    std::vector<uint32_t> tables() const {
        std::vector<uint32_t> words(PAGES_HEADER_WORDS + PAGES_PAGE_WORDS * packing_.pages.size(), 0);
        words[PAGES_WORD_MAGIC] = PAGES_MAGIC;
        words[PAGES_WORD_CHART_COUNT] = static_cast<uint32_t>(charts_.size());
        words[PAGES_WORD_PAGE_COUNT] = static_cast<uint32_t>(packing_.pages.size());
        words[PAGES_WORD_MIPS] = options_.mips | border_ << 8;
        size_t next_shown = 0;
        for (uint32_t i = 0; i < charts_.size(); ++i) {
            const bool shown = next_shown < shown_.size() && shown_[next_shown] == i;
            const auto own = entry(i, shown ? &packing_.charts[next_shown++] : nullptr);
            words.insert(words.end(), own.begin(), own.end());
        }
        uint64_t begin = words.size();
        for (uint32_t mip = options_.mips + 1; mip-- > 0;) {
            for (size_t page = 0; page < packing_.pages.size(); ++page) {
                const AtlasPage& size = packing_.pages[page];
                uint32_t* own = &words[PAGES_HEADER_WORDS + PAGES_PAGE_WORDS * page];
                own[PAGES_PAGE_SIZE] = size.width | size.height << 16;
                own[PAGES_PAGE_BLOCKS + mip] = static_cast<uint32_t>(begin);
                begin += level_words(size.width, size.height, mip);
            }
        }
        assert(begin <= ~uint32_t{0});
        return words;
    }

    /// Texels of level 0 that are longer than the chart's own were, as their metres.
    float error_of_level0() const {
        float error = 0;
        for (size_t i = 0; i < shown_.size(); ++i) {
            const ChartImage& chart = charts_[shown_[i]];
            const RectangleSize size = packing_.charts[i].interior.size();
            const float shrunk = std::max({1.0F, static_cast<float>(chart.width) / static_cast<float>(size.width),
                                           static_cast<float>(chart.height) / static_cast<float>(size.height)});
            error = std::max(error, chart.metres_per_texel * shrunk);
        }
        return error;
    }

    LayerSteps write(const std::vector<std::vector<PagePicture>>& pages) const {
        LayerSteps steps;
        const float error = error_of_level0();
        const uint32_t coarsest = pages.empty() ? 0 : options_.mips;
        for (uint32_t mip = coarsest + 1; mip-- > 0;) {
            LayerStep& step = steps.emplace_back();
            if (mip == coarsest) step.words = tables();
            StepBlocks blocks(step.words, options_.rate_distortion);
            for (const auto& levels : pages) blocks.append(levels[mip].rgb, levels[mip].width, levels[mip].height);
            step.error = std::ldexp(error, static_cast<int>(mip));
        }
        return steps;
    }

    std::span<const ChartImage> charts_;
    const PageOptions& options_;
    std::span<const float> asked_;
    uint32_t border_ = 0;
    std::vector<uint32_t> shown_;  ///< charts with places in packing_, in its order
    AtlasPacking packing_;
};

Error error_at(std::string message, uint64_t word) {
    return Error{"page layer: " + std::move(message), word * 4};
}

/// The tables of a layer, checked against the words of step 0.
struct Tables {
    uint32_t charts = 0, pages = 0, mips = 0, border = 0;
    uint64_t page(uint64_t index) const { return PAGES_HEADER_WORDS + PAGES_PAGE_WORDS * index; }
    uint64_t chart(uint64_t index) const { return page(pages) + PAGES_CHART_WORDS * index; }
    uint64_t end() const { return chart(charts); }
};

Tables tables_of(std::span<const uint32_t> words) {
    return {words[PAGES_WORD_CHART_COUNT], words[PAGES_WORD_PAGE_COUNT], words[PAGES_WORD_MIPS] & 0xffU,
            words[PAGES_WORD_MIPS] >> 8};
}

Status check_header(std::span<const uint32_t> words, std::span<const uint32_t> step_words) {
    uint64_t sum = 0;
    for (const uint32_t count : step_words) sum += count;
    if (step_words.empty() || sum != words.size())
        return error_at(
            "steps of " + std::to_string(sum) + " words in all, but " + std::to_string(words.size()) + " are there",
            words.size());
    if (words.size() > ~uint32_t{0}) return error_at("too large for 32-bit offsets", 0);
    if (step_words[0] < PAGES_HEADER_WORDS) return error_at("step 0 is shorter than its header", step_words[0]);
    if (words[PAGES_WORD_MAGIC] != PAGES_MAGIC) return error_at("wrong magic", PAGES_WORD_MAGIC);
    const Tables tables = tables_of(words);
    if (tables.mips > kMostMips) return error_at("more mips than pages can have", PAGES_WORD_MIPS);
    if (tables.border != border_of(BorderRule::kUniform, tables.mips, true, true).u)
        return error_at("border that does not go with the mips", PAGES_WORD_MIPS);
    if (tables.pages > kMostPages) return error_at("too many pages", PAGES_WORD_PAGE_COUNT);
    if (tables.end() > step_words[0]) return error_at("tables reach outside step 0", PAGES_WORD_CHART_COUNT);
    const size_t most_steps = tables.pages == 0 ? 1 : tables.mips + 1;
    if (step_words.size() > most_steps) return error_at("more steps than mips", PAGES_WORD_MIPS);
    return Done{};
}

Status check_page_sizes(std::span<const uint32_t> words, const Tables& tables) {
    const uint32_t unit = 4u << tables.mips;
    for (uint32_t page = 0; page < tables.pages; ++page) {
        const uint64_t entry = tables.page(page) + PAGES_PAGE_SIZE;
        for (const uint32_t side : {words[entry] & 0xffffU, words[entry] >> 16}) {
            if (side == 0 || side > kGreatestPage || side % unit != 0)
                return error_at("page side of " + std::to_string(side) + " texels", entry);
        }
    }
    return Done{};
}

Status check_charts(std::span<const uint32_t> words, const Tables& tables) {
    for (uint32_t chart = 0; chart < tables.charts; ++chart) {
        const uint64_t entry = tables.chart(chart);
        const uint32_t flags = words[entry + PAGES_CHART_FLAGS];
        if ((flags & 0xffffU & ~(PAGES_CHART_REPEAT_U | PAGES_CHART_REPEAT_V | PAGES_CHART_FLAT)) != 0)
            return error_at("unknown chart flags", entry + PAGES_CHART_FLAGS);
        if ((flags & PAGES_CHART_FLAT) != 0) continue;
        if (flags >> 16 >= tables.pages)
            return error_at("chart on a page that is not there", entry + PAGES_CHART_FLAGS);
        const uint32_t size = words[tables.page(flags >> 16) + PAGES_PAGE_SIZE];
        const std::array<uint32_t, 2> sides = {size & 0xffffU, size >> 16};
        for (uint32_t axis = 0; axis < 2; ++axis) {
            if ((words[entry + axis] & WRAP_PLACE_MASK) != 0) return error_at("chart with a place", entry + axis);
            if (const Status status = check_wrap_axis(words[entry + axis], tables.border, sides[axis]); !status)
                return error_at(status.error().message, entry + axis);
        }
    }
    return Done{};
}

/// The blocks of a level of every page lie in [begin, end), the words of its step.
Status check_level(std::span<const uint32_t> words, const Tables& tables, uint32_t mip, uint64_t begin, uint64_t end) {
    for (uint32_t page = 0; page < tables.pages; ++page) {
        const uint64_t entry = tables.page(page);
        const uint32_t size = words[entry + PAGES_PAGE_SIZE];
        const uint64_t blocks = words[entry + PAGES_PAGE_BLOCKS + mip];
        if (blocks < begin || blocks > end || level_words(size & 0xffffU, size >> 16, mip) > end - blocks)
            return error_at("level " + std::to_string(mip) + " reaches outside its step",
                            entry + PAGES_PAGE_BLOCKS + mip);
    }
    return Done{};
}

}  // namespace

uint32_t longest_page_chart(uint32_t mips) {
    constexpr uint32_t kPadded = (WRAP_SIZE_MASK + 1) * WRAP_GRID;
    const uint32_t unit = alignment_unit(mips, true, true);
    return kPadded / unit * unit - 2 * border_of(BorderRule::kUniform, mips, true, true).u;
}

uint32_t affordable_mips(std::span<const ChartImage> charts, uint32_t mips) {
    constexpr uint32_t kFreeMips = 3;
    constexpr uint64_t kMostPagesOfTexels = 4;
    std::vector<RectangleSize> sizes;
    for (const ChartImage& chart : charts) {
        if (!flat_colour(chart.rgb)) sizes.push_back({chart.width, chart.height});
    }
    for (; mips > kFreeMips; --mips) {
        const uint32_t unit = alignment_unit(mips, true, true), longest = longest_page_chart(mips);
        const uint32_t borders = 2 * border_of(BorderRule::kUniform, mips, true, true).u;
        const auto padded = [&](uint32_t side) { return (side + borders + unit - 1) / unit * unit; };
        uint64_t own = 0, taken = 0;
        for (const RectangleSize& size : sizes) {
            const RectangleSize kept{std::min(size.width, longest), std::min(size.height, longest)};
            own += kept.area();
            taken += uint64_t{padded(kept.width)} * padded(kept.height);
        }
        if (taken <= kMostPagesOfTexels * own) break;
    }
    return mips;
}

Result<LayerSteps> encode_pages(std::span<const ChartImage> charts, const PageOptions& options,
                                std::span<const float> asked) {
    assert(asked.empty() || asked.size() == charts.size());
    return PageBuilder(charts, options, asked).run();
}

bool is_page_layer(std::span<const uint32_t> words) {
    return words.size() > PAGES_WORD_MAGIC && words[PAGES_WORD_MAGIC] == PAGES_MAGIC;
}

Result<PageLayerView> PageLayerView::create(std::span<const uint32_t> words, std::span<const uint32_t> step_words) {
    if (const Status status = check_header(words, step_words); !status) return status.error();
    const Tables tables = tables_of(words);
    if (const Status status = check_page_sizes(words, tables); !status) return status.error();
    if (const Status status = check_charts(words, tables); !status) return status.error();
    uint64_t begin = tables.end(), end = 0;
    for (uint32_t step = 0; step < step_words.size(); ++step) {
        end += step_words[step];
        if (const Status status = check_level(words, tables, tables.mips - step, begin, end); !status)
            return status.error();
        begin = end;
    }
    PageLayerView view;
    view.words_ = words;
    view.finest_mip_ = tables.pages == 0 ? 0 : tables.mips + 1 - static_cast<uint32_t>(step_words.size());
    return view;
}

uint32_t PageLayerView::chart_count() const {
    return words_[PAGES_WORD_CHART_COUNT];
}
uint32_t PageLayerView::page_count() const {
    return words_[PAGES_WORD_PAGE_COUNT];
}
uint32_t PageLayerView::mips() const {
    return tables_of(words_).mips;
}
uint32_t PageLayerView::border() const {
    return tables_of(words_).border;
}
uint32_t PageLayerView::finest_mip() const {
    return finest_mip_;
}
uint32_t PageLayerView::width(uint32_t page) const {
    return words_[tables_of(words_).page(page) + PAGES_PAGE_SIZE] & 0xffffU;
}
uint32_t PageLayerView::height(uint32_t page) const {
    return words_[tables_of(words_).page(page) + PAGES_PAGE_SIZE] >> 16;
}

PageChart PageLayerView::chart(uint32_t index) const {
    assert(index < chart_count());
    const uint32_t* entry = &words_[tables_of(words_).chart(index)];
    PageChart chart;
    chart.flags = entry[PAGES_CHART_FLAGS] & 0xffffU;
    chart.page = entry[PAGES_CHART_FLAGS] >> 16;
    const uint32_t u = entry[PAGES_CHART_U];
    if ((chart.flags & PAGES_CHART_FLAT) != 0) {
        chart.flat = {static_cast<uint8_t>(u), static_cast<uint8_t>(u >> 8), static_cast<uint8_t>(u >> 16)};
    } else {
        chart.packed = {u, entry[PAGES_CHART_V]};
    }
    return chart;
}

void PageLayerView::texel(uint32_t page, uint32_t mip, uint32_t x, uint32_t y, uint8_t rgb[3]) const {
    assert(page < page_count() && mip >= finest_mip_ && mip <= mips());
    assert(x < width(page) >> mip && y < height(page) >> mip);
    const uint32_t* entry = &words_[tables_of(words_).page(page)];
    const uint32_t across = width(page) >> mip >> 2;
    const uint64_t block = entry[PAGES_PAGE_BLOCKS + mip] + (uint64_t{y >> 2} * across + (x >> 2)) * kBlockWords;
    decode_bc1_texel(&words_[block], (y & 3) << 2 | (x & 3), rgb);
}

}  // namespace citystream::codec::atlas
