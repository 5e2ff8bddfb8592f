// The patch map: exact on every input, pools really shared, one way to write it, and nothing that a checked map can
// make a reader do.
#include "codec/facade/patch_map.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "codec/facade/facade_form_layout.h"
#include "codec/facade/patch_structure.h"
#include "tests/codec/damage.h"
#include "tests/codec/facade/relief_cases.h"
#include "tests/shaders/facade_on_cpu.h"

namespace citystream::codec::facade {
namespace {

RunGrid grid_of(const FacadeMatrices& relief) {
    return make_run_grid(relief).value();
}

std::vector<uint32_t> encoded(const FacadeMatrices& relief) {
    return encode_patch_map(grid_of(relief)).value();
}

FacadeMatrices turned(const FacadeMatrices& relief) {
    FacadeMatrices other = uniform_relief(relief.height, relief.width, 0, 0);
    for (uint32_t y = 0; y < relief.height; ++y) {
        for (uint32_t x = 0; x < relief.width; ++x) {
            const size_t from = size_t{y} * relief.width + x, to = size_t{x} * relief.height + y;
            other.displacement_mm[to] = relief.displacement_mm[from];
            other.material[to] = relief.material[from];
        }
    }
    return other;
}

TEST(PatchMap, GivesEveryReliefBack) {
    std::vector<ReliefCase> cases = small_reliefs();
    for (ReliefCase& large : large_reliefs()) cases.push_back(std::move(large));
    for (const ReliefCase& c : cases) {
        for (const FacadeMatrices& relief : {c.relief, turned(c.relief)}) {
            const RunGrid grid = grid_of(relief);
            const auto words = encode_patch_map(grid);
            ASSERT_TRUE(words.ok()) << c.name << ": " << words.error().text();
            ASSERT_TRUE(check_patch_map(*words).ok()) << c.name << ": " << check_patch_map(*words).error().text();
            EXPECT_EQ(decode_patch_map(*words).value(), grid) << c.name;
        }
    }
}

TEST(PatchMap, GivesRandomRectanglesBack) {
    for (uint64_t seed = 1; seed <= 60; ++seed) {
        TestNumbers numbers(seed);
        const uint32_t width = 1 + numbers.below(300), height = 1 + numbers.below(300);
        FacadeMatrices relief = uniform_relief(width, height, 0, 0);
        const uint32_t rectangles = numbers.below(200);
        for (uint32_t i = 0; i < rectangles; ++i) {
            const uint32_t x = numbers.below(width), y = numbers.below(height);
            const int32_t depth = numbers.below(9) == 0 ? kOpenDisplacement : static_cast<int32_t>(numbers.below(500));
            fill_rectangle(relief, x, std::min(width, x + 1 + numbers.below(60)), y, y + 1 + numbers.below(60), depth,
                           numbers.below(12));
        }
        const RunGrid grid = grid_of(relief);
        const auto words = encode_patch_map(grid);
        ASSERT_TRUE(words.ok()) << seed << ": " << words.error().text();
        ASSERT_EQ(decode_patch_map(*words).value(), grid) << seed;
    }
}

TEST(PatchMap, TakesTheLargestSides) {
    FacadeMatrices relief = uniform_relief(8192, 8192, -5, 1);
    fill_rectangle(relief, 8191, 8192, 8191, 8192, 32767, 65535);
    fill_rectangle(relief, 4000, 4100, 0, 8192, -32767, 2);
    const RunGrid grid = grid_of(relief);
    const auto words = encode_patch_map(grid);
    ASSERT_TRUE(words.ok());
    EXPECT_LT(words->size(), 64u);
    EXPECT_EQ(decode_patch_map(*words).value(), grid);
}

TEST(PatchMap, EncodesWhatRefusesToBeAFacadeInBoundedTime) {
    const auto start = std::chrono::steady_clock::now();
    const RunGrid few = grid_of(noise_relief(500, 500, 0, 3, 2));
    const auto words = encode_patch_map(few);
    if (words) {
        EXPECT_EQ(decode_patch_map(*words).value(), few);
    }
    FacadeMatrices different = uniform_relief(300, 300, 0, 0);
    for (uint32_t i = 0; i < 90000; ++i) {
        different.displacement_mm[i] = static_cast<int16_t>(i % 30000);
        different.material[i] = static_cast<uint16_t>(i / 30000);
    }
    EXPECT_FALSE(encode_patch_map(grid_of(different)).ok());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("noise of 500 x 500 runs and 90000 labels: %.2f s\n", seconds.count());
    EXPECT_LT(seconds.count(), 20);
}

TEST(PatchMap, StoresEqualFloorsAndWindowsOnce) {
    const auto many = read_patch_words(encoded(figure8_relief(20, 10))).value();
    EXPECT_LE(many.lists.size(), 2u);
    EXPECT_LE(many.patches.size(), 2u);
    EXPECT_LE(many.grids.size(), 2u);
    EXPECT_LT(encoded(figure8_relief(20, 10)).size(), 120u);
}

TEST(PatchMap, SharesThePartsOfWindowsThatDifferInMaterialOrSize) {
    FacadeMatrices relief = uniform_relief(200, 60, 0, 0);
    const auto window = [&](uint32_t x, uint32_t width, uint32_t material) {
        fill_rectangle(relief, x, x + width, 10, 50, -30, material);
        fill_rectangle(relief, x + 3, x + width - 3, 13, 30, -60, material + 1);
        fill_rectangle(relief, x + 3, x + width - 3, 33, 47, -60, material + 1);
    };
    window(10, 30, 1);
    window(60, 30, 5);   // other materials
    window(110, 44, 1);  // wider
    window(170, 30, 1);  // equal to the first
    const auto map = read_patch_words(encoded(relief)).value();
    EXPECT_LT(map.grids.size(), 3u);
    EXPECT_LT(map.break_lists.size(), 5u);
    EXPECT_LE(map.palettes.size(), 3u);
    EXPECT_LE(map.patches.size(), 3u);
}

TEST(PatchMap, TurnsWhereFloorsAreTheColumns) {
    const auto upright = encoded(window_relief(400, 300, 1, false));
    const auto lying = encoded(turned(window_relief(400, 300, 1, false)));
    EXPECT_NE(read_patch_words(upright)->transposed, read_patch_words(lying)->transposed);
    EXPECT_NEAR(static_cast<double>(upright.size()), static_cast<double>(lying.size()), 4);
}

TEST(PatchMap, KeepsItsBytes) {
    FacadeMatrices relief = uniform_relief(40, 30, 0, 1);
    fill_rectangle(relief, 5, 17, 8, 22, -60, 2);
    fill_rectangle(relief, 7, 15, 10, 20, -90, 3);
    fill_rectangle(relief, 25, 37, 8, 22, -60, 4);
    fill_rectangle(relief, 27, 35, 10, 20, -90, 5);
    const std::vector<uint32_t> golden = {0x00014643u, 0x001e0028u, 0x0000ffa6u, 0x00050001u, 0x05207000u,
                                          0x00000010u, 0x00000012u, 0x0062001eu, 0x59428804u, 0x44f1c508u,
                                          0x889636d9u, 0x00000046u, 0x5103211au, 0x00000e30u, 0x11321224u,
                                          0x00000000u, 0xa0082c80u, 0x01464527u, 0x00000b40u, 0x0000b540u};
    EXPECT_EQ(encoded(relief), golden);
}

TEST(PatchMap, GivesTheSameBytesEveryTime) {
    const FacadeMatrices relief = window_relief(300, 420, 6, true);
    EXPECT_EQ(encoded(relief), encoded(relief));
}

TEST(PatchMap, SaysWhatEveryTexelIsInTheShadersLookup) {
    for (const ReliefCase& c : small_reliefs()) {
        const auto words = encoded(c.relief);
        for (uint32_t y = 0; y < c.relief.height; ++y) {
            for (uint32_t x = 0; x < c.relief.width; ++x) {
                const size_t texel = size_t{y} * c.relief.width + x;
                const uint32_t label = make_label(c.relief.displacement_mm[texel], c.relief.material[texel]);
                ASSERT_EQ(shaders_test::lookup_on_cpu(words, x, y), label) << c.name << " " << x << ", " << y;
            }
        }
    }
}

TEST(PatchMap, RefusesEveryTruncation) {
    const auto words = encoded(window_relief(80, 100, 3, true));
    for (size_t size = 0; size < words.size(); ++size) {
        const auto cut = exact_copy(std::span(words).first(size));
        EXPECT_FALSE(check_patch_map(cut).ok()) << size;
        EXPECT_FALSE(decode_patch_map(cut).ok()) << size;
    }
    auto longer = words;
    longer.push_back(0);
    EXPECT_FALSE(check_patch_map(longer).ok());
}

TEST(PatchMap, ReadsNothingOutsideWhateverTheWordsSay) {
    const auto words = encoded(window_relief(80, 60, 3, true));
    size_t accepted = 0, refused = 0;
    for_each_mutation(words, [&](std::span<const uint32_t> damaged) {
        if (!check_patch_map(damaged).ok()) {
            ++refused;
            return;
        }
        ++accepted;
        const auto grid = decode_patch_map(damaged);
        ASSERT_TRUE(grid.ok());
        // The shaders' words throw when they are left.
        TestNumbers numbers(accepted);
        for (int i = 0; i < 20; ++i) {
            const uint32_t x = numbers.below(grid->width()), y = numbers.below(grid->height());
            (void)shaders_test::lookup_on_cpu(damaged, x, y);
            const float origin[3] = {static_cast<float>(x), static_cast<float>(y), 40000};
            const float direction[3] = {static_cast<float>(numbers.below(200)) - 100,
                                        static_cast<float>(numbers.below(200)) - 100, -40000};
            (void)shaders_test::cast_on_cpu(client::FacadeRenderer::kPatch, damaged, origin, direction);
        }
    });
    EXPECT_GT(refused, accepted / 5);
    EXPECT_GT(accepted, 0u);  // other labels, breaks, cells
}

}  // namespace
}  // namespace citystream::codec::facade
