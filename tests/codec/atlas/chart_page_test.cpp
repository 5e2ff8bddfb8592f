// Packed pages as the shader sees them, on the CPU: charts with borders in a common image, its mips, and samples where
// the shader takes them. What must hold whatever the renderer does: no chart shows another's texels.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "codec/atlas/bc1.h"
#include "codec/atlas/chart_border.h"
#include "codec/atlas/rectangle_packing_atlas.h"
#include "codec/atlas/wrap_coordinate.h"
#include "tests/codec/atlas/rectangle_sets.h"
#include "tests/shaders/wrap_coordinate_on_cpu.h"

namespace citystream::codec::atlas {
namespace {

using Colour = std::array<double, 3>;

struct Picture {
    uint32_t width = 0, height = 0;
    std::vector<double> rgb;

    Picture(uint32_t w, uint32_t h) : width(w), height(h), rgb(size_t{3} * w * h, 0) {}
    const double* at(int64_t x, int64_t y) const {
        x = std::clamp<int64_t>(x, 0, int64_t{width} - 1);
        y = std::clamp<int64_t>(y, 0, int64_t{height} - 1);
        return &rgb[3 * (static_cast<size_t>(y) * width + static_cast<size_t>(x))];
    }
    const double* wrapped(int64_t x, int64_t y) const {
        return at(((x % width) + width) % width, ((y % height) + height) % height);
    }
};

Picture halved(const Picture& fine) {
    Picture coarse(fine.width / 2, fine.height / 2);
    for (uint32_t y = 0; y < coarse.height; ++y) {
        for (uint32_t x = 0; x < coarse.width; ++x) {
            for (uint32_t c = 0; c < 3; ++c) {
                coarse.rgb[3 * (size_t{y} * coarse.width + x) + c] =
                    (fine.at(2 * x, 2 * y)[c] + fine.at(2 * x + 1, 2 * y)[c] + fine.at(2 * x, 2 * y + 1)[c] +
                     fine.at(2 * x + 1, 2 * y + 1)[c]) /
                    4;
            }
        }
    }
    return coarse;
}

using Mips = std::vector<Picture>;

Mips with_mips(Picture finest, uint32_t mips) {
    Mips chain = {std::move(finest)};
    while (chain.size() <= mips) chain.push_back(halved(chain.back()));
    return chain;
}

/// Bilinear at a place given in texels of level 0.
Colour bilinear(const Picture& picture, uint32_t level, double u, double v, bool wraps) {
    const double x = u / (1u << level) - 0.5, y = v / (1u << level) - 0.5;
    const auto x0 = static_cast<int64_t>(std::floor(x)), y0 = static_cast<int64_t>(std::floor(y));
    const double fx = x - std::floor(x), fy = y - std::floor(y);
    Colour colour{};
    for (int i = 0; i < 4; ++i) {
        const double weight = (i % 2 != 0 ? fx : 1 - fx) * (i / 2 != 0 ? fy : 1 - fy);
        if (weight == 0) continue;
        const int64_t tx = x0 + i % 2, ty = y0 + i / 2;
        const double* texel = wraps ? picture.wrapped(tx, ty) : picture.at(tx, ty);
        for (uint32_t c = 0; c < 3; ++c) colour[c] += weight * texel[c];
    }
    return colour;
}

double difference(const Colour& a, const Colour& b) {
    double most = 0;
    for (size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(a[c] - b[c]));
    return most;
}

using Paint = std::function<std::array<uint8_t, 3>(uint32_t chart, uint32_t x, uint32_t y)>;

/// Bytes of one page, all charts painted (x, y in the chart's interior); what no chart covers is white.
std::vector<uint8_t> page_bytes(const AtlasPacking& packing, std::span<const ChartRequest> charts, const Paint& paint) {
    const AtlasPage& page = packing.pages[0];
    std::vector<uint8_t> bytes(size_t{3} * page.width * page.height, 255);
    for (uint32_t i = 0; i < charts.size(); ++i) {
        const PackedChart& chart = packing.charts[i];
        std::vector<uint8_t> interior;
        for (uint32_t y = 0; y < chart.interior.height; ++y) {
            for (uint32_t x = 0; x < chart.interior.width; ++x) {
                const auto rgb = paint(i, x, y);
                interior.insert(interior.end(), rgb.begin(), rgb.end());
            }
        }
        const auto padded =
            add_border(interior, chart.interior.size(), 3, chart.border, charts[i].repeat_u, charts[i].repeat_v);
        for (uint32_t y = 0; y < chart.padded.height; ++y) {
            std::copy_n(&padded[size_t{3} * y * chart.padded.width], 3 * chart.padded.width,
                        &bytes[3 * (size_t{chart.padded.y + y} * page.width + chart.padded.x)]);
        }
    }
    return bytes;
}

Picture picture_of(std::span<const uint8_t> bytes, uint32_t width, uint32_t height) {
    Picture picture(width, height);
    std::transform(bytes.begin(), bytes.end(), picture.rgb.begin(), [](uint8_t value) { return value / 255.0; });
    return picture;
}

AtlasPacking packed(std::span<const ChartRequest> charts, uint32_t mips, BorderRule rule, bool blocks = true) {
    AtlasPackingOptions options;
    options.mips = mips;
    options.border = rule;
    options.blocks = blocks;
    auto packing = pack_atlas(charts, options);
    EXPECT_TRUE(packing.ok());
    EXPECT_EQ(packing->pages.size(), 1u);
    return std::move(*packing);
}

/// Equation 2 along an axis; a negative size: it does not repeat.
float wrapped_texel(float origin, float size, float place, float level) {
    return shaders_test::wrap_texel_on_cpu({origin, origin, size, size}, {place, place}, level)[0];
}

ChartFrame frame_of(const Rectangle& interior, bool repeat_u, bool repeat_v) {
    const auto width = static_cast<float>(interior.width), height = static_cast<float>(interior.height);
    return {static_cast<float>(interior.x), static_cast<float>(interior.y), repeat_u ? width : -width,
            repeat_v ? height : -height};
}

std::vector<ChartRequest> some_charts(uint64_t seed, size_t count) {
    tests::Dice dice(seed);
    auto charts = tests::random_charts(dice, count, 30, 120);
    for (ChartRequest& chart : charts) chart.source = chart.wanted;
    return charts;
}

std::array<uint8_t, 3> noise(uint32_t chart, uint32_t x, uint32_t y) {
    tests::Dice dice(chart * 1000003u + x * 1009u + y);
    return {static_cast<uint8_t>(dice.roll(0, 255)), static_cast<uint8_t>(dice.roll(0, 255)),
            static_cast<uint8_t>(dice.roll(0, 255))};
}

/// The chart alone, as a texture of its own.
Picture standalone(const PackedChart& chart, uint32_t index, const Paint& paint) {
    Picture picture(chart.interior.width, chart.interior.height);
    for (uint32_t y = 0; y < picture.height; ++y) {
        for (uint32_t x = 0; x < picture.width; ++x) {
            const auto rgb = paint(index, x, y);
            for (uint32_t c = 0; c < 3; ++c) picture.rgb[3 * (size_t{y} * picture.width + x) + c] = rgb[c] / 255.0;
        }
    }
    return picture;
}

TEST(ChartPage, TiledSevenByFiveShowsWhatARepeatingTextureShows) {
    auto charts = some_charts(1, 20);
    for (ChartRequest& chart : charts) chart.repeat_u = chart.repeat_v = true;
    const AtlasPacking packing = packed(charts, 2, BorderRule::kUniform);
    const Picture page =
        picture_of(page_bytes(packing, charts, noise), packing.pages[0].width, packing.pages[0].height);
    for (uint32_t i = 0; i < charts.size(); i += 3) {
        const PackedChart& chart = packing.charts[i];
        const Picture alone = standalone(chart, i, noise);
        const ChartFrame frame = frame_of(chart.interior, true, true);
        size_t samples = 0, wrong = 0;
        for (uint32_t sv = 0; sv < 5 * 512; sv += 37) {
            for (uint32_t su = 0; su < 7 * 512; su += 13) {
                const auto place_u = static_cast<float>(su * kWrapStep), place_v = static_cast<float>(sv * kWrapStep);
                const double u = wrapped_texel(frame.origin_u, frame.size_u, place_u, 0);
                const double v = wrapped_texel(frame.origin_v, frame.size_v, place_v, 0);
                const double alone_u = su * kWrapStep * alone.width, alone_v = sv * kWrapStep * alone.height;
                ++samples;
                if (!std::equal(page.at(static_cast<int64_t>(u), static_cast<int64_t>(v)),
                                page.at(static_cast<int64_t>(u), static_cast<int64_t>(v)) + 3,
                                alone.wrapped(static_cast<int64_t>(alone_u), static_cast<int64_t>(alone_v))))
                    ++wrong;
                ASSERT_LE(difference(bilinear(page, 0, u, v, false), bilinear(alone, 0, alone_u, alone_v, true)),
                          2 / 255.0);
            }
        }
        EXPECT_LE(static_cast<double>(wrong), 0.001 * static_cast<double>(samples));
    }
}

TEST(ChartPage, MipsOfASmoothTileShowWhatItsOwnMipsShow) {
    auto charts = some_charts(2, 12);
    for (ChartRequest& chart : charts) chart.repeat_u = chart.repeat_v = true;
    const AtlasPacking packing = packed(charts, 2, BorderRule::kUniform);
    const Paint waves = [&](uint32_t i, uint32_t x, uint32_t y) {
        const Rectangle& size = packing.charts[i].interior;
        const double a = std::sin(2 * M_PI * (x + 0.5) / size.width), b = std::cos(2 * M_PI * (y + 0.5) / size.height);
        const auto grey = static_cast<uint8_t>(std::lround(128 + 25 * a + 25 * b));
        return std::array<uint8_t, 3>{grey, grey, static_cast<uint8_t>(255 - grey)};
    };
    const Mips page =
        with_mips(picture_of(page_bytes(packing, charts, waves), packing.pages[0].width, packing.pages[0].height), 2);
    for (uint32_t i = 0; i < charts.size(); ++i) {
        const PackedChart& chart = packing.charts[i];
        if (std::min(chart.interior.width, chart.interior.height) < 40) continue;
        const Mips alone = with_mips(standalone(chart, i, waves), 2);
        const ChartFrame frame = frame_of(chart.interior, true, true);
        for (uint32_t level = 0; level <= 2; ++level) {
            for (uint32_t s = 0; s < 2 * 512; s += 3) {
                const auto place = static_cast<float>(s * kWrapStep);
                const double u = wrapped_texel(frame.origin_u, frame.size_u, place, static_cast<float>(level));
                const double v = wrapped_texel(frame.origin_v, frame.size_v, place, static_cast<float>(level));
                const Colour own = bilinear(alone[level], level, s * kWrapStep * alone[0].width,
                                            s * kWrapStep * alone[0].height, true);
                ASSERT_LE(difference(bilinear(page[level], level, u, v, false), own), 2 / 255.0) << level;
            }
        }
    }
}

TEST(ChartPage, HasNoSeamWhereTilesMeetAtAnyMip) {
    auto charts = some_charts(3, 12);
    for (ChartRequest& chart : charts) chart.repeat_u = chart.repeat_v = true;
    for (uint32_t mips = 0; mips <= 3; ++mips) {
        const AtlasPacking packing = packed(charts, mips, BorderRule::kWhereRepeating);
        const Mips page = with_mips(
            picture_of(page_bytes(packing, charts, noise), packing.pages[0].width, packing.pages[0].height), mips);
        for (const PackedChart& chart : packing.charts) {
            const Rectangle& in = chart.interior;
            for (uint32_t level = 0; level <= mips; ++level) {
                for (double across = 0; across < 1; across += 0.07) {
                    const double v = in.y + across * in.height, u = in.x + across * in.width;
                    const Colour left = bilinear(page[level], level, in.x, v, false);
                    const Colour right = bilinear(page[level], level, in.x + in.width, v, false);
                    const Colour bottom = bilinear(page[level], level, u, in.y, false);
                    const Colour top = bilinear(page[level], level, u, in.y + in.height, false);
                    ASSERT_LT(difference(left, right), 1e-9) << mips << " " << level;
                    ASSERT_LT(difference(bottom, top), 1e-9) << mips << " " << level;
                }
            }
        }
    }
}

/// The largest part of a foreign channel in any sample of any chart, charts painted pure red, green and blue.
double most_foreign(uint32_t mips, BorderRule rule, uint64_t seed) {
    const auto charts = some_charts(seed, 30);
    const AtlasPacking packing = packed(charts, mips, rule);
    const Paint pure = [](uint32_t i, uint32_t, uint32_t) {
        std::array<uint8_t, 3> rgb{};
        rgb[i % 3] = 255;
        return rgb;
    };
    const Mips page =
        with_mips(picture_of(page_bytes(packing, charts, pure), packing.pages[0].width, packing.pages[0].height), mips);
    double most = 0;
    for (uint32_t i = 0; i < charts.size(); ++i) {
        const ChartFrame frame = frame_of(packing.charts[i].interior, charts[i].repeat_u, charts[i].repeat_v);
        for (uint32_t s = 0; s <= 512; ++s) {
            for (const double level : {0.0, 0.5, 1.0, 1.5, 2.0, 3.0}) {
                if (level > mips) continue;
                // Both ends of an axis that does not repeat are shown, too.
                const auto place = static_cast<float>(s * kWrapStep), by = static_cast<float>(level);
                const double u = wrapped_texel(frame.origin_u, frame.size_u, place, by);
                const double v = wrapped_texel(frame.origin_v, frame.size_v, place, by);
                for (const double at : {std::floor(level), std::ceil(level)}) {
                    const auto mip = static_cast<uint32_t>(at);
                    const Colour seen = bilinear(page[mip], mip, u, v, false);
                    most = std::max({most, seen[(i + 1) % 3], seen[(i + 2) % 3]});
                }
            }
        }
    }
    return most;
}

TEST(ChartPage, NoChartShowsItsNeighboursColourAtAnyMip) {
    for (uint32_t mips = 0; mips <= 3; ++mips) {
        EXPECT_LE(most_foreign(mips, BorderRule::kUniform, 4 + mips), 1 / 255.0) << mips;
        EXPECT_LE(most_foreign(mips, BorderRule::kWhereRepeating, 4 + mips), 1 / 255.0) << mips;
    }
    for (uint32_t mips = 1; mips <= 3; ++mips)
        EXPECT_LE(most_foreign(mips, BorderRule::kPaper, 4 + mips), 1 / 255.0) << mips;
}

TEST(ChartPage, BleedsWithoutMipsByThePapersRule) {
    EXPECT_GT(most_foreign(0, BorderRule::kPaper, 4), 0.4);
}

/// BC1 blocks of all mips of a page.
std::vector<std::vector<uint32_t>> blocks_of(const Mips& mips) {
    std::vector<std::vector<uint32_t>> all;
    for (const Picture& mip : mips) {
        std::vector<uint32_t> blocks;
        for (uint32_t y = 0; y < mip.height; y += 4) {
            for (uint32_t x = 0; x < mip.width; x += 4) {
                uint8_t rgb[48];
                for (uint32_t t = 0; t < 16; ++t) {
                    const double* texel = mip.at(x + t % 4, y + t / 4);
                    for (uint32_t c = 0; c < 3; ++c)
                        rgb[3 * t + c] = static_cast<uint8_t>(std::floor(texel[c] * 255 + 0.5));
                }
                uint32_t block[2];
                encode_bc1_block(rgb, block);
                blocks.insert(blocks.end(), block, block + 2);
            }
        }
        all.push_back(std::move(blocks));
    }
    return all;
}

/// Blocks of other charts (or of none) that change when one chart is painted anew.
size_t foreign_blocks_changed(uint32_t mips, bool aligned_for_blocks) {
    const auto charts = some_charts(9, 12);
    const AtlasPacking packing = packed(charts, mips, BorderRule::kUniform, aligned_for_blocks);
    const AtlasPage& page = packing.pages[0];
    size_t changed = 0;
    const auto before =
        blocks_of(with_mips(picture_of(page_bytes(packing, charts, noise), page.width, page.height), mips));
    for (uint32_t edited = 0; edited < charts.size(); edited += 4) {
        const Paint paint = [&](uint32_t i, uint32_t x, uint32_t y) { return noise(i == edited ? 77 : i, x, y); };
        const auto after =
            blocks_of(with_mips(picture_of(page_bytes(packing, charts, paint), page.width, page.height), mips));
        const Rectangle& own = packing.charts[edited].padded;
        size_t own_changed = 0;
        for (uint32_t level = 0; level <= mips; ++level) {
            const uint32_t across = (std::max(page.width >> level, 1u) + 3) / 4, side = 4u << level;
            for (size_t b = 0; b < before[level].size() / 2; ++b) {
                if (before[level][2 * b] == after[level][2 * b] && before[level][2 * b + 1] == after[level][2 * b + 1])
                    continue;
                const uint64_t x = b % across * side, y = b / across * side;
                const bool inside =
                    x >= own.x && y >= own.y && x + side <= own.x + own.width && y + side <= own.y + own.height;
                ++(inside ? own_changed : changed);
            }
        }
        EXPECT_GT(own_changed, 0u);
    }
    return changed;
}

TEST(ChartPage, EditingOneChartChangesNoBlockOfAnotherAtAnyMip) {
    for (uint32_t mips = 0; mips <= 2; ++mips) EXPECT_EQ(foreign_blocks_changed(mips, true), 0u) << mips;
    // Aligned for texels only, blocks of coarser mips straddle charts: the check above can fail.
    EXPECT_GT(foreign_blocks_changed(2, false), 0u);
}

}  // namespace
}  // namespace citystream::codec::atlas
