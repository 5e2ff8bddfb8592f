#include "codec/mesh/precision.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace citystream::codec::mesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

ScreenError screen(double pixels, double view_pixels, double near_length = 1, double near_distance = 1) {
    return {pixels, view_pixels, near_length, near_distance};
}

TEST(Precision, AnObjectThatFillsTheScreenNeedsTheBitsOfItsPixels) {
    // Extent 2^16 steps, seen from where it is as wide as the near plane: 1,024 pixels.
    const double extent = 65536, distance = 65536;
    EXPECT_EQ(level_at(screen(1, 1024), distance, extent / 65536, 16), 10u);
    EXPECT_EQ(level_at(screen(0.5, 1024), distance, extent / 65536, 16), 11u);
    EXPECT_EQ(level_at(screen(1, 1024, 0.3, 0.6), 2 * distance, extent / 65536, 16), 10u);
}

TEST(Precision, TwiceTheDistanceIsOneBitLess) {
    const ScreenError error = screen(0.5, 1080, 1.15, 1);
    for (double z = 3; z < 1e7; z *= 1.37) {
        const uint32_t near = level_at(error, z, 1, 20), far = level_at(error, 2 * z, 1, 20);
        if (near > 1 && near < 20) {
            EXPECT_EQ(far, near - 1) << z;
        }
    }
}

TEST(Precision, OddDistancesGiveTheFinestOrTheCoarsestLevel) {
    const ScreenError error = screen(0.5, 1080);
    for (const double z : {0.0, -1.0, -kInfinity, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_EQ(level_at(error, z, 1, 25), 25u);
    }
    EXPECT_EQ(level_at(error, kInfinity, 1, 25), 1u);
    EXPECT_EQ(level_at(error, 1e-300, 1, 25), 25u);
    EXPECT_EQ(level_at(screen(0, 1080), 10, 1, 25), 25u);
    EXPECT_EQ(level_at(error, 1e300, 1, 1), 1u);
}

TEST(Precision, TheIntegerRuleIsTheFormulaWithinTheRoundingOfItsUnit) {
    const ScreenError error = screen(0.5, 1080, 1.1547, 1);
    const DropRule rule = drop_rule(error, 1, 24);
    std::mt19937_64 random(3);
    int differ = 0;
    for (int i = 0; i < 100000; ++i) {
        const auto distance = static_cast<uint32_t>(random() >> 33);
        const uint32_t formula = std::min(24u, 30 - level_at(error, distance, 1, 30));
        const uint32_t dropped = rule.dropped_at(distance);
        ASSERT_LE(dropped, formula);
        differ += dropped != formula ? 1 : 0;
        ASSERT_LE(formula - dropped, 1u);
    }
    EXPECT_LT(differ, 200);
}

TEST(Precision, RulesOfOddScreensDropNothingOrAllThatMayBeDropped) {
    EXPECT_EQ(drop_rule(screen(0, 1080), 1, 12).dropped_at(0xffffffffu - 1), 0u);
    EXPECT_EQ(drop_rule(screen(kInfinity, 1080), 1, 12).dropped_at(1u << 12), 12u);
    EXPECT_EQ(drop_rule(screen(std::numeric_limits<double>::quiet_NaN(), 1080), 1, 12).dropped_at(1u << 30), 0u);
}

TEST(Precision, DistanceBoundIsBelowTheDistanceByAtMostATwentieth) {
    std::mt19937_64 random(4);
    std::normal_distribution<double> normal;
    for (int i = 0; i < 300000; ++i) {
        const double scale = std::ldexp(1.0, 10 + i % 19);
        std::array<uint32_t, 3> gaps{};
        double square = 0;
        for (uint32_t& gap : gaps) {
            gap = static_cast<uint32_t>(std::min(0x7fffffffp0, std::fabs(normal(random)) * scale));
            square += double{static_cast<double>(gap)} * gap;
        }
        const double bound = distance_bound(gaps);
        ASSERT_LE(bound, std::sqrt(square));
        ASSERT_GE(bound, 0.95 * std::sqrt(square) - 3 * 256);
    }
    EXPECT_EQ(distance_bound({0x7fffffff, 0x7fffffff, 0x7fffffff}), 441u * 0x7fffffu);
}

TEST(Precision, DistanceBoundNeverFallsWhenAGapGrows) {
    std::mt19937_64 random(5);
    for (int i = 0; i < 100000; ++i) {
        std::array<uint32_t, 3> gaps{};
        for (uint32_t& gap : gaps) gap = static_cast<uint32_t>(random() >> 33) >> (random() % 20);
        std::array<uint32_t, 3> further = gaps;
        further[random() % 3] += static_cast<uint32_t>(random() % 100000);
        for (uint32_t& gap : further) gap = std::min(gap, 0x7fffffffu);
        ASSERT_LE(distance_bound(gaps), distance_bound(further));
    }
}

TEST(Precision, EveryReadingKeepsItsBoundAndThirdsKeepMultiplesExactly) {
    std::mt19937_64 random(6);
    constexpr uint32_t kCommon = 14;
    for (const Reconstruction reading : {Reconstruction::kLow, Reconstruction::kMiddle, Reconstruction::kThirds}) {
        std::vector<GridPoint> points;
        for (int i = 0; i < 2000; ++i) {
            GridPoint point{};
            for (int32_t& x : point) x = static_cast<int32_t>(random() % 3000000) - 1700000;
            points.push_back(point);
        }
        const PrecisionGrid grid = grid_of(points, kCommon, reading);
        for (uint32_t s = 0; s <= kCommon; ++s) {
            const double step = std::ldexp(1.0, static_cast<int>(s));
            const double bound = s == 0                               ? 0
                                 : reading == Reconstruction::kLow    ? step - 1
                                 : reading == Reconstruction::kMiddle ? step / 2
                                                                      : 2 * step / 3;
            for (const GridPoint& point : points) {
                const GridPoint read = grid.point_of(grid.words_of(point), s);
                for (size_t c = 0; c < 3; ++c) {
                    ASSERT_LE(std::abs(read[c] - point[c]), bound) << s;
                    if (reading == Reconstruction::kLow) {
                        ASSERT_LE(read[c], point[c]);
                    }
                    if (reading == Reconstruction::kThirds && (point[c] & ((1 << s) - 1)) == 0) {
                        ASSERT_EQ(read[c], point[c]);
                    }
                }
            }
        }
    }
}

TEST(Precision, ThirdsKeepTileBordersAndGroundAtEveryLevel) {
    const GridPoint corner = {1 << 14, -(3 << 14), 0};
    const PrecisionGrid grid =
        grid_of(std::vector<GridPoint>{corner, {1 << 20, 5, 77777}}, 14, Reconstruction::kThirds);
    for (uint32_t s = 0; s <= 14; ++s) EXPECT_EQ(grid.point_of(grid.words_of(corner), s), corner) << s;
}

TEST(Precision, GridsOfNoExtentFarAwayAndOfNothingHoldTheirPoints) {
    for (const uint32_t common : {0u, 12u, 29u}) {
        const GridPoint far = {-(1 << 30) + 1, (1 << 30) - 1, 12345678};
        const PrecisionGrid grid = grid_of(std::vector<GridPoint>{far}, common, Reconstruction::kMiddle);
        EXPECT_EQ(grid.point_of(grid.words_of(far), 0), far);
        EXPECT_EQ(grid.full_bits(), common + 1);
    }
    EXPECT_EQ(grid_of({}, 3, Reconstruction::kThirds).full_bits(), 4u);
}

/// The angle that a displacement takes, in pixels, of a camera that looks along `forward`.
double pixels_moved(const ScreenError& error, const std::array<double, 3>& from, const std::array<double, 3>& to) {
    const double focal = error.view_pixels * error.near_distance / error.near_length;
    return focal * std::hypot(from[0] / from[2] - to[0] / to[2], from[1] / from[2] - to[1] / to[2]);
}

/// Greatest projected displacement of points that a camera nears, and the most bits they drop.
struct Dolly {
    double worst = 0;
    uint32_t least = 99, most = 0;
};

Dolly dolly(Reconstruction reading) {
    // 60 degrees across both ways: the picture's corner is 39.2 degrees off the axis.
    const ScreenError error = screen(0.5, 1080, 2 * std::tan(M_PI / 6), 1);
    const double cosine = 1 / std::sqrt(1 + 2 * std::tan(M_PI / 6) * std::tan(M_PI / 6));
    const DropRule rule = drop_rule(error, cosine, 16, reading);
    std::mt19937_64 random(7);
    std::vector<GridPoint> points;
    for (int i = 0; i < 3000; ++i) {
        GridPoint point{};
        for (int32_t& x : point) x = static_cast<int32_t>(random() % 200000) - 100000;
        points.push_back(point);
    }
    const PrecisionGrid grid = grid_of(points, 16, reading);
    Dolly result;
    for (double height = 130000; height < 4e8; height *= 1.3) {
        const auto camera_z = static_cast<int32_t>(height);
        const std::array<int32_t, 3> from_camera = {grid.origin[0], grid.origin[1], grid.origin[2] + camera_z};
        for (const GridPoint& point : points) {
            const auto words = grid.words_of(point);
            const uint32_t dropped = dropped_in_box(rule, from_camera, words, words);
            result.least = std::min(result.least, dropped);
            result.most = std::max(result.most, dropped);
            const auto place = [&](const GridPoint& p) -> std::array<double, 3> {
                return {double{static_cast<double>(p[0])}, double{static_cast<double>(p[1])}, p[2] + height};
            };
            const auto exact = place(point);
            if (std::max(std::fabs(exact[0]), std::fabs(exact[1])) > exact[2] * std::tan(M_PI / 6)) continue;
            result.worst = std::max(result.worst, pixels_moved(error, exact, place(grid.point_of(words, dropped))));
        }
    }
    return result;
}

TEST(Precision, ProjectedDisplacementStaysBelowRootThreeTimesTheErrorAlongADollyForEveryReading) {
    for (const Reconstruction reading : {Reconstruction::kLow, Reconstruction::kMiddle, Reconstruction::kThirds}) {
        const Dolly result = dolly(reading);
        EXPECT_LE(result.worst, 0.5 * std::sqrt(3.0));
        EXPECT_GT(result.worst, 0.2);  // bits are not wasted
        EXPECT_LE(result.least, 6u);
        EXPECT_EQ(result.most, 16u);
    }
}

TEST(Precision, ReadingInTheMiddleDropsOneBitMoreAtTheSameGreatestError) {
    const ScreenError error = screen(0.5, 1000);
    const DropRule low = drop_rule(error, 1, 20), middle = drop_rule(error, 1, 20, Reconstruction::kMiddle);
    for (uint32_t distance = 2000; distance < 1000000000; distance += distance / 7) {
        EXPECT_EQ(middle.dropped_at(distance), low.dropped_at(distance) + 1) << distance;
    }
}

TEST(Precision, EveryVertexOfABoxDropsAtLeastWhatTheBoxDrops) {
    std::mt19937_64 random(8);
    for (int i = 0; i < 2000; ++i) {
        const DropRule rule{static_cast<uint32_t>(1 + random() % 3000), static_cast<uint32_t>(random() % 20)};
        std::array<uint32_t, 3> low{}, high{};
        std::array<int32_t, 3> from_camera{};
        for (size_t c = 0; c < 3; ++c) {
            low[c] = static_cast<uint32_t>(random() % 1000000);
            high[c] = low[c] + static_cast<uint32_t>(random() % 1000000);
            from_camera[c] = static_cast<int32_t>(random() % 20000000) - 10000000;
        }
        const uint32_t box = dropped_in_box(rule, from_camera, low, high);
        for (int v = 0; v < 100; ++v) {
            std::array<uint32_t, 3> words{};
            for (size_t c = 0; c < 3; ++c) words[c] = low[c] + static_cast<uint32_t>(random() % (high[c] - low[c] + 1));
            ASSERT_GE(dropped_in_box(rule, from_camera, words, words), box);
            // The bits below the common prefix do not matter: the rule is the same whatever a buffer has dropped.
            std::array<uint32_t, 3> cut = words;
            for (uint32_t& w : cut) w = w >> rule.common_dropped << rule.common_dropped;
            ASSERT_EQ(dropped_in_box(rule, from_camera, cut, cut), dropped_in_box(rule, from_camera, words, words));
        }
    }
}

TEST(Precision, TheDistanceToAVertexIsNeverTakenForMoreThanItIs) {
    std::mt19937_64 random(9);
    for (int i = 0; i < 100000; ++i) {
        std::array<int32_t, 3> from_camera{};
        std::array<uint32_t, 3> words{};
        double square = 0;
        for (size_t c = 0; c < 3; ++c) {
            words[c] = static_cast<uint32_t>(random() % 4000000);
            const int32_t range = 1 << (4 + random() % 20);
            from_camera[c] = static_cast<int32_t>(random() % static_cast<uint64_t>(2 * range)) - range -
                             static_cast<int32_t>(words[c]);
            // Of the cell of two units to the camera, anywhere in its unit cell.
            const int32_t low = from_camera[c] + static_cast<int32_t>(words[c] & ~1u);
            const double gap = low > 0 ? low - 1 : low + 1 < 0 ? -(low + 1) : 0;
            square += gap * gap;
        }
        const double distance = std::sqrt(square);
        // A bit is dropped from twice the rule's unit on.
        const DropRule above{static_cast<uint32_t>(distance / 2) + 1, 1};
        ASSERT_EQ(dropped_in_box(above, from_camera, words, words), 0u) << distance;
        const double surely = 0.95 * distance - 3 * 256;
        if (surely < 2) continue;
        const DropRule below{static_cast<uint32_t>(surely / 2), 1};
        ASSERT_EQ(dropped_in_box(below, from_camera, words, words), 1u) << distance;
    }
}

TEST(Precision, ACameraInsideTheBoxSeesAllBits) {
    const DropRule rule{100, 12};
    EXPECT_EQ(dropped_in_box(rule, {-500000, -500000, -500000}, {0, 0, 0}, {1000000, 1000000, 1000000}), 0u);
}

TEST(Precision, ACameraThatTremblesAtAThresholdChangesALevelOnce) {
    const DropRule rule{1000, 12};
    uint32_t resident = 0;
    int changes = 0;
    for (int i = 0; i < 1000; ++i) {
        // Around 8,192,000 units, where the 13th bit goes.
        const int32_t distance = 8192000 / 4 + (i % 2 == 0 ? 40000 : -40000);
        const uint32_t next = settled_dropped(rule, resident, {distance, 0, 0}, {0, 0, 0}, {10, 10, 10});
        changes += next != resident ? 1 : 0;
        resident = next;
        ASSERT_LE(resident, dropped_in_box(rule, {distance, 0, 0}, {0, 0, 0}, {10, 10, 10}));
    }
    EXPECT_LE(changes, 1);
}

}  // namespace
}  // namespace citystream::codec::mesh
