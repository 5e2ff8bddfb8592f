#include "codec/mesh/prism_code.h"

#include <gtest/gtest.h>

#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {
namespace {

std::vector<std::byte> coded(const std::vector<Prism>& prisms) {
    bits::RangeEncoder encoder;
    encode_prisms(encoder, prisms);
    return encoder.finish();
}
/// Bytes in a buffer of exactly their size.
Result<std::vector<Prism>> decoded(std::vector<std::byte> bytes, const PrismLimits& limits = {}) {
    bytes.shrink_to_fit();
    bits::RangeDecoder decoder(bytes);
    auto prisms = decode_prisms(decoder, limits);
    if (!prisms) return prisms;
    if (const Status end = decoder.finish(); !end) return end.error();
    return prisms;
}
void expect_round_trip(const std::vector<Prism>& prisms) {
    const auto bytes = coded(prisms);
    const auto again = decoded(bytes);
    ASSERT_TRUE(again.ok()) << again.error().text();
    EXPECT_EQ(again->size(), prisms.size());
    EXPECT_EQ(sorted_triangles(join({*again, {}})), sorted_triangles(join({prisms, {}})));
}
/// What decode_prisms promises of prisms from untrusted bytes.
void expect_in_range(const std::vector<Prism>& prisms, uint32_t most_points) {
    size_t all = 0;
    for (const Prism& prism : prisms) {
        size_t points = 0;
        ASSERT_FALSE(prism.rings.empty());
        ASSERT_LE(prism.base, prism.top);
        for (const Ring& ring : prism.rings) {
            ASSERT_GE(ring.points.size(), 3u);
            points += ring.points.size();
            for (const auto& point : ring.points)
                for (const int32_t c : point) ASSERT_LT(std::abs(int64_t{c}), int64_t{1} << 30);
        }
        ASSERT_EQ(prism.walls.size(), points);
        for (const auto* triangles : {&prism.top_triangles, &prism.floor_triangles})
            for (const auto& t : *triangles)
                for (const uint32_t corner : t) ASSERT_LT(corner, points);
        all += points;
    }
    ASSERT_LE(all, most_points);
}

TEST(PrismCode, NoPrismsTravelAsAByteAtMost) {
    expect_round_trip({});
    EXPECT_LE(coded({}).size(), 1u);
}

TEST(PrismCode, APrismOfEveryKindComesBack) {
    Prism walls = make_prism({rectangle(0, 0, 10, 20)}, -5, 9);
    walls.walls = {{WallKind::kRising, -5}, {WallKind::kFalling, 3}, {WallKind::kOpen, -5}, {WallKind::kRising, 8}};
    expect_round_trip({walls});
    expect_round_trip({make_prism({rectangle(0, 0, 10, 20)}, 0, 1, true)});
    expect_round_trip(
        {make_prism({rectangle(0, 0, 100, 80), courtyard(10, 10, 20, 20), courtyard(50, 30, 30, 20)}, 0, 9, true)});
    expect_round_trip(
        {make_prism({{{{0, 0}, {5, 1}, {2, 7}}}}, 0, 9), make_prism({{{{0, 0}, {5, 1}, {2, 7}}}}, 9, 11)});
}

TEST(PrismCode, TheEndsOfTheGridComeBack) {
    constexpr int32_t kEnd = (1 << 30) - 1;
    Ring all = {{{-kEnd, -kEnd}, {kEnd, -kEnd}, {kEnd, kEnd}, {-kEnd, kEnd}}};
    expect_round_trip({make_prism({all}, -kEnd, kEnd), make_prism({rectangle(kEnd - 3, -kEnd, 3, 4)}, kEnd - 1, kEnd),
                       make_prism({rectangle(-kEnd, kEnd - 9, 3, 4)}, -kEnd, 1 - kEnd)});
}

TEST(PrismCode, EqualAndCrossingPointsComeBack) {
    Prism flat = make_prism({rectangle(4, 4, 0, 0)}, 0, 3);
    flat.top_triangles = {{0, 1, 2}, {0, 2, 3}};
    Prism bow = make_prism({{{{0, 0}, {9, 9}, {9, 0}, {0, 9}}}}, 0, 3);
    bow.top_triangles = {{0, 1, 3}, {1, 2, 3}};
    expect_round_trip({flat, bow, flat});
}

TEST(PrismCode, TownsComeBackInAllSizes) {
    for (const uint32_t houses : {1u, 2u, 17u, 100u, 1000u}) expect_round_trip(make_town(houses, houses));
}

TEST(PrismCode, TheTownIsSmallerThanItsCoordinates) {
    const auto town = make_town(1000, 5);
    size_t points = 0;
    for (const Prism& prism : town) points += prism.walls.size();
    // Raw, each corner would be two numbers of 14 bits, and each house a height.
    EXPECT_LT(coded(town).size(), points * 2);
}

TEST(PrismCode, CentimetresOnAFinerGridCostHardlyMoreThanOnTheirOwn) {
    const auto town = make_town(400, 12);
    expect_round_trip(in_centimetres(town));
    EXPECT_LT(static_cast<double>(coded(in_centimetres(town)).size()), 1.1 * static_cast<double>(coded(town).size()));
}

TEST(PrismCode, HousesThatShareEdgesCostLessThanHousesApart) {
    std::mt19937 random(13);
    std::vector<int32_t> x = {0}, y = {0};
    for (int i = 0; i < 20; ++i) {
        x.push_back(x.back() + 100 + static_cast<int32_t>(random() % 500));
        y.push_back(y.back() + 100 + static_cast<int32_t>(random() % 500));
    }
    std::vector<Prism> touching, apart;
    for (size_t i = 0; i < 20; ++i) {
        for (size_t j = 0; j < 20; ++j) {
            touching.push_back(make_prism({rectangle(x[i], y[j], x[i + 1] - x[i], y[j + 1] - y[j])}, 0, 10));
            apart.push_back(make_prism({rectangle(x[i], y[j], x[i + 1] - x[i] - 7, y[j + 1] - y[j] - 7)}, 0, 10));
        }
    }
    expect_round_trip(touching);
    EXPECT_LT(coded(touching).size(), coded(apart).size());
}

TEST(PrismCode, TheSamePrismsGiveTheSameBytes) {
    const auto town = make_town(200, 6);
    EXPECT_EQ(coded(town), coded(town));
}

TEST(PrismCode, WhatTheEncoderReturnsIsWhatIsDecoded) {
    const auto town = make_town(100, 7);
    bits::RangeEncoder encoder;
    const auto told = encode_prisms(encoder, town, 2);
    const auto coarse = decoded(encoder.finish());
    ASSERT_TRUE(coarse.ok());
    ASSERT_EQ(coarse->size(), told.size());
    for (size_t i = 0; i < told.size(); ++i) {
        EXPECT_EQ((*coarse)[i].top, told[i].top >> 2);
        for (size_t r = 0; r < told[i].rings.size(); ++r)
            for (size_t p = 0; p < told[i].rings[r].points.size(); ++p)
                EXPECT_EQ((*coarse)[i].rings[r].points[p][0], told[i].rings[r].points[p][0] >> 2);
    }
}

TEST(PrismCode, EveryTruncationIsRefusedOrInRange) {
    const auto bytes = coded(make_town(60, 8));
    for (size_t size = 0; size < bytes.size(); ++size) {
        const auto prisms = decoded({bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size)}, {5000});
        if (prisms) expect_in_range(*prisms, 5000);
    }
}

TEST(PrismCode, DamagedStreamsAreRefusedOrInRange) {
    const auto bytes = coded(make_town(30, 9));
    std::mt19937 random(10);
    for (int round = 0; round < 2500; ++round) {
        auto damaged = bytes;
        for (auto changes = 1 + random() % 3; changes > 0; --changes)
            damaged[random() % damaged.size()] = static_cast<std::byte>(random());
        const auto prisms = decoded(damaged, {2000});
        if (prisms) expect_in_range(*prisms, 2000);
    }
}

TEST(PrismCode, MorePointsThanTheLimitAreRefused) {
    const auto bytes = coded(make_town(100, 11));
    EXPECT_FALSE(decoded(bytes, {100}).ok());
    EXPECT_TRUE(decoded(bytes, {10000}).ok());
}

}  // namespace
}  // namespace citystream::codec::mesh
