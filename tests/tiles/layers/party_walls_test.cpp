// Facades between neighbours that nobody sees become plain walls.
#include "tiles/layers/party_walls.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildFacade;
using quadtree::BuildObject;

constexpr int64_t kMetre = 1024;

class PartyWalls : public testing::Test {
  protected:
    PartyWalls() {
        catalog_.palettes.emplace_back();
        catalog_.palettes[0].material = {catalog_.add_material({.rgb = {200, 100, 50}})};
        map_ = catalog_.facade_maps.add(
            {{0, 500, 1000}, {0, 600}, {codec::facade::make_label(0, 0), codec::facade::make_label(40, 0)}});
    }
    /// A building with one facade from (x0, y0) to (x1, y1), metres, seen from its right side.
    BuildObject building(double x0, double y0, double x1, double y1, double foot, double top) const {
        BuildFacade facade;
        const auto grid = [](double metres) { return std::llround(metres * kMetre); };
        facade.origin = {grid(x0), grid(y0), grid(foot)};
        facade.along = {static_cast<int32_t>(grid(x1) - grid(x0)), static_cast<int32_t>(grid(y1) - grid(y0))};
        facade.height = static_cast<uint32_t>(grid(top - foot));
        facade.map = map_;
        BuildObject object;
        object.facades.push_back(facade);
        return object;
    }
    /// For each object whether its facade is left; how many were hidden is checked on the way.
    std::vector<bool> left(std::vector<BuildObject> objects) {
        const uint64_t hidden = hide_party_walls(objects, painter_);
        std::vector<bool> out;
        uint64_t gone = 0;
        for (const BuildObject& object : objects) {
            out.push_back(!object.facades.empty());
            if (!object.facades.empty()) continue;
            ++gone;
            EXPECT_EQ(object.triangles.size(), 2U) << "the wall itself stays";
        }
        EXPECT_EQ(hidden, gone);
        return out;
    }

    city::CityCatalog catalog_;
    ImageCache images_{catalog_, 1 << 20};
    FacadePainter painter_{catalog_, images_, 20000};
    uint32_t map_ = 0;
};

TEST_F(PartyWalls, WallsThatFaceEachOtherHideEachOther) {
    for (const double gap : {0.0, 0.02, 0.25, -0.04}) {
        EXPECT_EQ(left({building(0, 0, 10, 0, 0, 6), building(10, -gap, 0, -gap, 0, 6)}),
                  (std::vector<bool>{false, false}))
            << gap;
    }
}

TEST_F(PartyWalls, AnAlleyKeepsItsFacades) {
    EXPECT_EQ(left({building(0, 0, 10, 0, 0, 6), building(10, -0.4, 0, -0.4, 0, 6)}), (std::vector<bool>{true, true}));
}

TEST_F(PartyWalls, WallsThatLookTheSameWayAndBackToBackStay) {
    EXPECT_EQ(left({building(0, 0, 10, 0, 0, 6), building(0, -0.1, 10, -0.1, 0, 6)}), (std::vector<bool>{true, true}));
    EXPECT_EQ(left({building(0, 0, 10, 0, 0, 6), building(10, 0.2, 0, 0.2, 0, 6)}), (std::vector<bool>{true, true}));
}

TEST_F(PartyWalls, AHigherOrWiderWallStaysAndHidesTheOther) {
    EXPECT_EQ(left({building(0, 0, 10, 0, 0, 12), building(10, 0, 0, 0, 0, 6)}), (std::vector<bool>{true, false}));
    EXPECT_EQ(left({building(0, 0, 20, 0, 0, 6), building(15, 0, 5, 0, 0, 6)}), (std::vector<bool>{true, false}));
}

TEST_F(PartyWalls, SeveralNeighboursHideAWallTogether) {
    EXPECT_EQ(left({building(0, 0, 20, 0, 0, 6), building(8, 0, -1, 0, 0, 7), building(21, 0, 8, 0, 0, 6)}),
              (std::vector<bool>{false, true, true}));
    EXPECT_EQ(left({building(0, 0, 20, 0, 0, 6), building(8, 0, -1, 0, 0, 7), building(21, 0, 9, 0, 0, 6)}),
              (std::vector<bool>{true, true, true}));
}

TEST_F(PartyWalls, WallsOfOneObjectDoNotHideEachOther) {
    BuildObject both = building(0, 0, 10, 0, 0, 6);
    both.facades.push_back(building(10, 0, 0, 0, 0, 6).facades[0]);
    EXPECT_EQ(left({both}), (std::vector<bool>{true}));
}

TEST_F(PartyWalls, TheOrderOfTheObjectsAndWhereTheyStandDoNotMatter) {
    for (const double far : {0.0, 15.9, -1000.0, 350000.0}) {
        std::vector<BuildObject> objects = {building(far, far, far + 7, far + 7, 0, 6),
                                            building(far + 7.1, far + 6.9, far + 0.1, far - 0.1, 0, 6)};
        EXPECT_EQ(left(objects), (std::vector<bool>{false, false})) << far;
        std::reverse(objects.begin(), objects.end());
        EXPECT_EQ(left(objects), (std::vector<bool>{false, false})) << far;
    }
}

}  // namespace
}  // namespace citystream::tiles::layers
