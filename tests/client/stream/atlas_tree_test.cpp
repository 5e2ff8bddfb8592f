// The paper's tree of depth two (21 nodes, an atlas each) on a flight: what a frame draws from, and that every node's
// turn comes.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "tests/client/stream/streamer_flight.h"
#include "tests/client/stream/synthetic_city.h"

namespace citystream::client {
namespace {

constexpr uint32_t kDepth = 2;
constexpr size_t kLeaves = 16;

test::SyntheticOptions tree_of_depth_two(bool pages) {
    test::SyntheticOptions options;
    options.levels = kDepth + 1;
    options.facades = false;
    options.pages = pages;
    return options;
}

/// From far outside over the city, down into it and along its streets, all of it or part of it in view.
std::vector<Camera> cameras_over(const test::SyntheticCity& city) {
    std::vector<Camera> cameras;
    for (int i = 0; i <= 60; ++i) {
        const double t = i / 60.0;
        cameras.push_back(city.camera(512, -12000 * (1 - t) * (1 - t) + 300 * t, 3000 * (1 - t) + 20, 0, -14 - 30 * t));
        cameras.push_back(city.camera(1024 * t, 512, 15, 360 * t, -5));
        cameras.push_back(city.camera(512, 512, 30 + 1500 * t, 90, -89));
    }
    return cameras;
}

class AtlasTree : public testing::TestWithParam<bool> {};

TEST_P(AtlasTree, AFrameDrawsFromSixteenAtlasesAtMost) {
    const test::SyntheticCity city(tree_of_depth_two(GetParam()));
    ASSERT_EQ(city.tiles.size(), 21U);
    StreamerOptions options = test::whole_view();
    options.tolerance_pixels = 0.1;  // so that leaves are drawn from where all of them are seen
    test::Flight flight(city, options);
    std::set<LayerId> drawn;
    size_t most = 0, least = kLeaves;
    for (const Camera& camera : cameras_over(city)) {
        std::set<LayerId> atlases;
        for (const TileDraw& draw : flight.update(camera)) {
            ASSERT_NE(draw.atlas, kNoLayer);
            EXPECT_TRUE(draw.shared_charts.empty());
            atlases.insert(draw.atlas);
        }
        EXPECT_LE(atlases.size(), kLeaves);
        if (atlases.empty()) continue;
        most = std::max(most, atlases.size());
        least = std::min(least, atlases.size());
        drawn.insert(atlases.begin(), atlases.end());
    }
    EXPECT_EQ(most, kLeaves) << "no frame shows all leaves: the bound is never reached";
    EXPECT_EQ(least, 1U) << "no frame is drawn from the root alone";
    EXPECT_EQ(drawn.size(), city.tiles.size()) << "some node is never drawn";
}

INSTANTIATE_TEST_SUITE_P(Forms, AtlasTree, testing::Bool(),
                         [](const auto& pages) { return pages.param ? "Pages" : "Charts"; });

}  // namespace
}  // namespace citystream::client
