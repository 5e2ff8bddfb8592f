#include "tiles/radiance/visibility_bake.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "codec/radiance/local_directions.h"
#include "codec/radiance/source_directions.h"
#include "codec/radiance/transfer.h"
#include "tests/tiles/radiance/box_city.h"

namespace citystream::tiles::radiance {
namespace {

using test::at;
using test::Surface;

const double kPi = std::acos(-1.0);

/// Light that a receiver gets from a sky of radiance 1 all around, over pi: samples weighted by solid angle and cosine.
double sky_factor(const BakedTile& tile, uint32_t receiver) {
    const uint32_t side = codec::radiance::kSamplesAcross * tile.visibility.side;
    const Receiver& what = tile.receivers[receiver];
    const auto normal = receiver_normal(what.surface_class, what.tilt);
    double sum = 0;
    for (uint32_t sample = 0; sample < codec::radiance::cube_cells(side); ++sample) {
        if (!tile.visibility.sees(receiver, sample)) continue;
        const auto direction = ray_direction(codec::radiance::cell_direction(side, sample));
        const double cosine = direction[0] * normal[0] + direction[1] * normal[1] + direction[2] * normal[2];
        sum += codec::radiance::cell_solid_angle(side, sample) * cosine;
    }
    return sum / kPi;
}

BakedTile bake(const Surface& own, const Surface& around, BakeOptions options = {},
               const HeightGrid* heights = nullptr) {
    options.lattice.jobs = options.lattice.jobs == 0 ? 2 : options.lattice.jobs;
    auto tile = bake_tile({own, around, heights}, options);
    EXPECT_TRUE(tile) << tile.error().text();
    return std::move(*tile);
}

TEST(VisibilityBake, OpenGroundGetsAllOfAUniformSky) {
    for (const uint32_t texels : {8U, 16U, 32U}) {
        const BakedTile tile =
            bake(test::ground(0, 0, 8, 8), test::ground(-200, -200, 0, 200), {.texels_across = texels});
        ASSERT_EQ(tile.receivers.size(), 25U);
        for (uint32_t i = 0; i < 25; ++i) EXPECT_NEAR(sky_factor(tile, i), 1, 0.005) << texels;
    }
}

TEST(VisibilityBake, OpenGroundGetsPiThroughTheTransferMatrix) {
    const BakedTile tile = bake(test::ground(0, 0, 2, 2), {});
    const codec::radiance::LocalDirections local(8);
    const auto averages = codec::radiance::cell_averages(local);
    const auto transfer = codec::radiance::make_transfer(tile.visibility, local);
    ASSERT_EQ(transfer.rows(), tile.receivers.size() * 64);
    for (uint32_t receiver = 0; receiver < tile.receivers.size(); ++receiver) {
        double averaged = 0, at_centres = 0;
        for (uint32_t j = 0; j < 64; ++j) {
            double light = 0;
            const uint32_t row = receiver * 64 + j;
            for (uint32_t k = transfer.row_begin[row]; k < transfer.row_begin[row + 1]; ++k) {
                light += transfer.quarters[k] / 4.0 * codec::radiance::cell_solid_angle(32, transfer.column[k]);
            }
            averaged += light * averages.cosine[j];
            at_centres += light * local.direction(j)[2] / codec::radiance::kFrameOne;
        }
        EXPECT_NEAR(averaged / kPi, 1, 0.005);
        EXPECT_GT(at_centres / kPi, 1.03) << "what averages over cells are for";
    }
}

/// A wall along y at x = 0, `height` metres high, and the ground east of it.
Surface wall_and_ground(double height, double far) {
    Surface surface;
    test::add_quad(surface, {at(0, -far, 0), at(0, far, 0), at(0, far, height), at(0, -far, height)});
    test::add(surface, test::ground(0, -far, 400, far));
    return surface;
}

TEST(VisibilityBake, GroundAtAnEndlessWallGetsTheClosedForm) {
    constexpr double kHeight = 20;
    for (const bool horizon : {false, true}) {
        const Surface around = wall_and_ground(kHeight, 4000);
        HeightGrid heights({-100, -100}, {100, 100});
        heights.add(around);
        // Without a horizon all of the wall is within reach of the rays.
        const OccluderReach reach = horizon ? OccluderReach{} : OccluderReach{.triangles = 4000, .horizon = 4000};
        for (const double x : {2.0, 10.0, 20.0, 60.0, 110.0}) {
            const BakedTile tile =
                bake(test::ground(x, 0, x + 2, 2), around, {.reach = reach}, horizon ? &heights : nullptr);
            ASSERT_GE(tile.receivers.size(), 4U);
            for (uint32_t i = 0; i < tile.receivers.size(); ++i) {
                const double distance = to_metres(tile.receivers[i].point.x);
                const double expected = (1 + std::cos(std::atan(kHeight / distance))) / 2;
                EXPECT_NEAR(sky_factor(tile, i) / expected, 1, 0.015) << distance << (horizon ? " with horizon" : "");
            }
        }
    }
}

TEST(VisibilityBake, AWallOppositeAnEndlessWallGetsTheClosedForm) {
    constexpr double kHeight = 20, kWidth = 16;
    Surface around = wall_and_ground(kHeight, 4000), own;
    test::add_quad(own, {at(kWidth, 0, 0), at(kWidth, 2, 0), at(kWidth, 2, kHeight), at(kWidth, 0, kHeight)});
    for (SurfaceTriangle& triangle : own) std::swap(triangle.corners[1], triangle.corners[2]);  // looks west
    const BakedTile tile = bake(own, around, {.reach = {.triangles = 4000, .horizon = 4000}});
    ASSERT_EQ(tile.receivers.size(), 2U * 11U);
    for (uint32_t i = 0; i < tile.receivers.size(); ++i) {
        const double z = to_metres(tile.receivers[i].point.z);
        const double expected = (1 - std::sin(std::atan((kHeight - z) / kWidth))) / 2;
        EXPECT_NEAR(sky_factor(tile, i), expected, 0.015 * 0.5) << z;
    }
}

TEST(VisibilityBake, WhoIsShutInSeesNothing) {
    Surface room;  // looked at from inside, so its fronts are inside
    for (SurfaceTriangle triangle : test::tower(4, 4, 4, 3)) {
        std::swap(triangle.corners[1], triangle.corners[2]);
        room.push_back(triangle);
    }
    test::add(room, test::ground(2, 2, 6, 6));
    const BakedTile tile = bake(room, {});
    ASSERT_GT(tile.receivers.size(), 40U);
    EXPECT_GT(tile.rays, 0U);
    EXPECT_TRUE(
        std::all_of(tile.visibility.words.begin(), tile.visibility.words.end(), [](uint32_t w) { return w == 0; }));
}

TEST(VisibilityBake, NothingIsSeenBelowTheReceiversPlane) {
    Surface roof;
    test::add_quad(roof, {at(0, 0, 0), at(8, 0, 5), at(8, 4, 5), at(0, 4, 0)});
    const BakedTile tile = bake(roof, {}, {.texels_across = 8});
    auto cleared = tile.visibility;
    codec::radiance::clear_below_planes(cleared);
    EXPECT_EQ(cleared, tile.visibility);
    // Nothing else is there, so all that is above is seen.
    const auto above = codec::radiance::samples_above(codec::radiance::unpack_frame(frame_of(tile.receivers[0])), 8);
    for (uint32_t i = 0; i < tile.visibility.receivers(); ++i) {
        const auto words = tile.visibility.of(i);
        EXPECT_TRUE(std::equal(words.begin(), words.end(), above.begin(), above.end()));
    }
}

TEST(VisibilityBake, DoesNotDependOnTheNumberOfThreadsAndTellsItsProgress) {
    const Surface own = test::city_tile(0, 0, true), around = test::tiles_around(0, 0, true);
    BakeOptions options{.lattice = {.spacing = to_grid(8), .jobs = 1}, .texels_across = 8};
    const BakedTile one = bake(own, around, options);
    uint64_t before = 0, told = 0;
    options.lattice.jobs = 3;
    options.progress = [&](uint64_t done, uint64_t total) {
        EXPECT_GT(done, before);
        EXPECT_EQ(total, one.receivers.size());
        before = done;
        ++told;
    };
    const BakedTile three = bake(own, around, options);
    EXPECT_EQ(one.receivers, three.receivers);
    EXPECT_EQ(one.visibility, three.visibility);
    EXPECT_EQ(one.rays, three.rays);
    EXPECT_EQ(before, one.receivers.size());
    EXPECT_GT(told, 10U);
}

TEST(VisibilityBake, CanBeCancelled) {
    std::atomic<bool> cancel = false;
    BakeOptions options{.lattice = {.spacing = to_grid(8), .jobs = 2}, .texels_across = 8, .cancel = &cancel};
    options.progress = [&](uint64_t, uint64_t) { cancel = true; };
    const Surface own = test::city_tile(0, 0, false);
    const auto tile = bake_tile({own, {}, nullptr}, options);
    ASSERT_FALSE(tile);
    EXPECT_EQ(tile.error().message, "interrupted");
}

struct SeamCount {
    size_t shared = 0, same_receiver = 0, same_sight = 0;
};

/// Receivers of two tiles that stand for the same surface of the same column.
SeamCount compare_seam(const BakedTile& a, const BakedTile& b, int64_t spacing) {
    SeamCount count;
    for (uint32_t i = 0; i < a.receivers.size(); ++i) {
        for (uint32_t j = 0; j < b.receivers.size(); ++j) {
            const Receiver &r = a.receivers[i], &s = b.receivers[j];
            if (r.surface_class != s.surface_class || r.column != s.column) continue;
            const double cosine =
                test::dot(receiver_normal(r.surface_class, r.tilt), receiver_normal(s.surface_class, s.tilt));
            if (2 * std::abs(r.depth - s.depth) >= spacing || cosine <= std::cos(kShareDegrees * kPi / 180)) continue;
            ++count.shared;
            const auto sight = a.visibility.of(i), other = b.visibility.of(j);
            count.same_receiver += r == s ? 1 : 0;
            count.same_sight += std::equal(sight.begin(), sight.end(), other.begin(), other.end()) ? 1 : 0;
        }
    }
    return count;
}

TEST(VisibilityBake, TilesAgreeAboutEveryReceiverTheyShareAsLongAsTheyHaveTheirHalo) {
    const BakeOptions options{.lattice = {.spacing = to_grid(8)}, .texels_across = 16};
    const Surface west = test::city_tile(0, 0, true), east = test::city_tile(1, 0, true);
    const Surface around_west = test::tiles_around(0, 0, true), around_east = test::tiles_around(1, 0, true);
    HeightGrid heights({-90, -90}, {100, 90});
    for (int64_t y = -10; y <= 10; ++y) {
        for (int64_t x = -10; x <= 11; ++x) heights.add(test::city_tile(x, y, true));
    }
    const SeamCount with = compare_seam(bake(west, around_west, options, &heights),
                                        bake(east, around_east, options, &heights), options.lattice.spacing);
    EXPECT_GE(with.shared, 17U);
    EXPECT_EQ(with.same_receiver, with.shared);
    EXPECT_EQ(with.same_sight, with.shared);

    const SeamCount without =
        compare_seam(bake(west, {}, options, &heights), bake(east, {}, options, &heights), options.lattice.spacing);
    EXPECT_GE(without.shared, 17U);
    EXPECT_LT(without.same_sight, without.shared / 2) << "light comes in where the neighbour's towers should be";
}

TEST(BakeHash, ChangesWithWhateverTheResultDependsOnAndWithNothingElse) {
    Surface own = test::city_tile(0, 0, true), around = test::tiles_around(0, 0, true);
    HeightGrid heights({-90, -90}, {90, 90});
    heights.add(own);
    const BakeOptions options;
    const auto hash = [&](const BakeOptions& with) { return bake_hash({own, around, &heights}, with, {0, 0, 0}); };
    const uint64_t first = hash(options);

    std::reverse(around.begin(), around.end());
    test::add(around, test::tower(700, 700, 10, 50));  // out of the triangles' reach, and not in the heights
    EXPECT_EQ(hash(options), first);
    EXPECT_EQ(hash({.lattice = {.jobs = 7}}), first);

    EXPECT_NE(hash({.lattice = {.spacing = to_grid(4)}}), first);
    EXPECT_NE(hash({.lattice = {.least_share = 0}}), first);
    EXPECT_NE(hash({.texels_across = 16}), first);
    EXPECT_NE(hash({.reach = {.triangles = 64, .horizon = 1200}}), first);
    heights.add(test::tower(700, 700, 10, 50));
    const uint64_t second = hash(options);
    EXPECT_NE(second, first);
    around[17].corners[0].z += 1;
    EXPECT_NE(hash(options), second);
    around[17].corners[0].z -= 1;
    EXPECT_EQ(hash(options), second);
    own[3].corners[1].x += 1;
    EXPECT_NE(hash(options), second);
}

TEST(BakeHash, IsThatOfACityMovedByWholeCells) {
    Surface own = test::city_tile(0, 0, true);
    const uint64_t first = bake_hash({own, {}, nullptr}, {}, {0, 0, 0});
    const GridPoint move = {int64_t{128} << 30, -(int64_t{128} << 29), 0};
    for (SurfaceTriangle& triangle : own) {
        for (GridPoint& corner : triangle.corners) corner = {corner.x + move.x, corner.y + move.y, corner.z};
    }
    EXPECT_EQ(bake_hash({own, {}, nullptr}, {}, move), first);
    EXPECT_NE(bake_hash({own, {}, nullptr}, {}, {move.x + 1, move.y, 0}), first);
}

}  // namespace
}  // namespace citystream::tiles::radiance
