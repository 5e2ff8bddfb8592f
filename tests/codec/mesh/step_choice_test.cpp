#include "codec/mesh/step_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "codec/chart_word.h"
#include "codec/mesh/lattice_code.h"
#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {
namespace {

/// A net of so many squares a side, its points up to `rough` off their places.
MeshTile net_of(int32_t squares, int32_t side, uint32_t rough) {
    std::mt19937 random(1);
    const auto off = [&] { return rough == 0 ? 0 : static_cast<int32_t>(random() % rough); };
    MeshTile tile;
    for (int32_t y = 0; y <= squares; ++y)
        for (int32_t x = 0; x <= squares; ++x)
            tile.vertices.push_back({{x * side + off(), y * side + off(), off()}, {0, 0, 1}, {}});
    const auto row = static_cast<uint32_t>(squares + 1);
    for (uint32_t y = 0; y + 1 < row; ++y) {
        for (uint32_t x = 0; x + 1 < row; ++x) {
            const uint32_t a = y * row + x;
            for (const uint32_t corner : {a, a + 1, a + row, a + row, a + 1, a + row + 1})
                tile.indices.push_back(corner);
            for (int i = 0; i < 2; ++i) tile.triangle_chart.push_back(colour_word({9, 9, 9}));
        }
    }
    tile.dressed_begin = static_cast<uint32_t>(tile.triangle_chart.size());
    return tile;
}

size_t whole(const MeshWire& wire) {
    size_t bytes = 0;
    for (const auto& step : wire.steps) bytes += step.size();
    return bytes;
}

size_t cost_of(const MeshWire& wire) {
    return wire.steps[0].size() + kWholeToFirst * whole(wire);
}

MeshWire with_steps(const MeshTile& tile, uint32_t steps) {
    MeshContentOptions options;
    options.most_steps = steps;
    return encode_mesh_wire(make_content(tile, options));
}

TEST(StepChoice, PositionsWithoutOrderTravelInSteps) {
    const MeshTile rough = net_of(20, 1 << 14, 1 << 13);
    const MeshWire chosen = encode_best_steps(rough, {});
    EXPECT_GT(chosen.steps.size(), 1u);
    EXPECT_LT(cost_of(chosen), cost_of(with_steps(rough, 1)));
    EXPECT_EQ(with_steps(rough, static_cast<uint32_t>(chosen.steps.size())).steps, chosen.steps);
}

TEST(StepChoice, TheWholeIsAtMostAQuarterLargerThanInOneStep) {
    for (const uint32_t rough : {4u, 40u, 400u, 4000u}) {
        const MeshTile net = net_of(12, 1 << 14, rough);
        const MeshWire chosen = encode_best_steps(net, {}), one = with_steps(net, 1);
        EXPECT_LE(kWholeToFirst * whole(chosen), (kWholeToFirst + 1) * whole(one)) << rough;
        const auto steps = static_cast<uint32_t>(chosen.steps.size());
        for (uint32_t other = 1; other <= std::min(steps + 1, MeshContentOptions{}.most_steps); ++other)
            EXPECT_LE(cost_of(chosen), cost_of(with_steps(net, other))) << rough << ", " << other;
    }
}

TEST(StepChoice, WhereTheFirstStepHardlyShrinksThereIsOne) {
    const MeshTile even = net_of(20, 1 << 14, 0);
    EXPECT_EQ(1u, encode_best_steps(even, {}).steps.size());
}

TEST(StepChoice, NoMoreStepsThanAllowedOrThanThereAreBits) {
    MeshContentOptions options;
    options.most_steps = 2;
    EXPECT_EQ(2u, encode_best_steps(net_of(20, 1 << 14, 1 << 13), options).steps.size());
    options.most_steps = kMostMeshSteps;
    EXPECT_LE(encode_best_steps(net_of(2, 16, 8), options).steps.size(), 2u);
    EXPECT_EQ(1u, encode_best_steps({}, options).steps.size());
}

/// Houses whose corners are on a lattice of `spacing` grid units.
MeshContent town_on(double spacing) {
    std::mt19937 random(2);
    const auto at = [&](uint32_t multiple) { return static_cast<int32_t>(std::lround(spacing * multiple)); };
    const auto side = [&] { return static_cast<uint32_t>(30 + random() % 50); };
    MeshContent town;
    for (uint32_t house = 0; house < 60; ++house) {
        const uint32_t x = 100 * (house % 8), y = 100 * (house / 8), w = side(), d = side();
        const Ring ring = {{{at(x), at(y)}, {at(x + w), at(y)}, {at(x + w), at(y + d)}, {at(x), at(y + d)}}};
        town.prisms.push_back({make_prism({ring}, 0, 5000), colour_word({}), colour_word({}), 0});
    }
    return town;
}

TEST(StepChoice, WhatIsKnownOfRingsChangesNoByte) {
    const MeshContent one = town_on(102.4), other = town_on(33.7);
    KnownLattices known;
    EXPECT_EQ(encode_mesh_wire(one).steps, encode_mesh_wire(one, &known).steps);
    ASSERT_FALSE(known.lattices.empty());
    EXPECT_EQ(encode_mesh_wire(one).steps, encode_mesh_wire(one, &known).steps);
    EXPECT_EQ(encode_mesh_wire(other).steps, encode_mesh_wire(other, &known).steps);
    EXPECT_EQ(encode_mesh_wire(one).steps, encode_mesh_wire(one, &known).steps);
}

}  // namespace
}  // namespace citystream::codec::mesh
