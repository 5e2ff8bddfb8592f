// The maximum mip form: its bytes, and its pyramid on sizes that are no powers of two.
#include "codec/facade/max_mip_map.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "codec/facade/facade_form_layout.h"
#include "codec/facade/max_mip_layout.h"
#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

TEST(MaxMipMap, HasTheBytesOfItsVersion) {
    FacadeMatrices relief = uniform_relief(3, 2, 0, 0);
    relief.displacement_mm = {0, 5, 5, kOpenDisplacement, -2, 5};
    relief.material = {1, 2, 2, 0, 1, 2};
    const RunGrid grid = make_run_grid(relief).value();
    const std::vector<uint32_t> golden = {
        0x00054643, 0x00020003, 0x0005fffe, 0x00000308,  // max-mip, 3 x 2, -2..5 mm, 8 bits a material, 3 levels
        36,         0,          0,          0,           // materials
        24,         28,         32,         0,           // levels
        0,          0,          0,          0,          0,          0,          0,          0,
        0,          0,          0,          0,          0x00050000, 0x80000005, 0x0005fffe, 0,  // level 0, D
        0x00050005, 0,          0,          0,                                                  // level 1, 2 x 1
        0x00000005, 0,          0,          0,                                                  // level 2
        0x00020201, 0x00000201, 0,          0,                                                  // M
    };
    EXPECT_EQ(encode_max_mip_map(grid).value(), golden);
    EXPECT_EQ(decode_max_mip_map(golden).value(), grid);
}

TEST(MaxMipMap, HoldsTheMaximumOfEveryBlock) {
    for (const auto& [width, height] : {std::pair{37u, 21u}, {1u, 19u}, {64u, 33u}, {5u, 1u}}) {
        const FacadeMatrices relief = noise_relief(width, height, -900, 900, 4);
        const std::vector<uint32_t> words = encode_max_mip_map(make_run_grid(relief).value()).value();
        const uint32_t levels = words[FACADE_MAX_MIP_WORD_BITS] >> 8;
        for (uint32_t level = 0; level < levels; ++level) {
            const uint32_t side = 1u << level;
            for (uint32_t y = 0; y * side < height; ++y) {
                for (uint32_t x = 0; x * side < width; ++x) {
                    int32_t maximum = INT16_MIN;
                    for (uint32_t v = y * side; v < std::min(height, (y + 1) * side); ++v) {
                        for (uint32_t u = x * side; u < std::min(width, (x + 1) * side); ++u)
                            maximum = std::max<int32_t>(maximum, relief.displacement_mm[size_t{v} * width + u]);
                    }
                    ASSERT_EQ(max_mip_maximum(words, level, x, y), maximum) << level << ": " << x << ", " << y;
                }
            }
        }
        EXPECT_GE(1u << (levels - 1), std::max(width, height));
    }
}

TEST(MaxMipMap, RefusesAWrongMaximum) {
    const RunGrid grid = make_run_grid(noise_relief(9, 9, 0, 50, 2)).value();
    std::vector<uint32_t> words = encode_max_mip_map(grid).value();
    ++words[words[FACADE_MAX_MIP_WORD_LEVELS + 2]];
    const Status status = check_max_mip_map(words);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().offset, 4u * words[FACADE_MAX_MIP_WORD_LEVELS + 2]);
}

}  // namespace
}  // namespace citystream::codec::facade
