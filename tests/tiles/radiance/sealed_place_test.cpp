#include "tiles/radiance/sealed_place.h"

#include <gtest/gtest.h>

#include "tests/tiles/radiance/occluder_scenes.h"

namespace citystream::tiles::radiance {
namespace {

using test::at;
using test::scene_of;
using test::Surface;
using test::Vector;

constexpr int64_t kHop = int64_t{24} << kGridBits;
constexpr Vector kUp = {0, 0, 1}, kEast = {1, 0, 0};

TEST(SealedPlace, WhatSeesTheSkyIsNotSealed) {
    Surface surface = test::ground(0, 0, 128, 128);
    test::add(surface, test::tower(64, 64, 16, 20));
    const OccluderScene scene = scene_of(surface);
    EXPECT_FALSE(sealed(scene, at(20, 20, 0), kUp, kHop));
    EXPECT_FALSE(sealed(scene, at(72, 64, 0.1), kEast, kHop));
    EXPECT_FALSE(sealed(scene, at(64, 64, 20), kUp, kHop));
}

TEST(SealedPlace, TheGroundInsideAndTheCoveredPartOfAPartyWallAreSealed) {
    Surface surface = test::ground(0, 0, 128, 128);
    test::add(surface, test::tower(56, 64, 16, 30));
    test::add(surface, test::tower(72, 64, 16, 12));
    const OccluderScene scene = scene_of(surface);
    EXPECT_TRUE(sealed(scene, at(56, 64, 0), kUp, kHop));
    EXPECT_TRUE(sealed(scene, at(64, 64, 1), kEast, kHop)) << "looks into the lower house, at its ground";
    EXPECT_TRUE(sealed(scene, at(64, 64, 11), kEast, kHop));
    EXPECT_FALSE(sealed(scene, at(64, 64, 13), kEast, kHop)) << "above the lower roof";
}

TEST(SealedPlace, AFoundationUnderTheGroundIsSealedThoughThereIsNothingBelowIt) {
    Surface surface = test::ground(0, 0, 128, 128);
    test::add(surface, test::tower(64, 64, 16, 20, 0, -3));
    const OccluderScene scene = scene_of(surface);
    EXPECT_TRUE(sealed(scene, at(72, 64, -2), kEast, kHop));
}

TEST(SealedPlace, WhatIsDarkUnderARoofThatIsOpenAtASideIsSeenFromThere) {
    Surface hall = test::ground(0, 0, 128, 128);
    const auto wall = [&](double x0, double y0, double x1, double y1) {
        test::add_quad(hall, {at(x0, y0, 0), at(x1, y1, 0), at(x1, y1, 4), at(x0, y0, 4)});
    };
    // 6 m wide and 4 m high, with its mouth in the west, 12 m away, and a bend: the far end sees none of the sky.
    test::add_quad(hall, {at(40, 60, 4), at(40, 76, 4), at(58, 76, 4), at(58, 60, 4)});
    wall(40, 60, 58, 60);
    wall(58, 60, 58, 76);
    wall(58, 76, 52, 76);
    wall(52, 76, 52, 66);
    wall(52, 66, 40, 66);
    const OccluderScene open_hall = scene_of(hall);
    EXPECT_FALSE(sealed(open_hall, at(57, 70, 0), kUp, kHop));
    // The mouth closed: all that is around it shows its back, but for two walls.
    wall(40, 66, 40, 60);
    EXPECT_TRUE(sealed(scene_of(hall), at(57, 70, 0), kUp, kHop));
}

TEST(SealedPlace, ARoomThatShowsItsFrontsInsideIsNotSealed) {
    Surface room = test::ground(56, 56, 72, 72);
    const Surface shell = test::tower(64, 64, 16, 4);
    for (const SurfaceTriangle& triangle : shell)
        room.push_back({{triangle.corners[0], triangle.corners[2], triangle.corners[1]}});
    EXPECT_FALSE(sealed(scene_of(room), at(64, 64, 0), kUp, kHop));
    Surface house = test::ground(56, 56, 72, 72);
    test::add(house, shell);
    EXPECT_TRUE(sealed(scene_of(house), at(64, 64, 0), kUp, kHop));
}

}  // namespace
}  // namespace citystream::tiles::radiance
