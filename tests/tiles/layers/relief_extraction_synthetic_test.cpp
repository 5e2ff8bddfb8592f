// Facades found in made buildings: what becomes relief, what stays mesh, and that nothing is lost or shown twice.
#include <gtest/gtest.h>

#include <memory>
#include <numbers>

#include "tests/tiles/layers/relief_building.h"
#include "tests/tiles/layers/relief_probe.h"
#include "tiles/layers/relief_extraction.h"

namespace citystream::tiles::layers {
namespace {

constexpr double kWidth = 10, kHeight = 6, kMillimetre = 0.0011;
constexpr size_t kBodyTriangles = 10;

/// A front of six windows, 15 cm deep.
struct House {
    explicit House(double turn = 0, city::Vec3 corner = {100, 200, 30}) : building(catalog, turn, corner) {
        plaster = building.material(220, 210, 190);
        glass = building.material(60, 90, 140);
        building.body(kWidth, kHeight, plaster);
        for (int floor = 0; floor < 2; ++floor) {
            for (int bay = 0; bay < 3; ++bay) {
                const double u = 1 + bay * 3, v = 1 + floor * 2.5;
                windows.push_back({u, v, u + 1.2, v + 1.5});
            }
        }
    }
    void close_wall(std::vector<Opening> more_holes = {}) {
        more_holes.insert(more_holes.end(), windows.begin(), windows.end());
        building.wall({0, 0, kWidth, kHeight}, more_holes, plaster);
        for (const Opening& o : windows) building.window(o, 0, -0.15, plaster, glass);
    }
    ReliefExtractionReport extract() {
        ReliefExtractor extractor(catalog, {});
        extractor.extract(building.object());
        return extractor.report();
    }
    ReliefProbe relief() { return {catalog, building.object().facades.at(0)}; }
    /// Depth at a place of the front, whatever part of it the facade covers.
    std::optional<double> depth(double u, double v) {
        const ReliefProbe probe = relief();
        const city::Vec3 at = probe.local(building.world({u, v, 0}));
        const auto depth = probe.depth_at(at.x, at.y);
        if (!depth) return std::nullopt;
        return *depth - at.z;
    }
    uint32_t shown_material(double u, double v) {
        const ReliefProbe probe = relief();
        const city::Vec3 at = probe.local(building.world({u, v, 0}));
        const auto label = probe.label_at(at.x, at.y);
        return label ? probe.material_of(*label) : UINT32_MAX;
    }
    size_t triangles() { return building.object().triangles.size(); }

    city::CityCatalog catalog;
    ReliefBuilding building;
    uint32_t plaster = 0, glass = 0;
    std::vector<Opening> windows;
};

TEST(ReliefExtraction, WindowsAndTheirRevealsBecomeReliefAndLeaveTheMesh) {
    House house;
    house.close_wall();
    const ReliefExtractionReport report = house.extract();
    ASSERT_EQ(house.building.object().facades.size(), 1u);
    EXPECT_EQ(house.triangles(), kBodyTriangles);
    EXPECT_NEAR(house.depth(0.5, 0.5).value(), 0, kMillimetre);
    for (const Opening& o : house.windows) {
        EXPECT_NEAR(house.depth((o.u0 + o.u1) / 2, (o.v0 + o.v1) / 2).value(), -0.15, kMillimetre);
        // The relief's edges are the model's, to a texel of 2 mm.
        EXPECT_NEAR(house.depth(o.u0 + 0.003, o.v0 + 0.003).value(), -0.15, kMillimetre);
        EXPECT_NEAR(house.depth(o.u0 - 0.003, o.v1 + 0.003).value(), 0, kMillimetre);
        EXPECT_EQ(house.shown_material(o.u1 - 0.01, o.v1 - 0.01), house.glass);
    }
    EXPECT_EQ(house.shown_material(0.5, 0.5), house.plaster);
    EXPECT_EQ(report.facades, 1u);
    EXPECT_EQ(report.triangles_after, kBodyTriangles);
    EXPECT_LE(report.largest_error, 0.002);
}

TEST(ReliefExtraction, TheFacadeIsTheWallsRectangleExactly) {
    House house;
    house.close_wall();
    house.extract();
    const city::FacadeWall& wall = house.building.object().facades.at(0);
    const city::Vec3 left = house.building.world({0, 0, 0}), right = house.building.world({kWidth, 0, 0});
    EXPECT_NEAR(wall.lower_left.x, left.x, 1e-9);
    EXPECT_NEAR(wall.lower_left.y, left.y, 1e-9);
    EXPECT_NEAR(wall.lower_left.z, left.z, 1e-9);
    EXPECT_NEAR(wall.along.x, right.x - left.x, 1e-9);
    EXPECT_NEAR(wall.along.y, right.y - left.y, 1e-9);
    EXPECT_NEAR(wall.height, kHeight, 1e-9);
}

TEST(ReliefExtraction, SillsAndBalconySlabsStandOut) {
    House house;
    house.close_wall();
    house.building.block({0.9, 0.9, 2.3, 1.0}, 0, 0.06, house.plaster, false);
    house.building.block({3.5, 3.2, 6.0, 3.4}, 0, 1.2, house.plaster, false);
    house.extract();
    EXPECT_EQ(house.triangles(), kBodyTriangles);
    EXPECT_NEAR(house.depth(1.5, 0.95).value(), 0.06, kMillimetre);
    EXPECT_NEAR(house.depth(5, 3.3).value(), 1.2, kMillimetre);
    EXPECT_NEAR(house.depth(5, 3.15).value(), 0, kMillimetre);
}

TEST(ReliefExtraction, AFloatingAwningStaysMeshAndTheReliefShowsTheWallBehind) {
    House house;
    house.close_wall();
    house.building.block({3, 3.0, 7, 3.1}, 0.5, 1.5, house.glass, true);
    house.extract();
    EXPECT_EQ(house.triangles(), kBodyTriangles + 12);
    EXPECT_NEAR(house.depth(5, 3.05).value(), 0, kMillimetre);
}

TEST(ReliefExtraction, BarsOfARailingStayMesh) {
    House house;
    house.close_wall();
    for (int bar = 0; bar < 20; ++bar) {
        const double u = 3.5 + 0.12 * bar;
        house.building.block({u, 3.4, u + 0.02, 4.3}, 1.15, 1.17, house.glass, true);
    }
    house.extract();
    EXPECT_EQ(house.triangles(), kBodyTriangles + 20 * 12);
}

TEST(ReliefExtraction, ARoundOrielStaysMesh) {
    House house;
    const Opening hole = {5.4, 0.2, 6.8, 5.8};
    house.close_wall({hole});
    constexpr int kFacets = 12;
    const double middle = (hole.u0 + hole.u1) / 2, radius = (hole.u1 - hole.u0) / 2;
    for (int i = 0; i < kFacets; ++i) {
        const double a = std::numbers::pi * i / kFacets, b = std::numbers::pi * (i + 1) / kFacets;
        const double ua = middle - radius * std::cos(a), ub = middle - radius * std::cos(b);
        const double wa = radius * std::sin(a), wb = radius * std::sin(b);
        house.building.quad({ua, hole.v0, wa}, {ub, hole.v0, wb}, {ub, hole.v1, wb}, {ua, hole.v1, wa}, house.plaster,
                            city::SurfaceKind::kWall);
    }
    house.extract();
    EXPECT_EQ(house.triangles(), kBodyTriangles + 2 * kFacets);
    EXPECT_FALSE(house.depth(middle, 3).has_value()) << "nothing but the oriel is there";
    EXPECT_NEAR(house.depth(2.5, 3).value(), 0, kMillimetre);
}

/// The front with an arched gateway: its pane, reveal and the wall around the arc.
void add_arch(House& house, double middle, double radius, double spring) {
    constexpr int kSegments = 16;
    ReliefBuilding& b = house.building;
    const double top = spring + radius;
    for (int i = 0; i < kSegments; ++i) {
        const double a0 = std::numbers::pi * i / kSegments, a1 = std::numbers::pi * (i + 1) / kSegments;
        const double u0 = middle - radius * std::cos(a0), u1 = middle - radius * std::cos(a1);
        const double v0 = spring + radius * std::sin(a0), v1 = spring + radius * std::sin(a1);
        b.quad({u0, v0, 0}, {u1, v1, 0}, {u1, top, 0}, {u0, top, 0}, house.plaster, city::SurfaceKind::kWall);
        b.quad({u0, v0, -0.2}, {u1, v1, -0.2}, {u1, v1, 0}, {u0, v0, 0}, house.plaster, city::SurfaceKind::kDoor);
        b.triangle({middle, spring, -0.2}, {u1, v1, -0.2}, {u0, v0, -0.2}, house.glass, city::SurfaceKind::kDoor);
    }
}

TEST(ReliefExtraction, AnArchIsFollowedInSmallSteps) {
    House house;
    house.windows.erase(house.windows.begin() + 1);  // the middle one below
    const double middle = 5, radius = 0.8, spring = 1.5;
    const Opening arch = {middle - radius, spring, middle + radius, spring + radius};
    const Opening below = {middle - radius, 0.2, middle + radius, spring};
    house.close_wall({arch, below});
    house.building.front(below, -0.2, house.glass, city::SurfaceKind::kDoor);
    for (const double side : {-1.0, 1.0}) {
        const double u = middle + side * radius;
        const std::array<double, 2> w = side < 0 ? std::array{-0.2, 0.0} : std::array{0.0, -0.2};
        house.building.quad({u, 0.2, w[1]}, {u, 0.2, w[0]}, {u, spring, w[0]}, {u, spring, w[1]}, house.plaster,
                            city::SurfaceKind::kDoor);
    }
    house.building.quad({middle - radius, 0.2, 0}, {middle + radius, 0.2, 0}, {middle + radius, 0.2, -0.2},
                        {middle - radius, 0.2, -0.2}, house.plaster, city::SurfaceKind::kDoor);
    add_arch(house, middle, radius, spring);
    house.extract();
    EXPECT_EQ(house.triangles(), kBodyTriangles);
    const double chord = radius * (1 - std::cos(std::numbers::pi / 32));
    for (double angle = 0.1; angle < 3.1; angle += 0.05) {
        const double inner = radius - chord - 0.025, outer = radius + 0.025;
        EXPECT_NEAR(house.depth(middle + inner * std::cos(angle), spring + inner * std::sin(angle)).value(), -0.2,
                    kMillimetre);
        EXPECT_NEAR(house.depth(middle + outer * std::cos(angle), spring + outer * std::sin(angle)).value(), 0,
                    kMillimetre);
    }
}

TEST(ReliefExtraction, BesideAGableTheFacadeIsOpen) {
    House house;
    // Enough windows that following the gable's outline pays.
    for (Opening& o : house.windows)
        house.building.block({o.u0, o.v1 + 0.1, o.u1, o.v1 + 0.2}, 0, 0.08, house.plaster, false);
    for (int i = 0; i < 40; ++i) {
        const double u = 0.2 + 0.24 * i;
        house.building.block({u, 0.1, u + 0.1, 0.3}, 0, 0.05, house.plaster, false);
    }
    house.close_wall();
    const double ridge = 9;
    house.building.triangle({0, kHeight, 0}, {kWidth, kHeight, 0}, {kWidth / 2, ridge, 0}, house.plaster,
                            city::SurfaceKind::kWall);
    house.building.quad({0, kHeight, 0}, {kWidth / 2, ridge, 0}, {kWidth / 2, ridge, -8}, {0, kHeight, -8},
                        house.plaster, city::SurfaceKind::kRoof);
    house.building.quad({kWidth / 2, ridge, 0}, {kWidth, kHeight, 0}, {kWidth, kHeight, -8}, {kWidth / 2, ridge, -8},
                        house.plaster, city::SurfaceKind::kRoof);
    house.extract();
    ASSERT_EQ(house.building.object().facades.size(), 1u);
    EXPECT_EQ(house.triangles(), kBodyTriangles + 4);
    for (double u = 0.2; u < kWidth; u += 0.37) {
        const double edge = kHeight + (ridge - kHeight) * (1 - std::abs(u - kWidth / 2) / (kWidth / 2));
        EXPECT_TRUE(house.depth(u, edge - 0.03).has_value()) << u;
        EXPECT_FALSE(house.depth(u, edge + 0.03).has_value()) << u;
    }
}

class ReliefExtractionTurned : public testing::TestWithParam<int> {};

TEST_P(ReliefExtractionTurned, TheSameHouseHasTheSameReliefWhereverItStands) {
    House plain, turned(GetParam() * std::numbers::pi / 6), far(GetParam() * std::numbers::pi / 6, {1e7, -9.9e6, 500});
    for (House* house : {&plain, &turned, &far}) {
        house->close_wall();
        house->extract();
        ASSERT_EQ(house->building.object().facades.size(), 1u);
        EXPECT_EQ(house->triangles(), kBodyTriangles);
    }
    const codec::facade::RunGrid grid = plain.relief().grid();
    EXPECT_EQ(turned.relief().grid(), grid);
    EXPECT_EQ(far.relief().grid(), grid);
}

INSTANTIATE_TEST_SUITE_P(AllAround, ReliefExtractionTurned, testing::Values(0, 1, 2, 3, 5, 7, 9, 11));

TEST(ReliefExtraction, DegenerateAndTinyTrianglesDoNoHarm) {
    House house;
    house.close_wall();
    const size_t before = house.triangles();
    ReliefBuilding& b = house.building;
    b.triangle({1, 1, 0}, {2, 1, 0}, {3, 1, 0}, house.plaster, city::SurfaceKind::kWall);
    b.triangle({1, 1, 0}, {1, 1, 0}, {3, 1, 0}, house.plaster, city::SurfaceKind::kWindow);
    b.triangle({3, 0.5, 0}, {3.00001, 0.5, 0}, {3, 0.50001, 0}, house.plaster, city::SurfaceKind::kWindow);
    b.triangle({3, 0.5, 0}, {3.0005, 0.5, 0}, {3, 0.5005, 0}, house.glass, city::SurfaceKind::kDoor);
    house.building.object().vertices.push_back({NAN, INFINITY, 1e300});  // belongs to no triangle
    ASSERT_GT(house.triangles(), before);
    house.extract();
    ASSERT_EQ(house.building.object().facades.size(), 1u);
    EXPECT_EQ(house.triangles(), kBodyTriangles);
    EXPECT_NEAR(house.depth(1.5, 1.5).value(), -0.15, kMillimetre);
}

TEST(ReliefExtraction, CoordinatesThatAreNoNumbersStayMesh) {
    House house;
    house.close_wall();
    house.building.triangle({NAN, 1, 0}, {2, 1, 0}, {2, 2, 0}, house.plaster, city::SurfaceKind::kWall);
    house.building.triangle({1e300, 1, 0}, {2, -1e300, 0}, {2, 2, 1e300}, house.plaster, city::SurfaceKind::kWall);
    house.extract();
    EXPECT_GE(house.triangles(), kBodyTriangles + 2);
}

TEST(ReliefExtraction, MoreThanSixteenMaterialsMergeTheLeastIntoTheNearest) {
    House house;
    house.windows.clear();
    std::vector<Opening> panes;
    for (int i = 0; i < 20; ++i) {
        const double u = 0.2 + 0.48 * i, wide = 0.2 + 0.01 * i;
        panes.push_back({u, 2, u + wide, 3});
    }
    house.close_wall(panes);
    std::vector<uint32_t> colour;
    for (size_t i = 0; i < panes.size(); ++i) {
        colour.push_back(house.building.material(static_cast<uint8_t>(3 * i), 0, 0));
        house.building.window(panes[i], 0, -0.1, house.plaster, colour.back());
    }
    const ReliefExtractionReport report = house.extract();
    EXPECT_EQ(report.materials_merged, 5u);  // 20 panes and the wall in 16 slots
    EXPECT_EQ(house.triangles(), kBodyTriangles);
    for (size_t i = 0; i < panes.size(); ++i) {
        const uint32_t shown = house.shown_material(panes[i].u0 + 0.1, 2.5);
        if (i >= 5) {
            EXPECT_EQ(shown, colour[i]) << i;
        } else {
            EXPECT_EQ(shown, colour[5]) << i << ": the nearest that has a slot";
        }
    }
}

TEST(ReliefExtraction, ARevealOfAnotherMaterialShowsAsARimOfOneTexel) {
    House house;
    const uint32_t frame = house.building.material(250, 20, 20);
    const Opening o = {8.3, 0.2, 9.3, 0.8};
    house.close_wall({o});
    house.building.window(o, 0, -0.15, frame, house.glass);
    house.extract();
    EXPECT_EQ(house.triangles(), kBodyTriangles);
    EXPECT_EQ(house.shown_material(o.u0 - 0.001, 0.5), frame);
    EXPECT_EQ(house.shown_material(8.8, o.v1 + 0.001), frame);
    EXPECT_NEAR(house.depth(o.u0 - 0.001, 0.5).value(), 0, kMillimetre);
    EXPECT_EQ(house.shown_material(o.u0 - 0.004, 0.5), house.plaster);
    EXPECT_EQ(house.shown_material(o.u0 + 0.001, 0.5), house.glass);
}

TEST(ReliefExtraction, APaneThatFacesTheRoomStaysMesh) {
    House house;
    const Opening o = {8.3, 0.2, 9.3, 0.8};
    house.close_wall({o});
    house.building.quad({o.u1, o.v0, -0.1}, {o.u0, o.v0, -0.1}, {o.u0, o.v1, -0.1}, {o.u1, o.v1, -0.1}, house.glass,
                        city::SurfaceKind::kWindow);
    house.extract();
    const auto& object = house.building.object();
    EXPECT_EQ(std::count_if(object.triangles.begin(), object.triangles.end(),
                            [&](const city::Triangle& t) { return t.material == house.glass; }),
              2);
    EXPECT_FALSE(house.depth(8.8, 0.5).has_value());
}

TEST(ReliefExtraction, ImagesBecomeTheirMeanButWidePatternsStayMesh) {
    House house;
    auto checkers = std::make_shared<city::Image>();
    *checkers = {2, 2, {0, 0, 0, 200, 200, 200, 200, 200, 200, 0, 0, 0}};
    house.catalog.images.push_back({"", checkers});
    const uint32_t picture = house.catalog.add_material({.image = 0});
    const Opening strip = {0.2, 0.1, 9.8, 0.2}, poster = {4.2, 0.3, 5.8, 0.9};
    house.close_wall();
    house.building.block(strip, 0, 0.05, picture, false);
    house.building.block(poster, 0, 0.05, picture, false);
    auto& triangles = house.building.object().triangles;
    for (city::Triangle& t : triangles) {
        if (t.material != picture) continue;
        // Four repeats a metre, whichever way the surface lies.
        for (size_t k = 0; k < 3; ++k) {
            const city::Vec3& v = house.building.object().vertices[t.vertex[k]];
            t.texcoord[k] = {4 * (v.x + v.y), 4 * v.z};
        }
    }
    house.extract();
    const uint32_t shown = house.shown_material(5, 0.15);
    ASSERT_LT(shown, house.catalog.materials.size());
    EXPECT_LT(house.catalog.materials[shown].image, 0);
    EXPECT_NEAR(house.catalog.materials[shown].rgb[0], 146, 20) << "half of black and 200, in linear light";
    EXPECT_GE(std::count_if(triangles.begin(), triangles.end(),
                            [&](const city::Triangle& t) { return t.material == picture; }),
              2);
    EXPECT_NEAR(house.depth(5, 0.6).value(), 0, kMillimetre) << "behind the poster";
}

TEST(ReliefExtraction, OfTwoSurfacesInOnePlaneTheSmallerShows) {
    House house;
    house.close_wall();
    const Opening sign = {8.3, 0.2, 9.3, 0.8}, sunk = {8.4, 5.4, 9.4, 5.8};
    house.building.front(sign, 0, house.glass, city::SurfaceKind::kWall);
    house.building.front(sunk, -1e-5, house.glass, city::SurfaceKind::kWall);  // rounding is no order
    house.extract();
    EXPECT_EQ(house.triangles(), kBodyTriangles);
    EXPECT_EQ(house.shown_material(8.8, 0.5), house.glass);
    EXPECT_EQ(house.shown_material(8.9, 5.6), house.glass);
}

TEST(ReliefExtraction, WhatLiesInsideTheSolidIsDropped) {
    House house;
    house.close_wall();
    house.building.block({3.5, 3.2, 6.0, 3.4}, 0, 1.2, house.plaster, false);
    house.building.block({4, 3.25, 5, 3.35}, 0.2, 0.9, house.glass, true);  // inside the slab
    const ReliefExtractionReport report = house.extract();
    EXPECT_EQ(house.triangles(), kBodyTriangles);
    EXPECT_GE(report.triangles_hidden, 12u);
}

TEST(ReliefExtraction, OtherObjectsBareWallsAndFacadesThatAreThereStayAsTheyAre) {
    House road, bare, dressed;
    road.close_wall();
    road.building.object().kind = city::ObjectKind::kBridge;
    bare.windows.clear();
    bare.close_wall();
    dressed.close_wall();
    dressed.building.object().facades.push_back({{0, 0, 0}, {1, 0}, 1, 0, 0});
    for (House* house : {&road, &bare, &dressed}) {
        const size_t triangles = house->triangles(), facades = house->building.object().facades.size();
        house->extract();
        EXPECT_EQ(house->triangles(), triangles);
        EXPECT_EQ(house->building.object().facades.size(), facades);
    }
}

/// Material that a ray through a place of the front sees, coming from the right (rising u) by `slope`.
uint32_t material_from_right(House& house, double u, double v, double w, double slope) {
    const ReliefProbe probe = house.relief();
    constexpr double kAway = 1;
    const city::Vec3 from = house.building.world({u + slope * kAway, v, w + kAway}),
                     to = house.building.world({u, v, w});
    return probe.material_along(from, {to.x - from.x, to.y - from.y, to.z - from.z}).value_or(UINT32_MAX);
}

TEST(ReliefExtraction, EveryPartOfARevealShowsItsOwnMaterial) {
    House house;
    const uint32_t stone = house.building.material(250, 20, 20), wood = house.building.material(20, 200, 20);
    const Opening o = {7.2, 0.1, 9.2, 0.9};
    house.close_wall({o});
    // The left reveal: stone, and behind it wood; the wall's plaster only at its front.
    house.building.window(o, -0.2, -0.3, wood, house.glass);
    house.building.window(o, -0.1, -0.2, stone, house.glass);
    house.building.window(o, 0, -0.1, house.plaster, house.glass);
    auto& triangles = house.building.object().triangles;
    std::erase_if(triangles, [&](const city::Triangle& t) {  // panes of the first two
        const auto& points = house.building.object().vertices;
        const auto local = [&](uint32_t v) { return 200 - points[v].y; };
        return t.material == house.glass && local(t.vertex[0]) > -0.25 && points[t.vertex[0]].z < 30 + 0.95 &&
               points[t.vertex[1]].z < 30 + 0.95 && points[t.vertex[2]].z < 30 + 0.95;
    });
    house.extract();
    ASSERT_EQ(house.building.object().facades.size(), 1u);
    constexpr double kSlope = 2;
    EXPECT_EQ(material_from_right(house, o.u0, 0.5, -0.05, kSlope), house.plaster);
    EXPECT_EQ(material_from_right(house, o.u0, 0.5, -0.15, kSlope), stone);
    EXPECT_EQ(material_from_right(house, o.u0, 0.5, -0.25, kSlope), wood);
    EXPECT_EQ(house.shown_material(8.2, 0.5), house.glass);
}

TEST(ReliefExtraction, PlainWallsAreNoFacades) {
    city::CityCatalog catalog;
    const auto build = [&](bool with_windows) {
        ReliefBuilding box(catalog);
        const uint32_t plaster = box.material(200, 200, 200);
        box.body(16, 9, plaster);
        // A footprint with many small steps, as surveyed ones have: each strip of wall in a plane of its own.
        for (int i = 0; i < 16; ++i) {
            const double w = -0.1 * (i % 3);
            box.front({1.0 * i, 0, i + 1.0, 9}, w, plaster, city::SurfaceKind::kWall);
            if (i > 0) {
                const double before = -0.1 * ((i - 1) % 3), low = std::min(w, before), high = std::max(w, before);
                if (w > before) {
                    box.quad({1.0 * i, 0, low}, {1.0 * i, 0, high}, {1.0 * i, 9, high}, {1.0 * i, 9, low}, plaster,
                             city::SurfaceKind::kWall);
                } else {
                    box.quad({1.0 * i, 0, high}, {1.0 * i, 0, low}, {1.0 * i, 9, low}, {1.0 * i, 9, high}, plaster,
                             city::SurfaceKind::kWall);
                }
            }
            if (with_windows) box.block({i + 0.2, 2, i + 0.8, 3}, w, w + 0.1, plaster, false);
        }
        ReliefExtractor extractor(catalog, {});
        extractor.extract(box.object());
        return box.object().facades.size();
    };
    EXPECT_EQ(build(false), 0u);
    EXPECT_GE(build(true), 1u) << "the same with parts that stand out of it";
}

TEST(ReliefExtraction, OfTwoPanesInOnePlaneTheOneThatFacesOutShows) {
    House house;
    house.close_wall();
    const uint32_t inside = house.building.material(250, 20, 20);
    for (const Opening& o : house.windows) {
        house.building.quad({o.u1, o.v0, -0.15}, {o.u0, o.v0, -0.15}, {o.u0, o.v1, -0.15}, {o.u1, o.v1, -0.15}, inside,
                            city::SurfaceKind::kWindow);
    }
    house.extract();
    ASSERT_EQ(house.building.object().facades.size(), 1u);
    EXPECT_EQ(house.triangles(), kBodyTriangles);
    for (const Opening& o : house.windows)
        EXPECT_EQ(house.shown_material((o.u0 + o.u1) / 2, (o.v0 + o.v1) / 2), house.glass);
}

TEST(ReliefExtraction, AFacadeOfWhichTooMuchIsSeenWrongIsGivenBack) {
    House house;
    house.close_wall();
    // One reveal of four is a gap through which the street sees into the house: relief closes it.
    auto& object = house.building.object();
    std::erase_if(object.triangles, [&](const city::Triangle& t) {
        double left = 1e300, right = -1e300, back = 1e300;
        for (const uint32_t v : t.vertex) {
            left = std::min(left, object.vertices[v].x - 100);
            right = std::max(right, object.vertices[v].x - 100);
            back = std::min(back, 200 - object.vertices[v].y);
        }
        return right - left < 1e-6 && back > -1 && left > 0.5 && std::fmod(left + 0.01, 3) < 1.1;
    });
    const size_t before = house.triangles();
    ReliefExtractionOptions strict;
    strict.most_wrong = -1;  // no facade is right enough
    ReliefExtractor extractor(house.catalog, strict);
    extractor.extract(object);
    EXPECT_EQ(extractor.report().facades, 0u);
    EXPECT_GE(extractor.report().facades_given_back, 1u);
    EXPECT_EQ(house.triangles(), before);
    const ReliefExtractionReport report = house.extract();
    EXPECT_LE(static_cast<double>(report.rays_wrong), 0.01 * static_cast<double>(report.rays));
}

TEST(ReliefExtraction, TheReportSaysWhichShareOfTheRaysSeesSomethingElse) {
    House house;
    house.close_wall();
    const ReliefExtractionReport report = house.extract();
    EXPECT_GT(report.rays, 10000u);
    EXPECT_LE(static_cast<double>(report.rays_wrong), 0.002 * static_cast<double>(report.rays));
}

TEST(ReliefExtraction, TheVerticesOfTheMeshAreThoseItUses) {
    House house;
    house.close_wall();
    house.extract();
    std::vector<uint8_t> used(house.building.object().vertices.size(), 0);
    for (const city::Triangle& t : house.building.object().triangles) {
        for (const uint32_t v : t.vertex) used.at(v) = 1;
    }
    EXPECT_EQ(std::count(used.begin(), used.end(), 1), static_cast<std::ptrdiff_t>(used.size()));
    EXPECT_EQ(used.size(), 8u);
}

}  // namespace
}  // namespace citystream::tiles::layers
