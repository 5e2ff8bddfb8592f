// The raw form: its bytes, and what its check refuses beyond its sizes.
#include "codec/facade/raw_map.h"

#include <gtest/gtest.h>

#include "codec/facade/facade_form_layout.h"
#include "codec/facade/raw_layout.h"
#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

RunGrid three_by_two() {
    FacadeMatrices relief = uniform_relief(3, 2, 0, 0);
    relief.displacement_mm = {0, 5, 5, kOpenDisplacement, -2, 5};
    relief.material = {1, 2, 2, 0, 1, 2};
    return make_run_grid(relief).value();
}

TEST(RawMap, HasTheBytesOfItsVersion) {
    const std::vector<uint32_t> golden = {
        0x00044643, 0x00020003, 0x0005fffe, 0x00001008,  // raw, 3 x 2, -2..5 mm, 8 bits a material, 16 a box index
        12,         16,         20,         24,          // sections
        4,          0,          0,          0,           // boxes
        0x00050000, 0x80000005, 0x0005fffe, 0,           // D
        0x00020201, 0x00000201, 0,          0,           // M
        0x00010000, 0x00020001, 0x00010003, 0,           // A
        0x00010000, 0x00020000, 0x00030000, 0x00020000,  // boxes 0..1, 0..2; 0..3, 0..2
        0x00010000, 0x00020001, 0x00020000, 0x00020001,  // 0..1, 1..2; 0..2, 1..2
    };
    EXPECT_EQ(encode_raw_map(three_by_two()).value(), golden);
    EXPECT_EQ(decode_raw_map(golden).value(), three_by_two());
    EXPECT_EQ(raw_map_bytes(three_by_two(), 4), golden.size() * sizeof(uint32_t));
}

TEST(RawMap, RefusesOtherDepthsThanStated) {
    std::vector<uint32_t> words = encode_raw_map(three_by_two()).value();
    words[FACADE_FORM_WORD_DEPTHS] = 0x0006fffe;
    const Status status = check_raw_map(words);
    ASSERT_FALSE(status.ok());
    EXPECT_EQ(status.error().offset, 4u * FACADE_FORM_WORD_DEPTHS);
}

TEST(RawMap, RefusesATexelOutsideItsBox) {
    std::vector<uint32_t> words = encode_raw_map(three_by_two()).value();
    words[20] = 0x00020000;  // texel 1 has the box of row 1
    EXPECT_FALSE(check_raw_map(words).ok());
    words[20] = 0x00040000;  // a box that does not exist
    EXPECT_FALSE(check_raw_map(words).ok());
}

}  // namespace
}  // namespace citystream::codec::facade
