#include "codec/facade/tiled_map.h"

#include <gtest/gtest.h>

#include "codec/facade/quotient_map.h"
#include "codec/facade/tiled_layout.h"
#include "tests/codec/facade/relief_cases.h"
#include "tests/shaders/facade_on_cpu.h"

namespace citystream::codec::facade {
namespace {

std::vector<uint32_t> words_of(const FacadeMatrices& relief) {
    return encode_tiled_map(make_run_grid(relief).value()).value();
}

/// A wall in which every row and column is unlike any other, of few kinds of tiles.
FacadeMatrices staircase(uint32_t steps) {
    FacadeMatrices relief = uniform_relief(3 * steps, 2 * steps, 0, 1);
    for (uint32_t i = 0; i < steps; ++i) fill_rectangle(relief, 3 * i, 3 * steps, 2 * i, 2 * i + 2, -120, 2);
    return relief;
}

TEST(TiledMap, IsSmallerThanTheQuotientWhereRowsAndColumnsAreAllDifferent) {
    const FacadeMatrices relief = staircase(256);
    const size_t quotient = encode_quotient_map(make_run_grid(relief).value())->size();
    EXPECT_LT(3 * words_of(relief).size(), quotient);
}

TEST(TiledMap, ALookupIsFourOrFiveLoads) {
    const auto words = words_of(window_relief(400, 500, 5, false));
    shaders_test::ShaderCost cost;
    for (uint32_t y = 0; y < 500; y += 3) {
        for (uint32_t x = 0; x < 400; x += 3) {
            shaders_test::ShaderCost one;
            shaders_test::lookup_on_cpu(words, x, y, &one);
            ASSERT_GE(one.loads, 4u);
            ASSERT_LE(one.loads, 6u) << "a cell of a pattern may cross groups";
            cost.loads += one.loads;
            cost.steps += 1;
        }
    }
    EXPECT_LT(static_cast<double>(cost.loads) / static_cast<double>(cost.steps), 5.1);
}

TEST(TiledMap, GoldenWords) {
    FacadeMatrices relief = uniform_relief(3, 2, 0, 0);
    fill_rectangle(relief, 1, 3, 0, 1, -2, 1);
    fill_rectangle(relief, 0, 1, 1, 2, 5, 0);
    EXPECT_EQ(words_of(relief),
              (std::vector<uint32_t>{0x00034643u, 0x00020003u, 0x0005fffeu, 0x18800001u,  // one tile, 4-bit labels
                                     5,           6,           7,           1,            // groups, step
                                     0b011,       0,           0,           3u << 26,     // column breaks 0 1 3
                                     0b11,        0,           0,           2u << 26,     // row breaks 0 1 2
                                     7,           0,           0,           0,            // one block, 7 mm above -2
                                     2,           0,           0,           0,            // 2 bits a cell
                                     0x00025554u, 0x00020002u, 0x00020002u, 0x00020002u,  // pattern
                                     0x00000782u, 0,           0,           0}));         // palette 2, 8, 7
}

}  // namespace
}  // namespace citystream::codec::facade
