// The wire form of patch maps: the same words again, small, and nothing that bytes can make the decoder do.
#include "codec/facade/patch_wire.h"

#include <gtest/gtest.h>

#include "codec/facade/patch_map.h"
#include "tests/codec/facade/relief_cases.h"

namespace citystream::codec::facade {
namespace {

using Bytes = std::vector<std::byte>;

std::vector<uint32_t> words_of(const FacadeMatrices& relief) {
    return encode_patch_map(make_run_grid(relief).value()).value();
}

Bytes wire_of(const std::vector<uint32_t>& words) {
    bits::RangeEncoder encoder;
    put_patch_wire(words, encoder);
    return encoder.finish();
}

TEST(PatchWire, GivesTheWordsOfEveryReliefBack) {
    std::vector<ReliefCase> cases = small_reliefs();
    for (ReliefCase& large : large_reliefs()) cases.push_back(std::move(large));
    for (const ReliefCase& c : cases) {
        const auto words = words_of(c.relief);
        const Bytes wire = wire_of(words);
        bits::RangeDecoder decoder(wire);
        const auto again = get_patch_wire(decoder, 4 * words.size());
        ASSERT_TRUE(again.ok()) << c.name << ": " << again.error().text();
        EXPECT_EQ(*again, words) << c.name;
        EXPECT_TRUE(decoder.finish().ok()) << c.name;
    }
}

TEST(PatchWire, IsSmallerThanTheWords) {
    size_t resident = 0, wire = 0;
    for (uint64_t seed = 1; seed < 10; ++seed) {
        const auto words = words_of(window_relief(500, 400, seed, seed % 2 == 0));
        resident += 4 * words.size();
        wire += wire_of(words).size();
    }
    EXPECT_LT(2 * wire, resident);
}

TEST(PatchWire, NeedsEveryByte) {
    const auto words = words_of(window_relief(120, 100, 2, true));
    const Bytes wire = wire_of(words);
    for (size_t size = 0; size < wire.size(); ++size) {
        const Bytes cut(wire.begin(), wire.begin() + static_cast<std::ptrdiff_t>(size));
        bits::RangeDecoder decoder(cut);
        const auto again = get_patch_wire(decoder, 4 * words.size());
        EXPECT_FALSE(again.ok() && *again == words && decoder.finish().ok()) << size;
    }
}

TEST(PatchWire, StopsWhereTheStructureOutgrowsTheResidentBytes) {
    const auto words = words_of(window_relief(300, 300, 2, true));
    const Bytes wire = wire_of(words);
    bits::RangeDecoder decoder(wire);
    EXPECT_FALSE(get_patch_wire(decoder, words.size()).ok());
}

TEST(PatchWire, MakesWordsOrAnErrorOfAnyBytes) {
    const auto words = words_of(window_relief(200, 150, 4, true));
    const Bytes wire = wire_of(words);
    TestNumbers numbers(5);
    size_t expanded = 0;
    for (int i = 0; i < 4000; ++i) {
        Bytes damaged = wire;
        if (i % 4 == 0) {
            damaged.resize(1 + numbers.below(200));
            for (std::byte& byte : damaged) byte = static_cast<std::byte>(numbers.below(256));
        }
        const uint32_t changes = 1 + numbers.below(4);
        for (uint32_t change = 0; change < changes; ++change)
            damaged[numbers.below(static_cast<uint32_t>(damaged.size()))] ^=
                static_cast<std::byte>(1u << numbers.below(8));
        bits::RangeDecoder decoder(damaged);
        const auto again = get_patch_wire(decoder, 8 * words.size());
        if (!again) continue;
        ++expanded;
        EXPECT_EQ(check_patch_map(*again).ok(), decode_patch_map(*again).ok());
    }
    EXPECT_GT(expanded, 0u);
}

TEST(PatchWire, KeepsItsBytes) {
    FacadeMatrices relief = uniform_relief(40, 30, 0, 1);
    fill_rectangle(relief, 5, 17, 8, 22, -60, 2);
    fill_rectangle(relief, 7, 15, 10, 20, -90, 3);
    fill_rectangle(relief, 25, 37, 8, 22, -60, 4);
    fill_rectangle(relief, 27, 35, 10, 20, -90, 5);
    const std::vector<uint8_t> golden = {0xef, 0xb4, 0xed, 0x4f, 0x5d, 0x1c, 0x34, 0xc8, 0x26, 0x79, 0x95, 0x19,
                                         0x7b, 0x9b, 0xb8, 0x7b, 0xa2, 0xae, 0xc5, 0x47, 0xe0, 0x7c, 0x08, 0x7d};
    std::vector<uint8_t> wire;
    for (const std::byte byte : wire_of(words_of(relief))) wire.push_back(static_cast<uint8_t>(byte));
    EXPECT_EQ(wire, golden);
}

}  // namespace
}  // namespace citystream::codec::facade
