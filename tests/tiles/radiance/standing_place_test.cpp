#include "tiles/radiance/standing_place.h"

#include <gtest/gtest.h>

#include "tests/tiles/radiance/occluder_scenes.h"
#include "tiles/radiance/even_light.h"

namespace citystream::tiles::radiance {
namespace {

using test::at;
using test::scene_of;
using test::Surface;

constexpr int64_t kSpacing = int64_t{8} << kGridBits;

/// Of one surface at a column.
struct Column {
    std::vector<ClassTriangle> triangles;
    Receiver receiver;

    Column(const Surface& surface, uint32_t surface_class, std::array<int64_t, 2> column, const GridPoint& point) {
        for (const SurfaceTriangle& triangle : surface) {
            for (const ClassTriangle& seen : seen_along_classes(triangle)) {
                if (seen.surface_class == surface_class) triangles.push_back(seen);
            }
        }
        const std::array<int64_t, 2> column_at = {column[0] * kSpacing, column[1] * kSpacing};
        receiver = {static_cast<uint8_t>(surface_class), column, triangles.at(0).depth_at(column_at),
                    triangles.at(0).tilt, point};
    }
    std::optional<GridPoint> standing(const OccluderScene& scene) const {
        std::vector<const ClassTriangle*> surface;
        for (const ClassTriangle& triangle : triangles) surface.push_back(&triangle);
        return standing_place(scene, receiver, surface, kSpacing);
    }
};

TEST(StandingPlace, AReceiverInTheOpenStaysWhereItIs) {
    const Surface ground = test::ground(0, 0, 64, 64);
    const Column column(ground, 4, {3, 3}, at(24, 24, 0));
    EXPECT_EQ(column.standing(scene_of(ground)), at(24, 24, 0));
}

TEST(StandingPlace, OnAWallThatIsLowBesideTheSpacingThereArePlacesOutOfTheDark) {
    // 2 m high, an eave of 1 m over it: the upper half is dark.
    Surface wall;
    test::add_quad(wall, {at(40, 24, 0), at(40, 40, 0), at(40, 40, 2), at(40, 24, 2)});
    Surface all = test::ground(0, 0, 64, 64);
    test::add(all, wall);
    test::add_quad(all, {at(40, 24, 2), at(40, 40, 2), at(41, 40, 2), at(41, 24, 2)});
    const OccluderScene scene = scene_of(all);
    const EvenLight even({1, 0, 0});
    const Column column(wall, 0, {4, 0}, at(40, 32, 1.9));
    const auto point = column.standing(scene);
    ASSERT_TRUE(point);
    EXPECT_EQ(point->x, to_grid(40));
    EXPECT_LT(point->z, to_grid(1.4));
    EXPECT_LT(even.at(scene, at(40, 32, 1.9)), 0.1);
    EXPECT_GT(even.at(scene, *point), 0.15);
}

TEST(StandingPlace, ACoveredWallHasNoneAndOneThatStandsOutItsUpperPart) {
    Surface house = test::tower(32, 32, 16, 12), all = test::ground(0, 0, 64, 64);
    test::add(all, house);
    const Surface wall = {house.begin(), house.begin() + 8};
    const Column column(wall, 0, {4, 0}, at(40, 32, 1));
    for (const double neighbour : {0.0, 6.0, 12.0}) {
        Surface both = all;
        if (neighbour > 0) test::add(both, test::tower(48, 32, 16, neighbour));
        const auto point = column.standing(scene_of(both));
        EXPECT_EQ(point.has_value(), neighbour < 12) << neighbour;
        if (point) {
            EXPECT_GE(point->z, to_grid(neighbour)) << neighbour;
        }
    }
}

}  // namespace
}  // namespace citystream::tiles::radiance
