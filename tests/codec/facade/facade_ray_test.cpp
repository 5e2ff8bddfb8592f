// The ray caster against a walk over single texels that knows nothing of runs, and its corner cases one by one.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "codec/facade/facade_map.h"

namespace citystream::codec::facade {
namespace {

double depth_at(const FacadeImage& image, int x, int y) {
    return image.displacement_mm[static_cast<size_t>(y) * image.width + static_cast<size_t>(x)];
}

/// First t at which the ray is in solid, by looking at the middle and both ends of every piece between texel borders.
/// The relief is a union of boxes, so the first contact is the least entry time into any box: exact, O(texels).
double brute_force_t(const FacadeImage& image, const double origin[3], const double direction[3]) {
    double best = std::numeric_limits<double>::infinity();
    const double floor_w = *std::min_element(image.displacement_mm.begin(), image.displacement_mm.end());
    for (int y = 0; y < static_cast<int>(image.height); ++y) {
        for (int x = 0; x < static_cast<int>(image.width); ++x) {
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

FacadeImage random_image(std::mt19937& random, uint32_t width, uint32_t height) {
    FacadeImage image{width, height, std::vector<int16_t>(size_t{width} * height, 0),
                      std::vector<uint8_t>(size_t{width} * height, 0)};
    for (int box = 0; box < 6; ++box) {
        const auto x0 = static_cast<uint32_t>(random() % width);
        const auto y0 = static_cast<uint32_t>(random() % height);
        const auto depth = static_cast<int16_t>(static_cast<int>(random() % 9) * 50 - 200);
        for (uint32_t y = y0; y < std::min<uint32_t>(height, y0 + 1 + static_cast<uint32_t>(random() % 9)); ++y) {
            for (uint32_t x = x0; x < std::min<uint32_t>(width, x0 + 1 + static_cast<uint32_t>(random() % 9)); ++x) {
                image.displacement_mm[size_t{y} * width + x] = depth;
                image.material[size_t{y} * width + x] = static_cast<uint8_t>(box + 1);
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
        const FacadeImage image =
            random_image(random, 1 + static_cast<uint32_t>(random() % 24), 1 + static_cast<uint32_t>(random() % 24));
        const auto words = encode_facade_map(image);
        ASSERT_TRUE(words.ok());
        const auto map = FacadeMapView::create(*words);
        ASSERT_TRUE(map.ok());
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
            const FacadeRayHit hit = cast_facade_ray(*map, origin, direction);
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
        FacadeImage image{10, 10, std::vector<int16_t>(100, 0), std::vector<uint8_t>(100, 0)};
        for (uint32_t y = 3; y < 7; ++y) {
            for (uint32_t x = 3; x < 7; ++x) {
                image.displacement_mm[y * 10 + x] = -100;
                image.material[y * 10 + x] = 1;
            }
        }
        words_ = *encode_facade_map(image);
    }

    FacadeRayHit cast(double u, double v, double w, double du, double dv, double dw) const {
        const double origin[3] = {u, v, w};
        const double direction[3] = {du, dv, dw};
        return cast_facade_ray(*FacadeMapView::create(words_), origin, direction);
    }

    std::vector<uint32_t> words_;
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
    FacadeImage image{2000, 1, std::vector<int16_t>(2000, 0), std::vector<uint8_t>(2000, 0)};
    for (size_t x = 0; x < 2000; x += 2) image.displacement_mm[x] = 1;
    image.displacement_mm[1998] = 3;
    const auto words = encode_facade_map(image);
    ASSERT_TRUE(words.ok());
    const auto map = FacadeMapView::create(*words);
    ASSERT_TRUE(map.ok());
    const double origin[3] = {0, 0.5, 2.9};
    const double direction[3] = {1, 0, -0.0005};  // 89.97 degrees
    const FacadeRayHit hit = cast_facade_ray(*map, origin, direction);
    ASSERT_TRUE(hit.hit);
    EXPECT_DOUBLE_EQ(hit.t, 1998.0);
    EXPECT_EQ(hit.label, 3u);
    EXPECT_EQ(hit.normal_axis, 0);
}

}  // namespace
}  // namespace citystream::codec::facade
