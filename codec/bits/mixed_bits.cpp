#include "codec/bits/mixed_bits.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace citystream::codec::bits {

namespace {

/// Stretched probabilities are in 1/256, from -kMostStretch to kMostStretch: 2^-16 and its complement.
constexpr int32_t kStretchUnit = 256, kMostStretch = 11 * kStretchUnit;
constexpr uint32_t kProbabilityBits = 16;

/// e^x for |x| <= 11, by halving the argument until the series is short. Only for tables made at compile time.
constexpr double exponential(double x) {
    double small = x / 64, term = 1, sum = 1;
    for (int i = 1; i < 12; ++i) sum += term = term * small / i;
    for (int i = 0; i < 6; ++i) sum *= sum;
    return sum;
}

constexpr std::array<uint16_t, 2 * kMostStretch + 1> make_squash() {
    std::array<uint16_t, 2 * kMostStretch + 1> table{};
    for (int32_t i = -kMostStretch; i <= kMostStretch; ++i) {
        const double p = 65536 / (1 + exponential(-static_cast<double>(i) / kStretchUnit)) + 0.5;
        table[static_cast<uint32_t>(i + kMostStretch)] = static_cast<uint16_t>(p < 1 ? 1 : p > 65535 ? 65535 : p);
    }
    return table;
}
constexpr auto kSquash = make_squash();

/// The inverse of kSquash for 4096 probabilities in the middle of equal intervals of `scale`.
constexpr uint32_t kCoarseBits = 12;
constexpr std::array<int16_t, 1u << kCoarseBits> make_stretch(uint32_t scale) {
    std::array<int16_t, 1u << kCoarseBits> table{};
    int32_t at = -kMostStretch;
    for (uint32_t i = 0; i < table.size(); ++i) {
        const uint32_t p = i * scale + scale / 2;
        while (at < kMostStretch && kSquash[static_cast<uint32_t>(at + kMostStretch)] < p) ++at;
        table[i] = static_cast<int16_t>(at);
    }
    return table;
}
constexpr auto kStretch = make_stretch(16), kStretchOfSmall = make_stretch(1);

int32_t stretch(uint32_t p) {
    if (p < 4096) return kStretchOfSmall[p];
    if (p > 65536 - 4096) return -kStretchOfSmall[65536 - p];
    return kStretch[p >> (kProbabilityBits - kCoarseBits)];
}

uint32_t squash(int32_t x) {
    return kSquash[static_cast<uint32_t>(std::clamp(x, -kMostStretch, kMostStretch) + kMostStretch)];
}

constexpr int32_t kOneWeight = 1 << 16, kMostWeight = 8 * kOneWeight;
/// How far weights move: error (2^-16) times stretched (2^-8) times a rate that falls from kFirstRate to kLastRate by
/// one for every kRateInterval bits, shifted.
constexpr int32_t kFirstRate = 32, kLastRate = 6, kLearningShift = 18, kRateInterval = 16;

}  // namespace

MixedBits::MixedBits(std::initializer_list<uint32_t> context_counts, uint32_t nodes, uint32_t sets)
    : contexts_(static_cast<uint32_t>(context_counts.size())), nodes_(nodes), sets_(sets), counts_(context_counts) {
    assert(contexts_ >= 1 && contexts_ <= kMostContexts && sets_ >= 1);
    uint32_t values = 0;
    for (const uint32_t count : counts_) {
        starts_.push_back(values);
        values += count;
    }
    models_.resize(size_t{values} * nodes);
    seen_.assign(size_t{nodes} * sets, 0);
    weights_.assign(size_t{contexts_} * nodes * sets, kOneWeight * 5 / static_cast<int32_t>(4 * contexts_));
}

void MixedBits::set_contexts(std::initializer_list<uint32_t> values, uint32_t set) {
    assert(values.size() == contexts_);
    set_ = std::min(set, sets_ - 1);
    uint32_t i = 0;
    for (const uint32_t value : values) {
        at_[i] = (starts_[i] + std::min(value, counts_[i] - 1)) * nodes_;
        ++i;
    }
}

uint32_t MixedBits::mix(uint32_t node) {
    int64_t sum = 0;
    const int32_t* weight = &weights_[(size_t{set_} * nodes_ + node) * contexts_];
    for (uint32_t i = 0; i < contexts_; ++i) {
        stretched_[i] = stretch(models_[at_[i] + node].probability_of_one());
        sum += int64_t{weight[i]} * stretched_[i];
    }
    mixed_ = squash(static_cast<int32_t>(std::clamp<int64_t>(sum >> 16, -kMostStretch, kMostStretch)));
    return mixed_;
}

void MixedBits::learn(uint32_t node, uint32_t bit) {
    const int32_t error = static_cast<int32_t>(bit << kProbabilityBits) - static_cast<int32_t>(mixed_);
    const size_t row = size_t{set_} * nodes_ + node;
    int32_t* weight = &weights_[row * contexts_];
    const int32_t rate = std::max(kFirstRate - static_cast<int32_t>(seen_[row] / kRateInterval), kLastRate);
    if (seen_[row] < kFirstRate * kRateInterval) ++seen_[row];
    for (uint32_t i = 0; i < contexts_; ++i) {
        const auto move = static_cast<int32_t>(int64_t{error} * stretched_[i] * rate >> kLearningShift);
        weight[i] = std::clamp(weight[i] + move, -kMostWeight, kMostWeight);
        models_[at_[i] + node].learn(bit);
    }
}

}  // namespace citystream::codec::bits
