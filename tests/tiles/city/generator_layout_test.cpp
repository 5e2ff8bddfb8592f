// The plan of the generated city: spiral, streets, blocks, plots.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <vector>

#include "tiles/city/generator_layout.h"
#include "tiles/city/generator_plots.h"

namespace citystream::tiles::city::procedural {
namespace {

TEST(CitySpiral, NumbersEveryQuarterOnceOutwards) {
    std::set<std::pair<int64_t, int64_t>> seen;
    int64_t ring = 0;
    for (uint64_t number = 0; number < 2000; ++number) {
        const Quarter quarter = quarter_at(number);
        EXPECT_TRUE(seen.emplace(quarter.i, quarter.j).second);
        EXPECT_EQ(number_of(quarter), number);
        const int64_t here = std::max(std::max(quarter.i, -quarter.i), std::max(quarter.j, -quarter.j));
        EXPECT_GE(here, ring);
        ring = here;
    }
}

TEST(CityPlan, KeepsStreetsInOrderAndBlocksWide) {
    for (uint64_t seed = 1; seed < 6; ++seed) {
        const CityPlan plan(seed, 1000);
        for (Axis axis : {Axis::kX, Axis::kY}) {
            for (int64_t line = -50; line < 50; ++line) {
                const StreetLine a = plan.line(axis, line), b = plan.line(axis, line + 1);
                EXPECT_GE(b.axis - b.outer_half - a.axis - a.outer_half, 44 * kMetre);
                EXPECT_EQ((a.axis + a.outer_half) % (2 * kMetre), 0) << "lots of even metres would not fit";
            }
        }
    }
}

TEST(CityPlan, PlacesCoordinatesOnStreetsAndBlocks) {
    const CityPlan plan(3, 1000);
    for (int64_t line = -20; line < 20; ++line) {
        const StreetLine street = plan.line(Axis::kX, line);
        for (Units off : {-street.carriage_half + 1, Units{0}, street.carriage_half - 1}) {
            const StreetPlace place = plan.place(Axis::kX, street.axis + off);
            EXPECT_EQ(place.part, StreetPlace::Part::kCarriageway);
            EXPECT_EQ(place.line, line);
        }
        EXPECT_EQ(plan.place(Axis::kX, street.axis + street.outer_half - 1).part, StreetPlace::Part::kPavement);
        const StreetPlace inside = plan.place(Axis::kX, street.axis + street.outer_half + kMetre);
        EXPECT_EQ(inside.part, StreetPlace::Part::kBlock);
        EXPECT_EQ(inside.block, line);
    }
}

TEST(CityPlan, GroundIsTheTerrainAtVerticesAndBetweenThemElsewhere) {
    const CityPlan plan(3, 1000);
    const std::vector<Units> xs = plan.breaks(Axis::kX, 0, 64 * kMetre), ys = plan.breaks(Axis::kY, 0, 64 * kMetre);
    for (Units x : xs) {
        for (Units y : ys) EXPECT_EQ(plan.ground(x, y), plan.terrain(x, y));
    }
    for (size_t i = 0; i + 1 < xs.size(); ++i) {
        const Units a = plan.terrain(xs[i], 0), b = plan.terrain(xs[i + 1], 0),
                    z = plan.ground((xs[i] + xs[i + 1]) / 2, 0);
        EXPECT_GE(z, std::min(a, b) - 1);
        EXPECT_LE(z, std::max(a, b) + 1);
    }
}

using Corners = std::array<Point2, 4>;

/// Footprints of a plan: the house and its garage.
std::vector<Corners> footprints(const BuildingPlan& plan) {
    const auto rect = [&plan](Units x0, Units y0, Units x1, Units y1) {
        return Corners{plan.frame.at(x0, y0), plan.frame.at(x1, y0), plan.frame.at(x1, y1), plan.frame.at(x0, y1)};
    };
    std::vector<Corners> rects = {rect(0, 0, plan.width, plan.depth)};
    if (plan.garage_side != 0) {
        const Units left = plan.garage_side < 0 ? -kGarageWidth : plan.width;
        rects.push_back(rect(left, kGarageSetback, left + kGarageWidth, kGarageSetback + kGarageDepth));
    }
    return rects;
}

/// Whether some edge of `a` has all of `b` on its outer side (or on its line, give or take a grid unit's rounding).
bool separated_by_edge_of(const Corners& a, const Corners& b) {
    for (size_t i = 0; i < 4; ++i) {
        const Point2 from = a[i], to = a[(i + 1) % 4];
        const Units ex = to.x - from.x, ey = to.y - from.y;
        const Units slack = 3 * ((ex < 0 ? -ex : ex) + (ey < 0 ? -ey : ey));
        if (std::all_of(b.begin(), b.end(),
                        [&](const Point2& at) { return ex * (at.y - from.y) - ey * (at.x - from.x) <= slack; }))
            return true;
    }
    return false;
}

TEST(Plots, HoldBuildingsThatDoNotOverlapAndStayInTheirBlock) {
    std::set<FacadeUse> uses;
    for (uint64_t seed = 1; seed <= 4; ++seed) {
        const CityPlan plan(seed, 3000);
        for (uint64_t number = 0; number < 60; ++number) {
            for (const Block& block : plan.blocks(quarter_at(number))) {
                std::vector<Corners> rects;
                for (const BuildingPlan& building : plan_block(block).buildings) {
                    uses.insert(building.use);
                    EXPECT_EQ(building.width % (kMetre / 4), 0);
                    for (const Corners& corners : footprints(building)) rects.push_back(corners);
                }
                for (size_t i = 0; i < rects.size(); ++i) {
                    for (const Point2& at : rects[i]) {
                        EXPECT_TRUE(at.x >= block.x0 && at.x <= block.x1 && at.y >= block.y0 && at.y <= block.y1)
                            << "seed " << seed << " zone " << static_cast<int>(block.zone);
                    }
                    for (size_t k = 0; k < i; ++k)
                        EXPECT_TRUE(separated_by_edge_of(rects[i], rects[k]) ||
                                    separated_by_edge_of(rects[k], rects[i]))
                            << "seed " << seed << " zone " << static_cast<int>(block.zone) << " buildings " << k << ", "
                            << i;
                }
            }
        }
    }
    EXPECT_GE(uses.size(), 5U);
}

TEST(Plots, PerimeterHousesFillTheirBlocksEdgeWithoutGaps) {
    size_t blocks = 0;
    const CityPlan plan(1, 3000);
    for (uint64_t number = 0; number < 40; ++number) {
        for (const Block& block : plan.blocks(quarter_at(number))) {
            if (block.zone != Zone::kPerimeter) continue;
            ++blocks;
            Units area = 0;
            for (const BuildingPlan& building : plan_block(block).buildings) area += building.width * building.depth;
            const Units deep = 12 * kMetre;
            EXPECT_EQ(area, block.width() * block.height() - (block.width() - 2 * deep) * (block.height() - 2 * deep));
        }
    }
    EXPECT_GT(blocks, 10U);
}

TEST(Frame, TurnsRoundToTheSameCorners) {
    Frame frame;
    frame.corner = {12345, -777};
    frame.c = 24;
    frame.s = 7;
    frame.h = 25;
    const Units w = 9 * kMetre, d = 7 * kMetre;
    const Frame side = frame.turned(w), rear = side.turned(d);
    const auto expect_same = [](Point2 a, Point2 b) {
        EXPECT_EQ(a.x, b.x);
        EXPECT_EQ(a.y, b.y);
    };
    expect_same(side.at(0, 0), frame.at(w, 0));
    expect_same(side.at(d, 0), frame.at(w, d));
    expect_same(side.at(d, w), frame.at(0, d));
    expect_same(rear.at(w, 0), frame.at(0, d));
    expect_same(rear.at(3, 5), frame.at(w - 3, d - 5));
}

}  // namespace
}  // namespace citystream::tiles::city::procedural
