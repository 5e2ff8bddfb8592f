// Points by place: what a search reaches, exactly once each, and what it costs on crowded places.
#include "codec/mesh/near_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace citystream::codec::mesh {
namespace {

TEST(NearPoints, ReachesEveryPointWithinACubesSideExactlyOnce) {
    std::mt19937 random(1);
    const auto coordinate = [&] { return static_cast<int32_t>(random() % 400) - 200; };
    NearPoints near(5);
    std::vector<GridPoint> points;
    for (int i = 0; i < 3000; ++i) {
        const int32_t x = coordinate(), y = coordinate(), z = coordinate();
        points.push_back({x, y, z});
        near.add(points.back());
    }
    for (int i = 0; i < 50; ++i) {
        const int32_t x = coordinate(), y = coordinate(), z = coordinate();
        std::vector<uint32_t> found;
        near.each_near({x, y, z}, [&](uint32_t index, uint32_t distance) {
            EXPECT_EQ(distance, distance_between(points[index], {x, y, z}));
            found.push_back(index);
        });
        std::sort(found.begin(), found.end());
        EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
        for (uint32_t p = 0; p < points.size(); ++p) {
            const bool near_enough = distance_between(points[p], {x, y, z}) < 32;
            EXPECT_TRUE(!near_enough || std::binary_search(found.begin(), found.end(), p)) << p;
        }
    }
}

TEST(NearPoints, FindsThePointThatIsExactlyThere) {
    NearPoints near(3);
    EXPECT_EQ(near.at({0, 0, 0}), NearPoints::kNone);
    near.add({1, 2, 3});
    near.add({1, 2, 4});
    EXPECT_EQ(near.at({1, 2, 3}), 0u);
    EXPECT_EQ(near.at({1, 2, 4}), 1u);
    EXPECT_EQ(near.at({1, 2, 5}), NearPoints::kNone);
}

TEST(NearPoints, LooksAtNoMoreThanItSaysWhereAllPointsAreAtOnePlace) {
    NearPoints near(4);
    for (int i = 0; i < 10000; ++i) near.add({7, 7, 7});
    uint32_t seen = 0;
    near.each_near({7, 7, 7}, [&](uint32_t, uint32_t) { ++seen; });
    EXPECT_EQ(seen, NearPoints::kMostInCube);
}

TEST(NearPoints, TakesTheWholeRangeOfCoordinates) {
    NearPoints near(1);
    const GridPoint low = {INT32_MIN, INT32_MIN, INT32_MIN}, high = {INT32_MAX, INT32_MAX, INT32_MAX};
    near.add(low);
    near.add(high);
    EXPECT_EQ(near.at(low), 0u);
    EXPECT_EQ(near.at(high), 1u);
    EXPECT_EQ(distance_between(low, high), UINT32_MAX);
    uint32_t seen = 0;
    near.each_near(high, [&](uint32_t, uint32_t) { ++seen; });
    EXPECT_EQ(seen, 1u);
}

}  // namespace
}  // namespace citystream::codec::mesh
