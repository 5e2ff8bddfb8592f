#include "codec/mesh/position_error.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "codec/grid.h"
#include "codec/mesh/precision.h"

namespace citystream::codec::mesh {
namespace {

TEST(PositionError, BoundsWhatReadingByThirdsMovesAPointAndIsReached) {
    for (uint32_t dropped = 0; dropped <= 10; ++dropped) {
        int32_t worst = 0;
        for (int32_t word = 0; word < 1 << 12; ++word) {
            const int32_t known = word >> dropped << dropped;
            const auto read = known + static_cast<int32_t>(reading_offset(Reconstruction::kThirds, dropped));
            worst = std::max(worst, std::abs(read - word));
        }
        EXPECT_DOUBLE_EQ(std::sqrt(3.0) * worst / kGridUnitsPerMetre, position_error(dropped)) << dropped;
    }
}

TEST(PositionError, NothingDroppedIsTheErrorOfTheGeometry) {
    EXPECT_EQ(0, position_error(0));
    EXPECT_EQ(0.25f, step_error(0.25f, 0));
}

TEST(PositionError, TheLastStepDropsWhatLiesFarBelowTheErrorOfTheGeometry) {
    EXPECT_EQ(0u, finest_dropped(0));
    EXPECT_EQ(0u, finest_dropped(15.0f / 1024));
    EXPECT_EQ(1u, finest_dropped(16.0f / 1024));
    EXPECT_EQ(6u, finest_dropped(0.5f));
    EXPECT_EQ(kMeshGridBits, finest_dropped(1e9f));
    EXPECT_EQ(kMeshGridBits, finest_dropped(std::numeric_limits<float>::infinity()));
    EXPECT_EQ(0u, finest_dropped(std::numeric_limits<float>::quiet_NaN()));
    EXPECT_EQ(0u, finest_dropped(-1));
}

TEST(PositionError, DroppedBitsFollowFromTheErrorsOfAllSteps) {
    for (float error = 0; error < 600; error = error * 1.07f + 0.003f) {
        const uint32_t finest = finest_dropped(error);
        for (uint32_t steps = 2; steps <= kMostMeshSteps; ++steps) {
            const uint32_t coarsest = finest + kMeshStepBits * (steps - 1);
            if (coarsest > kMeshGridBits) continue;
            std::vector<float> errors;
            for (uint32_t s = 0; s < steps; ++s) errors.push_back(step_error(error, coarsest - kMeshStepBits * s));
            const auto dropped = dropped_of_steps(errors);
            for (uint32_t s = 0; s < kMostMeshSteps; ++s) {
                EXPECT_EQ(coarsest - kMeshStepBits * std::min(s, steps - 1), dropped[s]) << error << " step " << s;
            }
        }
    }
}

TEST(PositionError, AnyNumbersGiveBitsInRangeThatNeverRise) {
    const float infinity = std::numeric_limits<float>::infinity();
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<std::vector<float>> all = {{},
                                                 {1},
                                                 {infinity, 0},
                                                 {nan, 1},
                                                 {0, 1, 2},
                                                 {-1, -2, -3},
                                                 {1e30f, 1e20f, 1, 0},
                                                 {3, nan, nan},
                                                 {9, 8, 7, 6, 5, 4, 3}};
    for (const std::vector<float>& errors : all) {
        const auto dropped = dropped_of_steps(errors);
        EXPECT_LE(dropped[0], kMeshGridBits);
        for (size_t s = 1; s < dropped.size(); ++s) EXPECT_LE(dropped[s], dropped[s - 1]);
        if (errors.size() < 2) {
            EXPECT_EQ(0u, dropped[0]);
        }
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
