#include "codec/mesh/prism_planes.h"

#include <gtest/gtest.h>

#include "codec/mesh/prism_code.h"
#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {
namespace {

struct Steps {
    std::vector<Prism> told;
    std::vector<std::vector<std::byte>> bytes;
};
/// `dropped` as of geometry steps: decreasing, the last one 0.
Steps encode(const std::vector<Prism>& prisms, const std::vector<uint32_t>& dropped) {
    Steps steps;
    bits::RangeEncoder encoder;
    PrismTree tree;
    steps.told = encode_prisms(encoder, prisms, dropped[0], &tree);
    steps.bytes.push_back(encoder.finish());
    for (size_t s = 1; s < dropped.size(); ++s) {
        encode_prism_planes(encoder, steps.told, tree.lattices, dropped[s - 1] - dropped[s], dropped[s]);
        steps.bytes.push_back(encoder.finish());
    }
    return steps;
}
void expect_same(const std::vector<Prism>& a, const std::vector<Prism>& b, uint32_t dropped) {
    ASSERT_EQ(a.size(), b.size());
    for (size_t i = 0; i < a.size(); ++i) {
        const Prism coarse = without_low_bits(a[i], dropped);
        EXPECT_EQ(coarse.base, b[i].base);
        EXPECT_EQ(coarse.top, b[i].top);
        EXPECT_EQ(coarse.walls, b[i].walls);
        for (size_t r = 0; r < a[i].rings.size(); ++r) EXPECT_EQ(coarse.rings[r].points, b[i].rings[r].points);
    }
}
void expect_steps_come_back(const std::vector<Prism>& prisms, const std::vector<uint32_t>& dropped) {
    const Steps steps = encode(prisms, dropped);
    bits::RangeDecoder decoder(steps.bytes[0]);
    auto known = decode_prisms(decoder);
    ASSERT_TRUE(known.ok());
    expect_same(steps.told, *known, dropped[0]);
    for (size_t s = 1; s < dropped.size(); ++s) {
        bits::RangeDecoder next(steps.bytes[s]);
        ASSERT_TRUE(decode_prism_planes(next, *known, dropped[s - 1] - dropped[s]).ok());
        EXPECT_TRUE(next.finish().ok());
        expect_same(steps.told, *known, dropped[s]);
    }
    EXPECT_EQ(sorted_triangles(join({*known, {}})), sorted_triangles(join({prisms, {}})));
}

TEST(PrismPlanes, EveryPrefixOfTheStepsIsThePrismsAtItsPrecision) {
    const auto town = make_town(150, 1);
    expect_steps_come_back(town, {3, 0});
    expect_steps_come_back(town, {8, 5, 2, 1, 0});
    expect_steps_come_back(town, {29, 0});
    expect_steps_come_back({}, {4, 0});
}

TEST(PrismPlanes, WallsOfTheirOwnBaseAndNegativeHeightsComeBack) {
    Prism walls = make_prism({rectangle(-7, -9, 100, 200), courtyard(10, 10, 20, 20)}, -50, 9);
    walls.walls[0] = {WallKind::kFalling, 3};
    walls.walls[1] = {WallKind::kRising, -49};
    walls.walls[5] = {WallKind::kOpen, -50};
    for (const uint32_t dropped : {1u, 2u, 5u, 12u}) expect_steps_come_back({walls, walls}, {dropped, 0});
}

TEST(PrismPlanes, TheEndsOfTheGridComeBack) {
    constexpr int32_t kEnd = (1 << 30) - 1;
    expect_steps_come_back({make_prism({{{{-kEnd, -kEnd}, {kEnd, -kEnd}, {kEnd, kEnd}}}}, -kEnd, kEnd)}, {20, 7, 0});
}

TEST(PrismPlanes, BitsThatFollowFromRightAnglesAreNotToldAgain) {
    std::vector<Prism> town = make_town(500, 2);
    size_t points = 0;
    for (Prism& prism : town) {
        points += prism.walls.size();
        for (Ring& ring : prism.rings)
            for (auto& point : ring.points) point = {8 * point[0], 8 * point[1]};
    }
    // Told as they are, 6 bits a point.
    EXPECT_LT(encode(town, {3, 0}).bytes[1].size() * 8, points * 6);
}

TEST(PrismPlanes, LowerBitsOfALatticeCostNextToNothing) {
    const auto town = in_centimetres(make_town(400, 5));
    expect_steps_come_back(town, {3, 1, 0});
    const Steps one = encode(town, {0}), two = encode(town, {3, 0});
    EXPECT_LT((two.bytes[0].size() + two.bytes[1].size()) * 100, one.bytes[0].size() * 110);
}

TEST(PrismPlanes, DamagedBitsAreRefusedOrInRange) {
    const Steps steps = encode(make_town(40, 3), {4, 0});
    bits::RangeDecoder decoder(steps.bytes[0]);
    const auto coarse = decode_prisms(decoder);
    ASSERT_TRUE(coarse.ok());
    std::mt19937 random(4);
    for (size_t round = 0; round < 1000 + steps.bytes[1].size(); ++round) {
        auto damaged = steps.bytes[1];
        if (round < damaged.size())
            damaged.resize(round);
        else
            damaged[random() % damaged.size()] = static_cast<std::byte>(random());
        bits::RangeDecoder next(damaged);
        auto prisms = *coarse;
        if (!decode_prism_planes(next, prisms, 4)) continue;
        for (size_t i = 0; i < prisms.size(); ++i) {
            EXPECT_EQ(prisms[i].base >> 4, (*coarse)[i].base);
            EXPECT_LE(prisms[i].base, prisms[i].top);
        }
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
