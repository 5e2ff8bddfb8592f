// What the input says of a building decides how it is dressed.
#include "tiles/layers/dress_style.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tiles/layers/dress_plan.h"

namespace citystream::tiles::layers {
namespace {

using city::BuildingFacts;
using city::BuildingUse;
using city::procedural::FacadeUse;

BuildingStyle style(const BuildingShape& shape, uint64_t draw, const BuildingFacts& facts = {}) {
    return style_of(shape, {draw * 0x9e3779b97f4a7c15ULL, 1}, facts);
}

constexpr BuildingShape kSmall{7, 90, 10, 9}, kWide{9, 1500, 50, 30}, kHigh{45, 1200, 40, 30}, kLow{3, 30, 6, 5};

TEST(StyleOf, TheUseThatIsSaidWins) {
    for (uint64_t draw = 0; draw < 50; ++draw) {
        EXPECT_EQ(style(kSmall, draw, {0, BuildingUse::kApartments}).use, FacadeUse::kApartment);
        EXPECT_TRUE(style(kSmall, draw, {0, BuildingUse::kShop}).shop);
        EXPECT_EQ(style(kWide, draw, {0, BuildingUse::kHouse}).use, FacadeUse::kHouse);
        EXPECT_EQ(style(kWide, draw, {0, BuildingUse::kHall}).use, FacadeUse::kHall);
        EXPECT_EQ(style(kWide, draw, {0, BuildingUse::kResidential}).use, FacadeUse::kApartment);
        EXPECT_EQ(style(kHigh, draw, {0, BuildingUse::kOffice}).use, FacadeUse::kTower);
        EXPECT_EQ(style(kLow, draw, {0, BuildingUse::kGarage}).use, FacadeUse::kGarage);
    }
}

TEST(StyleOf, AUseThatCannotBeAtThisHeightGivesWay) {
    for (uint64_t draw = 0; draw < 50; ++draw) {
        EXPECT_EQ(style(kHigh, draw, {0, BuildingUse::kHouse}).use, FacadeUse::kApartment);
        EXPECT_EQ(style(kSmall, draw, {0, BuildingUse::kOffice}).use, FacadeUse::kApartment);
        EXPECT_EQ(style(kHigh, draw, {0, BuildingUse::kGarage}).use, FacadeUse::kApartment);
    }
}

TEST(StyleOf, SeveralStoreysMakeNoHall) {
    int halls = 0;
    for (uint64_t draw = 0; draw < 50; ++draw) {
        halls += style(kWide, draw).use == FacadeUse::kHall ? 1 : 0;
        EXPECT_NE(style(kWide, draw, {3, BuildingUse::kUnknown}).use, FacadeUse::kHall);
    }
    EXPECT_GT(halls, 0);
}

TEST(StyleOf, StoreysPickVariantsWhoseStoreysAreOfThatHeight) {
    const auto misfit = [](const BuildingStyle& style, double height, int storeys) {
        const DressStoreys own = dress_storeys(style.use, style.variant);
        return std::abs(std::log(100 * height / (own.ground + (storeys - 1) * own.floor + own.top)));
    };
    double with = 0, without = 0;
    for (uint64_t draw = 0; draw < 200; ++draw) {
        const double height = 12 + 0.05 * static_cast<double>(draw);
        const BuildingShape shape{height, 300, 20, 15};
        const BuildingFacts facts{5, BuildingUse::kApartments};
        with += misfit(style(shape, draw, facts), height, facts.storeys);
        without += misfit(style(shape, draw, {0, BuildingUse::kApartments}), height, facts.storeys);
    }
    EXPECT_LT(with, 0.9 * without);
}

}  // namespace
}  // namespace citystream::tiles::layers
