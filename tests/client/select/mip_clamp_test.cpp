#include "client/select/mip_clamp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/select/selection.h"

namespace citystream::client {
namespace {

using tiles::tileset::StepRecord;

std::vector<StepRecord> steps_of(const std::vector<float>& errors) {
    std::vector<StepRecord> steps(errors.size());
    for (size_t i = 0; i < errors.size(); ++i) steps[i].error = errors[i];
    return steps;
}

/// The finest mip of the shortest prefix whose texels are small enough.
double resident_mip(const std::vector<StepRecord>& steps, double texel) {
    const auto count = static_cast<uint32_t>(steps.size());
    return count - shortest_prefix(steps, count, 1, texel);
}

TEST(MipClamp, IsTheLogarithmOfTheTexelWhereErrorsDouble) {
    const auto steps = steps_of({0.8F, 0.4F, 0.2F, 0.1F});
    for (double texel = 0.03; texel < 100; texel *= 1.01) {
        const double wanted = std::clamp(std::log2(texel / 0.1), 0.0, 16.0);
        EXPECT_NEAR(clamped_mip(steps, texel), wanted, 1e-5) << texel;
        EXPECT_NEAR(clamped_mip(0.1, texel), wanted, 1e-5) << texel;
    }
}

TEST(MipClamp, IsContinuousAndAStepArrivesWhenItReachesItsMip) {
    for (const auto& errors :
         {std::vector<float>{0.8F, 0.4F, 0.2F, 0.1F}, {5, 5, 2, 1, 1, 1}, {3, 2, 2, 2, 0.7F}, {1}}) {
        const auto steps = steps_of(errors);
        double before = clamped_mip(steps, 64), resident = resident_mip(steps, 64);
        for (double texel = 64; texel > 0.01; texel /= 1.001) {
            const double now = clamped_mip(steps, texel), held = resident_mip(steps, texel);
            ASSERT_LE(now, before + 1e-6);
            // The steepest piece crosses a plateau of three mips while the error grows by half.
            ASSERT_LE(before - now, 0.01) << texel;
            if (texel >= errors.back()) {
                ASSERT_GE(now, held - 1e-5) << "no finer mip than there is is asked for at " << texel;
            }
            if (held < resident) {
                ASSERT_NEAR(now, resident, 0.01) << "the step is not seen to arrive at " << texel;
            }
            before = now;
            resident = held;
        }
        EXPECT_EQ(clamped_mip(steps, 1e-6), 0) << "in the end all of it is shown";
    }
}

TEST(MipClamp, SaysNothingOfAtlasesWithoutErrors) {
    EXPECT_EQ(clamped_mip(std::vector<StepRecord>{}, 1), 0);
    EXPECT_EQ(clamped_mip(steps_of({0}), 1), 0);
    EXPECT_EQ(clamped_mip(0.0, 1), 0);
    EXPECT_EQ(clamped_mip(steps_of({1e-30F}), 1e30), 16);
}

}  // namespace
}  // namespace citystream::client
