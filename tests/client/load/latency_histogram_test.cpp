#include "client/load/latency_histogram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace citystream::client {
namespace {

using std::chrono::nanoseconds;

TEST(LatencyHistogram, IsEmptyAtFirst) {
    const LatencyHistogram histogram;
    EXPECT_EQ(histogram.count(), 0u);
    EXPECT_EQ(histogram.percentile(50).count(), 0);
    EXPECT_EQ(histogram.mean().count(), 0);
}

TEST(LatencyHistogram, KeepsEveryPercentileWithinOnePercent) {
    std::mt19937_64 random(7);
    for (const double spread : {0.2, 1.0, 3.0}) {
        std::lognormal_distribution<double> distribution(std::log(2e6), spread);
        LatencyHistogram histogram;
        std::vector<int64_t> values;
        for (int i = 0; i < 100'000; ++i) {
            values.push_back(static_cast<int64_t>(distribution(random)));
            histogram.record(nanoseconds(values.back()));
        }
        std::sort(values.begin(), values.end());
        for (const double percent : {0.1, 1.0, 10.0, 50.0, 90.0, 99.0, 99.9, 99.99}) {
            const auto rank = static_cast<size_t>(std::ceil(percent / 100 * static_cast<double>(values.size())));
            const auto exact = static_cast<double>(values[rank - 1]);
            EXPECT_NEAR(static_cast<double>(histogram.percentile(percent).count()), exact, 0.01 * exact)
                << percent << " % at spread " << spread;
        }
        EXPECT_EQ(histogram.percentile(100), histogram.max());
    }
}

TEST(LatencyHistogram, IsExactForSmallValuesAndForTheMaximum) {
    LatencyHistogram histogram;
    for (int i = 1; i <= 100; ++i) histogram.record(nanoseconds(i));
    EXPECT_EQ(histogram.percentile(50).count(), 50);
    EXPECT_EQ(histogram.percentile(99).count(), 99);
    EXPECT_EQ(histogram.mean().count(), 51);
    histogram.record(nanoseconds(123'456'789));
    EXPECT_EQ(histogram.max().count(), 123'456'789);
    EXPECT_EQ(histogram.percentile(100).count(), 123'456'789);
}

TEST(LatencyHistogram, TakesTheExtremesOfItsRange) {
    LatencyHistogram histogram;
    histogram.record(nanoseconds(-5));
    histogram.record(nanoseconds::max());
    EXPECT_EQ(histogram.count(), 2u);
    EXPECT_EQ(histogram.percentile(50).count(), 0);
    const auto largest = static_cast<double>(nanoseconds::max().count());
    EXPECT_NEAR(static_cast<double>(histogram.percentile(100).count()), largest, 0.01 * largest);
}

TEST(LatencyHistogram, NeverErrsByMoreThanOnePercentAtAnyPowerOfTwo) {
    for (int bit = 0; bit < 62; ++bit) {
        for (const int64_t offset : {-1, 0, 1}) {
            const int64_t value = std::max<int64_t>((int64_t{1} << bit) + offset, 1);
            LatencyHistogram histogram;
            histogram.record(nanoseconds(value));
            histogram.record(nanoseconds::max());
            EXPECT_NEAR(static_cast<double>(histogram.percentile(50).count()), static_cast<double>(value),
                        0.01 * static_cast<double>(value))
                << value;
        }
    }
}

TEST(LatencyHistogram, MergesAsIfAllHadBeenRecordedInOne) {
    LatencyHistogram one, a, b;
    for (int i = 1; i < 5000; ++i) {
        const nanoseconds value(i * 977);
        one.record(value);
        (i % 3 == 0 ? a : b).record(value);
    }
    a.merge(b);
    EXPECT_EQ(a.count(), one.count());
    EXPECT_EQ(a.max(), one.max());
    EXPECT_EQ(a.mean(), one.mean());
    for (const double percent : {5.0, 50.0, 99.0}) EXPECT_EQ(a.percentile(percent), one.percentile(percent));
}

}  // namespace
}  // namespace citystream::client
