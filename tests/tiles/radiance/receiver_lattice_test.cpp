#include "tiles/radiance/receiver_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <random>
#include <tuple>

#include "tests/tiles/radiance/occluder_scenes.h"
#include "tiles/radiance/even_light.h"

namespace citystream::tiles::radiance {
namespace {

using test::at;
using test::kTile;
using test::Surface;

Surface joined(const Surface& a, const Surface& b) {
    Surface both = a;
    test::add(both, b);
    return both;
}

std::vector<Receiver> place(const Surface& own, const Surface& around, int64_t spacing, uint32_t jobs = 2) {
    const auto scene = OccluderScene::create(joined(own, around), nullptr, kTile);
    EXPECT_TRUE(scene);
    return place_receivers(own, around, *scene, {spacing, jobs});
}

size_t of_class(std::span<const Receiver> receivers, uint32_t surface_class) {
    return static_cast<size_t>(std::count_if(receivers.begin(), receivers.end(), [&](const Receiver& receiver) {
        return receiver.surface_class == surface_class;
    }));
}

TEST(ReceiverLattice, FlatGroundHasOneReceiverAtEachCornerOfItsCells) {
    const auto receivers = place(test::ground(0, 0, 16, 8), {}, to_grid(2));
    ASSERT_EQ(receivers.size(), 9U * 5U);
    EXPECT_TRUE(std::is_sorted(receivers.begin(), receivers.end()));
    for (const Receiver& receiver : receivers) {
        EXPECT_EQ(receiver.surface_class, 4);
        EXPECT_EQ(receiver.depth, 0);
        EXPECT_EQ(receiver.tilt, (std::array<int8_t, 2>{0, 0}));
        // At the column, or where that is on the border a little inside.
        EXPECT_LT(std::hypot(to_metres(receiver.point.x) - 2 * static_cast<double>(receiver.column[0]),
                             to_metres(receiver.point.y) - 2 * static_cast<double>(receiver.column[1])),
                  0.1);
        EXPECT_EQ(receiver.point.z, 0);
    }
}

TEST(ReceiverLattice, NothingAndWhatHasNoAreaWantNoReceivers) {
    EXPECT_TRUE(place({}, test::ground(0, 0, 8, 8), to_grid(2)).empty());
    const Surface thin = {SurfaceTriangle{{at(1, 1, 0), at(1, 1, 0), at(5, 5, 0)}},
                          SurfaceTriangle{{at(0, 0, 0), at(4, 0, 0), at(8, 0, 0)}},
                          SurfaceTriangle{{GridPoint{0, 0, 0}, GridPoint{9000, 0, 0}, GridPoint{4000, 3, 0}}}};
    EXPECT_TRUE(place(thin, {}, to_grid(2)).empty());
}

TEST(ReceiverLattice, ATowersWallsRoofAndGroundHaveLatticesOfTheirOwn) {
    Surface surface = test::ground(0, 0, 64, 64);
    test::add(surface, test::tower(32, 32, 16, 24));
    const auto receivers = place(surface, {}, to_grid(4));
    // Walls 16 x 24 m on columns of 4 m, from 24 to 40 and from 0 to 24.
    for (uint32_t wall = 0; wall < 4; ++wall) EXPECT_EQ(of_class(receivers, wall), 5U * 7U);
    // The roof's 5 x 5; of the ground's 17 x 17 those nowhere near the open are missing, 3 x 3 of them.
    EXPECT_EQ(of_class(receivers, 4), 25U + 17U * 17U - 9U);
    EXPECT_EQ(of_class(receivers, 5), 0U);
    for (const Receiver& receiver : receivers) {
        const double x = to_metres(receiver.point.x), y = to_metres(receiver.point.y);
        const bool below_tower = x > 24 && x < 40 && y > 24 && y < 40 && receiver.depth == 0;
        EXPECT_FALSE(receiver.surface_class == 4 && below_tower);
        EXPECT_TRUE(receiver.surface_class != 0 || receiver.point.x == to_grid(40));
    }
}

/// Within rounding, and facing the same way, but for what surfaces that stand for each other may differ.
bool on_triangle(const GridPoint& point, const test::Vector& normal, const SurfaceTriangle& triangle) {
    constexpr int64_t kRounding = 2;
    constexpr double kLike = 0.989;
    const auto& [p, q, r] = triangle.corners;
    const auto within = [](int64_t value, int64_t a, int64_t b, int64_t c) {
        return value >= std::min({a, b, c}) - kRounding && value <= std::max({a, b, c}) + kRounding;
    };
    const auto exact = test::unit_normal(triangle);
    return within(point.x, p.x, q.x, r.x) && within(point.y, p.y, q.y, r.y) && within(point.z, p.z, q.z, r.z) &&
           test::dot(exact, normal) > kLike && std::abs(test::dot(exact, test::vector_between(p, point))) < kRounding;
}

TEST(ReceiverLattice, NoneIsBuriedAndAllAreOnASurface) {
    for (const bool turned : {false, true}) {
        const Surface own = test::city_tile(0, 0, turned), around = test::tiles_around(0, 0, turned);
        const Surface all = joined(own, around);
        const auto scene = OccluderScene::create(all, nullptr, kTile);
        ASSERT_TRUE(scene);
        const auto receivers = place_receivers(own, around, *scene, {to_grid(8), 2});
        EXPECT_GT(receivers.size(), 1000U);
        size_t buried_ones = 0;
        for (const Receiver& receiver : receivers) {
            const auto normal = receiver_normal(receiver.surface_class, receiver.tilt);
            EXPECT_FALSE(enclosed(*scene, receiver.point, normal));
            buried_ones += buried(*scene, receiver.point, normal) ? 1 : 0;
            EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const SurfaceTriangle& triangle) {
                return on_triangle(receiver.point, normal, triangle);
            }));
        }
        EXPECT_EQ(buried_ones, 0U);
    }
}

/// A tower 16 m wide at (32, 32) on ground that is cut out below it; each wall is two rectangles, a plinth from 2.5 m
/// under the ground to `plinth` metres above it and the rest.
Surface tower_on_a_plinth(double plinth) {
    Surface surface = test::ground(0, 0, 64, 24);
    test::add(surface, test::ground(0, 40, 64, 64));
    test::add(surface, test::ground(0, 24, 24, 40));
    test::add(surface, test::ground(40, 24, 64, 40));
    const Surface foot = test::tower(32, 32, 16, plinth, 0, -2.5);
    test::add(surface, {foot.begin(), foot.end() - 2});
    test::add(surface, test::tower(32, 32, 16, 20, 0, plinth));
    return surface;
}

TEST(ReceiverLattice, WallsStandOnWhatIsSeenOfThemAndFoundationsHaveNoReceivers) {
    for (const double plinth : {0.0625, 0.5}) {
        for (const double metres : {2.0, 4.0}) {
            const auto receivers = place(tower_on_a_plinth(plinth), {}, to_grid(metres));
            size_t walls = 0;
            for (const Receiver& receiver : receivers) {
                if (receiver.surface_class >= 4) continue;
                ++walls;
                EXPECT_GT(receiver.point.z, 0) << plinth << ' ' << metres;
            }
            const auto across = static_cast<size_t>(16 / metres) + 1, up = static_cast<size_t>(20 / metres) + 1;
            EXPECT_GE(walls, 4 * across * up) << plinth << ' ' << metres;
            EXPECT_LE(walls, 4 * across * (up + 1)) << plinth << ' ' << metres;
        }
    }
}

TEST(ReceiverLattice, OfAdjoiningHousesOnlyWhatStandsOutHasReceivers) {
    // A house 24 m high, and one 8 m high that covers the lower third of its eastern wall; no floors.
    Surface surface = test::ground(0, 0, 64, 64);
    test::add(surface, test::tower(24, 32, 16, 24));
    const auto alone = place(surface, {}, to_grid(4));
    test::add(surface, test::tower(40, 32, 16, 8));
    const auto receivers = place(surface, {}, to_grid(4));
    const auto of_party_wall = [](std::span<const Receiver> all, uint32_t surface_class) {
        std::vector<Receiver> found;
        std::copy_if(all.begin(), all.end(), std::back_inserter(found), [&](const Receiver& receiver) {
            return receiver.surface_class == surface_class && receiver.point.x == to_grid(32);
        });
        return found;
    };
    EXPECT_EQ(of_party_wall(alone, 0).size(), 5U * 7U);
    // Columns at 8 m light the wall just above the lower roof, those below nothing.
    const auto exposed = of_party_wall(receivers, 0);
    EXPECT_EQ(exposed.size(), 5U * 5U);
    for (const Receiver& receiver : exposed) EXPECT_GE(receiver.point.z, to_grid(8));
    EXPECT_TRUE(of_party_wall(receivers, 1).empty()) << "the lower house's wall is covered from end to end";
    for (const Receiver& receiver : receivers) {
        const bool inside = receiver.surface_class == 4 && receiver.point.z == 0 &&
                            std::abs(receiver.point.y - to_grid(32)) < to_grid(8) &&
                            std::abs(receiver.point.x - to_grid(32)) < to_grid(16);
        EXPECT_FALSE(inside) << "on the ground inside";
    }
}

TEST(ReceiverLattice, OfAFoundationTheStripAboveTheGroundIsFound) {
    Surface surface = test::ground(-64, -64, 128, 24);
    test::add(surface, test::ground(-64, 24, 128, 128));
    // A sill: 16 m long, 2.5 m of it under the ground and 50 cm above.
    test::add_quad(surface, {at(24, 24, -2.5), at(40, 24, -2.5), at(40, 24, 0.5), at(24, 24, 0.5)});
    const auto receivers = place(surface, {}, to_grid(8));
    EXPECT_GE(of_class(receivers, 3), 3U);
    for (const Receiver& receiver : receivers) EXPECT_TRUE(receiver.surface_class != 3 || receiver.point.z > 0);
}

TEST(ReceiverLattice, AWallThatFacesTheWrongWayTakesNoReceiversFromTheGround) {
    Surface surface = test::ground(0, 0, 16, 16);
    // A sheet across the ground that has its front in the east.
    test::add_quad(surface, {at(8, 0, 0), at(8, 16, 0), at(8, 16, 30), at(8, 0, 30)});
    const auto receivers = place(surface, {}, to_grid(4));
    EXPECT_EQ(of_class(receivers, 4), 5U * 5U);
}

TEST(ReceiverLattice, WhatLittleHangsOnIsLeftOut) {
    // A roof with a box of 0.5 m on it: on a lattice of 4 m the box is worth 1/64 of a spacing squared.
    Surface surface = test::ground(0, 0, 16, 16, 10);
    test::add(surface, test::tower(7, 7, 0.5, 10.5, 0, 10));
    const auto scene = OccluderScene::create(surface, nullptr, kTile);
    ASSERT_TRUE(scene);
    const auto all = place_receivers(surface, {}, *scene, {to_grid(4), 2, 0}), some = place(surface, {}, to_grid(4));
    EXPECT_EQ(some.size(), 25U);
    EXPECT_GT(all.size(), 25U + 4U);
    EXPECT_TRUE(std::includes(all.begin(), all.end(), some.begin(), some.end()));
    // A wall that is narrow and high keeps its receivers.
    const auto narrow = place(test::tower(2, 2, 0.5, 30), {}, to_grid(4));
    EXPECT_EQ(of_class(narrow, 0), 8U + 8U);
}

TEST(ReceiverLattice, TheDarkLineUnderAnEaveIsNotWhereAWallsReceiversStand) {
    constexpr double kTop = 4.2, kEdge = 40, kEave = 1;
    Surface house = test::ground(0, 0, 64, 64);
    test::add(house, test::tower(32, 32, 16, kTop));
    const Surface bare = house;
    house.push_back(SurfaceTriangle{{at(kEdge, 24, kTop), at(kEdge + kEave, 24, kTop), at(kEdge + kEave, 40, kTop)}});
    house.push_back(SurfaceTriangle{{at(kEdge, 24, kTop), at(kEdge + kEave, 40, kTop), at(kEdge, 40, kTop)}});
    const auto scene = OccluderScene::create(house, nullptr, kTile);
    ASSERT_TRUE(scene);
    const EvenLight even({1, 0, 0});
    // The columns just below the wall's upper edge: without an eave the receivers stand at them.
    const auto top_row = [&](const Surface& surface) {
        std::vector<GridPoint> points;
        for (const Receiver& receiver : place(surface, {}, to_grid(4))) {
            if (receiver.surface_class == 0 && receiver.column[1] == 1) points.push_back(receiver.point);
        }
        return points;
    };
    const auto open_points = top_row(bare), points = top_row(house);
    ASSERT_EQ(points.size(), 5U);
    ASSERT_EQ(open_points.size(), 5U);
    for (size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(points[i].x, to_grid(kEdge));
        EXPECT_NEAR(to_metres(open_points[i].z), 4, 0.2);
        EXPECT_LT(even.at(*scene, open_points[i]), 0.4) << "a wall in the open has half";
        EXPECT_LT(to_metres(points[i].z), 3.5);
        EXPECT_GT(even.at(*scene, points[i]), even.at(*scene, open_points[i]) + 0.05);
    }
}

TEST(EvenLight, IsWholeInTheOpenAndHalfAtTheFootOfALongWall) {
    Surface surface = test::ground(0, 0, 128, 128);
    const EvenLight even({0, 0, 1});
    const auto open_field = OccluderScene::create(surface, nullptr, kTile);
    ASSERT_TRUE(open_field);
    EXPECT_NEAR(even.at(*open_field, at(64, 64, 0)), 1, 1e-12);
    surface.push_back(SurfaceTriangle{{at(64, -900, 0), at(64, 1000, 0), at(64, 1000, 2000)}});
    surface.push_back(SurfaceTriangle{{at(64, -900, 0), at(64, 1000, 2000), at(64, -900, 2000)}});
    const auto walled = OccluderScene::create(surface, nullptr, kTile, {.triangles = 3000, .horizon = 3000});
    ASSERT_TRUE(walled);
    // Of the few directions those along the wall, a tenth of the light, meet nothing.
    EXPECT_NEAR(even.at(*walled, at(64.1, 50, 0)), 0.5, 0.12);
}

TEST(ReceiverLattice, OfAnyTwoInAColumnNoneStandsForTheOther) {
    const int64_t spacing = to_grid(8);
    const auto receivers = place(test::city_tile(0, 0, true), test::tiles_around(0, 0, true), spacing);
    for (size_t i = 0; i < receivers.size(); ++i) {
        for (size_t j = i + 1; j < receivers.size(); ++j) {
            const Receiver &a = receivers[i], &b = receivers[j];
            if (a.surface_class != b.surface_class || a.column != b.column) break;
            const auto n = receiver_normal(a.surface_class, a.tilt), m = receiver_normal(b.surface_class, b.tilt);
            EXPECT_TRUE(2 * std::abs(a.depth - b.depth) >= spacing ||
                        test::dot(n, m) <= std::cos(kShareDegrees * std::acos(-1.0) / 180));
        }
    }
}

TEST(ReceiverLattice, DoesNotDependOnTheOrderOfTrianglesTheirFirstCornersOrTheNumberOfThreads) {
    Surface own = test::city_tile(0, 0, true), around = test::tiles_around(0, 0, true);
    const auto expected = place(own, around, to_grid(4), 1);
    std::mt19937 random(3);
    for (const uint32_t jobs : {1U, 3U}) {
        for (Surface* surface : {&own, &around}) {
            std::shuffle(surface->begin(), surface->end(), random);
            for (SurfaceTriangle& triangle : *surface) {
                std::rotate(triangle.corners.begin(), triangle.corners.begin() + random() % 3, triangle.corners.end());
            }
        }
        EXPECT_EQ(place(own, around, to_grid(4), jobs), expected);
    }
}

TEST(ReceiverLattice, ACityMovedByWholeSpacingsHasItsReceiversMoved) {
    Surface own = test::city_tile(0, 0, true), around = test::tiles_around(0, 0, true);
    auto expected = place(own, around, to_grid(8));
    const GridPoint move = {int64_t{128} << 33, -(int64_t{128} << 32), to_grid(16)};
    for (Surface* surface : {&own, &around}) {
        for (SurfaceTriangle& triangle : *surface) {
            for (GridPoint& corner : triangle.corners)
                corner = {corner.x + move.x, corner.y + move.y, corner.z + move.z};
        }
    }
    StartBox box = kTile;
    for (GridPoint* point : {&box.low, &box.high}) *point = {point->x + move.x, point->y + move.y, point->z + move.z};
    const auto scene = OccluderScene::create(joined(own, around), nullptr, box);
    ASSERT_TRUE(scene);
    const int64_t spacing = to_grid(8);
    const auto moved = place_receivers(own, around, *scene, {spacing, 2});
    const GridPoint base = {0, 0, 0};
    EXPECT_EQ(places_of(moved, move, spacing), places_of(expected, base, spacing));
    ASSERT_EQ(moved.size(), expected.size());
    for (size_t i = 0; i < moved.size(); ++i) {
        const GridPoint &p = moved[i].point, &q = expected[i].point;
        EXPECT_EQ(p, (GridPoint{q.x + move.x, q.y + move.y, q.z + move.z}));
    }
}

TEST(ReceiverLattice, TilesThatShareAColumnMakeTheSameReceiverOfIt) {
    const int64_t spacing = to_grid(8);
    const auto west = place(test::city_tile(0, 0, true), test::tiles_around(0, 0, true), spacing);
    const Surface own = test::city_tile(1, 0, true), around = test::tiles_around(1, 0, true);
    StartBox box = kTile;
    box.low.x += to_grid(test::kTileMetres);
    box.high.x += to_grid(test::kTileMetres);
    const auto scene = OccluderScene::create(joined(own, around), nullptr, box);
    ASSERT_TRUE(scene);
    const auto east = place_receivers(own, around, *scene, {spacing, 2});
    size_t shared = 0;
    for (const Receiver& receiver : west) {
        if (receiver.surface_class != 4 || receiver.column[0] != 16 || receiver.depth != 0) continue;
        EXPECT_EQ(std::count(east.begin(), east.end(), receiver), 1);
        ++shared;
    }
    EXPECT_EQ(shared, 17U);
}

TEST(ReceiverLattice, RoofsAtFortyFiveDegreesBelongToBothClasses) {
    Surface roof;
    test::add_quad(roof, {at(0, 0, 0), at(8, 0, 8), at(8, 16, 8), at(0, 16, 0)});
    const auto receivers = place(roof, {}, to_grid(4));
    EXPECT_EQ(of_class(receivers, 1), 3U * 5U);
    EXPECT_EQ(of_class(receivers, 4), 3U * 5U);
    EXPECT_EQ(receivers.size(), 30U);
    for (const Receiver& receiver : receivers) {
        const auto normal = receiver_normal(receiver.surface_class, receiver.tilt);
        EXPECT_NEAR(normal[0], -std::sqrt(0.5), 1e-9);
        EXPECT_NEAR(normal[2], std::sqrt(0.5), 1e-9);
    }
}

TEST(ReceiverLattice, AFineMeshHasNoMoreReceiversThanACoarseOne) {
    Surface fine;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) test::add(fine, test::ground(x / 4.0, y / 4.0, (x + 1) / 4.0, (y + 1) / 4.0));
    }
    const auto coarse = place(test::ground(0, 0, 16, 16), {}, to_grid(4));
    const auto receivers = place(fine, {}, to_grid(4));
    EXPECT_EQ(places_of(receivers, {}, to_grid(4)), places_of(coarse, {}, to_grid(4)));
}

// Every point of a box city that can be seen finds receivers by the table that the GPU has, all of its own plane.
class SurfacePoints : public testing::TestWithParam<std::tuple<int, bool>> {
  protected:
    void SetUp() override {
        const auto [metres, turned] = GetParam();
        spacing_ = to_grid(metres);
        own_ = test::city_tile(0, 0, turned);
        const Surface around = test::tiles_around(0, 0, turned);
        auto scene = OccluderScene::create(joined(own_, around), nullptr, kTile);
        ASSERT_TRUE(scene);
        scene_.emplace(std::move(*scene));
        receivers_ = place_receivers(own_, around, *scene_, {spacing_, 2});
        auto words = codec::radiance::write_receiver_table(
            places_of(receivers_, {}, spacing_),
            static_cast<uint32_t>(std::countr_zero(static_cast<uint64_t>(spacing_))));
        ASSERT_TRUE(words) << words.error().text();
        words_ = std::move(*words);
    }

    void check(const codec::radiance::ReceiverShares& shares, const GridPoint& point,
               const test::Vector& normal) const {
        ASSERT_GE(shares.count, 1U) << to_metres(point.x) << ' ' << to_metres(point.y) << ' ' << to_metres(point.z);
        float sum = 0;
        for (uint32_t k = 0; k < shares.count; ++k) {
            const Receiver& receiver = receivers_[shares.receiver[k]];
            // Towers that are turned come closer to each other than two columns of a wide lattice: they share
            // receivers.
            const bool shared = std::get<1>(GetParam()) && spacing_ > to_grid(2);
            EXPECT_GT(test::dot(normal, receiver_normal(receiver.surface_class, receiver.tilt)), shared ? 0.86 : 0.999);
            const auto away = test::vector_between(point, receiver.point);
            EXPECT_LT(std::abs(test::dot(normal, away)), shared ? static_cast<double>(spacing_) : 4) << "grid units";
            EXPECT_LT(test::length(away), 3.7 * static_cast<double>(spacing_));
            sum += shares.weight[k];
        }
        EXPECT_NEAR(sum, 1, 1e-5);
    }

    int64_t spacing_ = 0;
    Surface own_;
    std::optional<OccluderScene> scene_;
    std::vector<Receiver> receivers_;
    std::vector<uint32_t> words_;
};

GridPoint point_within(const SurfaceTriangle& triangle, std::mt19937& random) {
    std::uniform_real_distribution<double> uniform(0, 1);
    double u = uniform(random), v = uniform(random);
    if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
    }
    const auto& [p, q, r] = triangle.corners;
    const auto to_q = test::vector_between(p, q), to_r = test::vector_between(p, r);
    return {p.x + std::llround(u * to_q[0] + v * to_r[0]), p.y + std::llround(u * to_q[1] + v * to_r[1]),
            p.z + std::llround(u * to_q[2] + v * to_r[2])};
}

TEST_P(SurfacePoints, FindReceiversOfTheirOwnSurface) {
    EXPECT_LT(words_.size() * sizeof(uint32_t), receivers_.size() * 8) << "bytes a receiver";
    const auto table = codec::radiance::ReceiverTableView::create(words_);
    ASSERT_TRUE(table) << table.error().text();
    std::mt19937 random(1);
    size_t asked = 0, in_all_columns = 0;
    for (const SurfaceTriangle& triangle : own_) {
        const auto normal = test::unit_normal(triangle);
        for (int i = 0; i < 60; ++i) {
            const GridPoint point = point_within(triangle, random);
            if (buried(*scene_, point, normal)) continue;
            const auto shares = table->shares(
                {static_cast<float>(point.x), static_cast<float>(point.y), static_cast<float>(point.z)},
                {static_cast<float>(normal[0]), static_cast<float>(normal[1]), static_cast<float>(normal[2])});
            check(shares, point, normal);
            ++asked;
            in_all_columns += shares.count == 4 ? 1 : 0;
        }
    }
    EXPECT_GT(asked, 9000U);
    EXPECT_GT(in_all_columns, asked * 9 / 10);
}

INSTANTIATE_TEST_SUITE_P(Cities, SurfacePoints, testing::Combine(testing::Values(2, 4), testing::Bool()));

}  // namespace
}  // namespace citystream::tiles::radiance
