#include "codec/radiance/cell_mixer.h"

namespace citystream::codec::radiance {

namespace {

constexpr double kStretchUnit = 256;
/// The least probability that is told, in 2^-16, and its complement.
constexpr double kLeast = 16, kMost = 65536 - kLeast;

/// e^x for |x| <= 8, by halving the argument until the series is short. Only for tables made at compile time.
constexpr double exponential(double x) {
    double small = x / 64, term = 1, sum = 1;
    for (int i = 1; i < 12; ++i) sum += term = term * small / i;
    for (int i = 0; i < 6; ++i) sum *= sum;
    return sum;
}

/// Squash: the inverse function. Stretch: of the middle of an interval of probabilities the first that squashes to no
/// less.
constexpr MixingTables make_tables() {
    MixingTables tables{};
    constexpr int32_t kEnd = MixingTables::kStretchEnd;
    for (int32_t x = -kEnd; x < kEnd; ++x) {
        const double p = 65536 / (1 + exponential(-static_cast<double>(x) / kStretchUnit));
        tables.squash[static_cast<uint32_t>(x + kEnd)] = static_cast<uint16_t>(std::clamp(p, kLeast, kMost));
    }
    constexpr uint32_t kInterval = 1u << (16 - MixingTables::kStretchBits);
    int32_t at = 1 - kEnd;
    for (uint32_t i = 0; i < tables.stretch.size(); ++i) {
        while (at < kEnd - 1 && tables.squash[static_cast<uint32_t>(at + kEnd)] < kInterval * i + kInterval / 2) ++at;
        tables.stretch[i] = static_cast<int16_t>(at);
    }
    return tables;
}

}  // namespace

constinit const MixingTables kMixingTables = make_tables();

}  // namespace citystream::codec::radiance
