// The ray caster against a walk over single texels that knows nothing of runs, and its corner cases one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "codec/facade/facade_ray.h"

namespace citystream::codec::facade {
namespace {

bool is_open(const FacadeMatrices& image, int x, int y) {
    return image.displacement_mm[static_cast<size_t>(y) * image.width + static_cast<size_t>(x)] == kOpenDisplacement;
}

double depth_at(const FacadeMatrices& image, int x, int y) {
    return image.displacement_mm[static_cast<size_t>(y) * image.width + static_cast<size_t>(x)];
}

/// First t at which the ray is in solid, by looking at the middle and both ends of every piece between texel borders.
/// The relief is a union of boxes, so the first contact is the least entry time into any box: exact, O(texels).
double brute_force_t(const FacadeMatrices& image, const double origin[3], const double direction[3]) {
    double best = std::numeric_limits<double>::infinity();
    const double floor_w = make_run_grid(image)->depths().min_mm;
    for (int y = 0; y < static_cast<int>(image.height); ++y) {
        for (int x = 0; x < static_cast<int>(image.width); ++x) {
            if (is_open(image, x, y)) continue;
            const double low[3] = {double(x), double(y), floor_w};
            const double high[3] = {x + 1.0, y + 1.0, depth_at(image, x, y)};
            double enter = 0;
            double leave = std::numeric_limits<double>::infinity();
            for (int a = 0; a < 3; ++a) {
                if (direction[a] == 0) {
                    if (origin[a] < low[a] || origin[a] > high[a]) leave = -1;
                    continue;
                }
                const double t0 = (low[a] - origin[a]) / direction[a];
                const double t1 = (high[a] - origin[a]) / direction[a];
                enter = std::max(enter, std::min(t0, t1));
                leave = std::min(leave, std::max(t0, t1));
            }
            if (enter <= leave) best = std::min(best, enter);
        }
    }
    return best;
}

FacadeMatrices random_image(std::mt19937& random, uint32_t width, uint32_t height) {
    FacadeMatrices image{width, height, std::vector<int16_t>(size_t{width} * height, 0),
                         std::vector<uint16_t>(size_t{width} * height, 0)};
    for (int box = 0; box < 6; ++box) {
        const auto x0 = static_cast<uint32_t>(random() % width);
        const auto y0 = static_cast<uint32_t>(random() % height);
        // One box in nine is an opening.
        const auto level = static_cast<int>(random() % 9);
        const auto depth = static_cast<int16_t>(level == 8 ? kOpenDisplacement : level * 50 - 200);
        for (uint32_t y = y0; y < std::min<uint32_t>(height, y0 + 1 + static_cast<uint32_t>(random() % 9)); ++y) {
            for (uint32_t x = x0; x < std::min<uint32_t>(width, x0 + 1 + static_cast<uint32_t>(random() % 9)); ++x) {
                image.displacement_mm[size_t{y} * width + x] = depth;
                image.material[size_t{y} * width + x] = static_cast<uint16_t>(box + 1);
            }
        }
    }
    return image;
}

TEST(FacadeRay, AgreesWithTexelByTexelSearchOnRandomMaps) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0, 1);
    int hits = 0;
    int misses = 0;
    for (int round = 0; round < 60; ++round) {
        const FacadeMatrices image =
            random_image(random, 1 + static_cast<uint32_t>(random() % 24), 1 + static_cast<uint32_t>(random() % 24));
        const RunGrid grid = *make_run_grid(image);
        for (int ray = 0; ray < 300; ++ray) {
            // From in front or from the side, towards somewhere on the wall; one in three nearly along it.
            const double flat = ray % 3 == 0 ? 0.01 : 1;
            const double target[3] = {unit(random) * image.width, unit(random) * image.height,
                                      unit(random) * 400 - 200};
            const double origin[3] = {(unit(random) * 3 - 1) * image.width, (unit(random) * 3 - 1) * image.height,
                                      201 + unit(random) * 500 * flat};
            double direction[3];
            for (int a = 0; a < 3; ++a) direction[a] = target[a] - origin[a];
            const double expected = brute_force_t(image, origin, direction);
            const FacadeRayHit hit = cast_facade_ray(grid, origin, direction);
            ASSERT_EQ(hit.hit, std::isfinite(expected)) << "round " << round << " ray " << ray;
            ++(hit.hit ? hits : misses);
            if (!hit.hit) continue;
            ASSERT_NEAR(hit.t, expected, 1e-9 * (1 + expected)) << "round " << round << " ray " << ray;
            // Half a step into the solid lies a texel with the label's displacement and material.
            double inside[3];
            for (int a = 0; a < 3; ++a) inside[a] = origin[a] + hit.t * direction[a];
            inside[hit.normal_axis] -= 1e-6 * hit.normal_sign;
            const int x = std::clamp(static_cast<int>(std::floor(inside[0])), 0, static_cast<int>(image.width) - 1);
            const int y = std::clamp(static_cast<int>(std::floor(inside[1])), 0, static_cast<int>(image.height) - 1);
            EXPECT_EQ(static_cast<int16_t>(hit.label & 0xffffu), depth_at(image, x, y));
            EXPECT_EQ(hit.label >> 16, image.material[static_cast<size_t>(y) * image.width + static_cast<size_t>(x)]);
            EXPECT_LE(direction[hit.normal_axis] * hit.normal_sign, 0) << "the normal faces the ray";
        }
    }
    EXPECT_GT(hits, 5000);
    EXPECT_GT(misses, 200);
}

/// A wall of 10 x 10 texels at 0 mm with a recess of 4 x 4 at -100 mm in [3, 7)^2 (slot 1).
class RecessRay : public ::testing::Test {
  protected:
    RecessRay() {
        FacadeMatrices image{10, 10, std::vector<int16_t>(100, 0), std::vector<uint16_t>(100, 0)};
        for (uint32_t y = 3; y < 7; ++y) {
            for (uint32_t x = 3; x < 7; ++x) {
                image.displacement_mm[y * 10 + x] = -100;
                image.material[y * 10 + x] = 1;
            }
        }
        grid_ = *make_run_grid(image);
    }

    FacadeRayHit cast(double u, double v, double w, double du, double dv, double dw) const {
        const double origin[3] = {u, v, w};
        const double direction[3] = {du, dv, dw};
        return cast_facade_ray(grid_, origin, direction);
    }

    RunGrid grid_;
};

TEST_F(RecessRay, HitsTheFrontStraightOn) {
    const FacadeRayHit hit = cast(1, 1, 50, 0, 0, -1);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.t, 50.0);
    EXPECT_EQ(hit.label, 0u);
    EXPECT_EQ(hit.normal_axis, 2);
    EXPECT_EQ(hit.normal_sign, 1);
}

TEST_F(RecessRay, HitsTheBottomOfTheRecess) {
    const FacadeRayHit hit = cast(5, 5, 50, 0, 0, -2);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.t, 75.0);
    EXPECT_EQ(hit.label, 0xff9cu | 1u << 16);
}

TEST_F(RecessRay, HitsTheRevealWithTheLabelOfTheHigherCell) {
    const FacadeRayHit hit = cast(4, 5, 20, 1, 0, -20);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.t, 3.0);
    EXPECT_EQ(hit.label, 0u);
    EXPECT_EQ(hit.normal_axis, 0);
    EXPECT_EQ(hit.normal_sign, -1);
}

TEST_F(RecessRay, EdgesOfTheFacadeAreSidesBelowTheReliefAndOpenAboveIt) {
    FacadeRayHit hit = cast(-5, 1, -50, 1, 0, 0);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.t, 5.0);
    EXPECT_EQ(hit.normal_axis, 0);
    EXPECT_EQ(hit.normal_sign, -1);
    hit = cast(5, 15, -50, 0, -1, 0);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.normal_axis, 1);
    EXPECT_EQ(hit.normal_sign, 1);
    EXPECT_FALSE(cast(-5, 1, 1, 1, 0, 0).hit) << "above the volume";
    EXPECT_FALSE(cast(-5, 1, 0, 1, 0, 0).hit) << "along the front, touching it only";
    EXPECT_FALSE(cast(11, 1, 50, 0, 0, -1).hit) << "beside the facade";
}

TEST_F(RecessRay, RaysInsideTheRecessLeaveOrHit) {
    EXPECT_FALSE(cast(5, 5, -50, 0, 0, 1).hit) << "outwards";
    EXPECT_FALSE(cast(5, 5, -100, 0, 0, 1).hit) << "a shadow ray from the bottom";
    const FacadeRayHit hit = cast(5, 5, -50, 0, -1, 0);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.t, 2.0);
    EXPECT_EQ(hit.normal_axis, 1);
    EXPECT_EQ(hit.normal_sign, 1);
}

TEST_F(RecessRay, StartsInTheSolidAndFromBehindAreHitsAtOnce) {
    FacadeRayHit hit = cast(1, 1, -50, 1, 0, 0);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.t, 0.0);
    hit = cast(5, 5, -300, 0, 0, 1);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.t, 200.0);
    EXPECT_EQ(hit.normal_sign, -1);
}

TEST_F(RecessRay, CornersBreaksAndAwkwardNumbersTerminate) {
    // Exactly through the corner (3, 3) of the recess, and along its borders.
    EXPECT_TRUE(cast(0, 0, 30, 1, 1, -10).hit);
    const FacadeRayHit hit = cast(3, 0, -50, 0, 1, 0);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.t, 0.0);
    EXPECT_TRUE(cast(7, 5, 50, 0, 0, -1).hit);
    EXPECT_TRUE(cast(10, 10, 50, 0, 0, -1).hit) << "the far corner belongs to the facade";
    EXPECT_TRUE(cast(0, 0, 50, 0, 0, -1).hit);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double inf = std::numeric_limits<double>::infinity();
    EXPECT_FALSE(cast(nan, 0, 50, 0, 0, -1).hit);
    EXPECT_FALSE(cast(0, 0, 50, 0, inf, -1).hit);
    EXPECT_FALSE(cast(0, 0, 50, 0, 0, 0).hit);
    EXPECT_FALSE(cast(-1, 0, 50, 5e-324, 0, 0).hit);
    EXPECT_FALSE(cast(-1, 5, -10, 5e-324, 0, 0).hit) << "it would take infinitely long";
    EXPECT_TRUE(cast(-1e300, 5, -50, 1e300, 0, 0).hit);
}

TEST(FacadeRay, GrazingRaysOverManyRibsTerminateAtTheFirstHigherOne) {
    FacadeMatrices image{2000, 1, std::vector<int16_t>(2000, 0), std::vector<uint16_t>(2000, 0)};
    for (size_t x = 0; x < 2000; x += 2) image.displacement_mm[x] = 1;
    image.displacement_mm[1998] = 3;
    const RunGrid grid = *make_run_grid(image);
    const double origin[3] = {0, 0.5, 2.9};
    const double direction[3] = {1, 0, -0.0005};  // 89.97 degrees
    const FacadeRayHit hit = cast_facade_ray(grid, origin, direction);
    ASSERT_TRUE(hit.hit);
    EXPECT_DOUBLE_EQ(hit.t, 1998.0);
    EXPECT_EQ(hit.label, 3u);
    EXPECT_EQ(hit.normal_axis, 0);
}

/// A wall of 10 x 10 texels at 0 mm with an opening of 4 x 4 in [3, 7)^2 and a sill at -200 mm below it.
class OpeningRay : public ::testing::Test {
  protected:
    OpeningRay() {
        FacadeMatrices image{10, 10, std::vector<int16_t>(100, 0), std::vector<uint16_t>(100, 0)};
        for (uint32_t y = 2; y < 7; ++y) {
            for (uint32_t x = 3; x < 7; ++x)
                image.displacement_mm[y * 10 + x] = static_cast<int16_t>(y == 2 ? -200 : kOpenDisplacement);
        }
        grid_ = *make_run_grid(image);
    }

    FacadeRayHit cast(double u, double v, double w, double du, double dv, double dw) const {
        const double origin[3] = {u, v, w};
        const double direction[3] = {du, dv, dw};
        return cast_facade_ray(grid_, origin, direction);
    }

    RunGrid grid_;
};

TEST_F(OpeningRay, GoesThroughFromBothSides) {
    EXPECT_FALSE(cast(5, 5, 50, 0, 0, -1).hit);
    EXPECT_FALSE(cast(5, 5, -500, 0, 0, 1).hit);
    EXPECT_TRUE(cast(1, 5, -500, 0, 0, 1).hit) << "the back of the wall beside it";
}

TEST_F(OpeningRay, MeetsTheRevealAndTheSill) {
    FacadeRayHit hit = cast(4, 5, 20, 1, 0, -20);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(hit.t, 3.0);
    EXPECT_EQ(hit.normal_axis, 0);
    hit = cast(5, 5, -250, 0, -1, 30);
    EXPECT_TRUE(hit.hit) << "in through the back, above the sill, against the wall below";
    EXPECT_EQ(hit.t, 3.0);
    EXPECT_EQ(hit.normal_axis, 1);
    EXPECT_EQ(displacement_of(hit.label), 0);
    hit = cast(5, 4, -100, 0, -1, -90);
    EXPECT_TRUE(hit.hit);
    EXPECT_EQ(displacement_of(hit.label), -200) << "down on the sill";
}

TEST_F(OpeningRay, LeavesThroughTheBackBeforeItsSides) {
    // Reaches the opening's side at w = -260, below depth_min: it has left.
    EXPECT_FALSE(cast(5, 5, -100, 2, 0, -160).hit);
    EXPECT_TRUE(cast(5, 5, -100, 2, 0, -90).hit);
}

TEST(FacadeRay, WallsOfAirOnlyAreNeverHit) {
    const FacadeMatrices image{4, 3, std::vector<int16_t>(12, kOpenDisplacement), std::vector<uint16_t>(12, 0)};
    const RunGrid grid = *make_run_grid(image);
    const double origin[3] = {2, 1, 10}, direction[3] = {0.1, 0.1, -1}, back[3] = {0, 0.2, 1}, behind[3] = {1, 1, -9};
    EXPECT_FALSE(cast_facade_ray(grid, origin, direction).hit);
    EXPECT_FALSE(cast_facade_ray(grid, behind, back).hit);
}

}  // namespace
}  // namespace citystream::codec::facade
