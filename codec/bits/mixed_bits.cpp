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

/// The inverse of kSquash: first for each of the lowest kFine probabilities, then for each of the highest kFine, then
/// for all in the middle of intervals of 2^kCoarseBits.
constexpr uint32_t kFine = 4096, kCoarseBits = 4, kProbabilities = 1u << kProbabilityBits;
constexpr std::array<int16_t, 2 * kFine + (kProbabilities >> kCoarseBits)> make_stretch() {
    std::array<int16_t, 2 * kFine + (kProbabilities >> kCoarseBits)> table{};
    int32_t at = -kMostStretch;
    const auto reach = [&at](uint32_t p) {
        while (at < kMostStretch && kSquash[static_cast<uint32_t>(at + kMostStretch)] < p) ++at;
        return static_cast<int16_t>(at);
    };
    for (uint32_t p = 0; p < kFine; ++p) table[p] = reach(p);
    for (uint32_t p = 1; p < kFine; ++p) table[2 * kFine - p] = static_cast<int16_t>(-table[p]);
    at = -kMostStretch;
    for (uint32_t p = 0; p < kProbabilities; p += 1u << kCoarseBits)
        table[2 * kFine + (p >> kCoarseBits)] = reach(p + (1u << kCoarseBits) / 2);
    return table;
}
constexpr auto kStretch = make_stretch();

/// Reckons without branches, for which of the three parts it is cannot be foreseen.
int32_t stretch(uint32_t p) {
    constexpr uint32_t kHighest = kProbabilities - kFine, kMiddleAt = 2 * kFine, kHighAt = kFine;
    const uint32_t is_low = p < kFine ? 1 : 0;
    const uint32_t is_high = p > kHighest ? 1 : 0;
    const uint32_t is_middle = 1 - is_low - is_high;
    return kStretch[(p >> (is_middle * kCoarseBits)) + is_middle * kMiddleAt - is_high * (kHighest - kHighAt)];
}

uint32_t squash(int32_t x) {
    return kSquash[static_cast<uint32_t>(std::clamp(x, -kMostStretch, kMostStretch) + kMostStretch)];
}

constexpr int32_t kOneWeight = 1 << 16, kMostWeight = 8 * kOneWeight;
/// How far weights move: error (2^-16) times stretched (2^-8) times a rate that falls from kFirstRate to kLastRate by
/// one for every kRateInterval bits, shifted.
constexpr int32_t kFirstRate = 32, kLastRate = 6, kLearningShift = 18, kRateInterval = 16;

/// Calls loop(i) for each context, unrolled: it takes a few instructions only.
template <typename Loop>
void for_each_context(uint32_t contexts, Loop loop) {
    uint32_t i = 0;
    for (; i + 3 <= contexts; i += 3) {
        loop(i);
        loop(i + 1);
        loop(i + 2);
    }
    for (; i < contexts; ++i) loop(i);
}

}  // namespace

MixedBits::MixedBits(std::initializer_list<uint32_t> context_counts, uint32_t nodes, uint32_t sets)
    : contexts_(static_cast<uint32_t>(context_counts.size())),
      nodes_(nodes),
      sets_(sets),
      first_weight_(kOneWeight * 5 / static_cast<int32_t>(4 * contexts_)) {
    assert(contexts_ >= 1 && contexts_ <= kMostContexts && sets_ >= 1);
    uint32_t values = 0, i = 0;
    for (const uint32_t count : context_counts) {
        counts_[i] = count;
        starts_[i++] = values;
        values += count;
    }
    rows_.resize(values);
    seen_.resize(size_t{nodes} * sets);
    weights_.resize(size_t{contexts_} * nodes * sets);
}

void MixedBits::set_contexts(std::initializer_list<uint32_t> values, uint32_t set) {
    assert(values.size() == contexts_);
    set_ = std::min(set, sets_ - 1);
    uint32_t i = 0;
    for (const uint32_t value : values) {
        uint32_t& row = rows_[starts_[i] + std::min(value, counts_[i] - 1)];
        if (row == 0) {
            row = static_cast<uint32_t>(models_.size()) + 1;
            models_.resize(models_.size() + nodes_);
        }
        at_[i++] = row - 1;
    }
}

uint32_t MixedBits::mix(uint32_t node) {
    int64_t sum = 0;
    const int32_t* weight = &weights_[(size_t{set_} * nodes_ + node) * contexts_];
    const BitEstimates* models = models_.data() + node;
    const int32_t first_weight = first_weight_;
    for_each_context(contexts_, [&](uint32_t i) {
        const int32_t stretched = stretch(models[at_[i]].probability_of_one());
        stretched_[i] = stretched;
        sum += int64_t{first_weight + weight[i]} * stretched;
    });
    mixed_ = squash(static_cast<int32_t>(std::clamp<int64_t>(sum >> 16, -kMostStretch, kMostStretch)));
    return mixed_;
}

void MixedBits::learn(uint32_t node, uint32_t bit) {
    const int32_t error = static_cast<int32_t>(bit << kProbabilityBits) - static_cast<int32_t>(mixed_);
    const size_t row = size_t{set_} * nodes_ + node;
    int32_t* weight = &weights_[row * contexts_];
    BitEstimates* models = models_.data() + node;
    const int32_t rate = std::max(kFirstRate - static_cast<int32_t>(seen_[row] / kRateInterval), kLastRate);
    if (seen_[row] < kFirstRate * kRateInterval) ++seen_[row];
    const int64_t pull = int64_t{error} * rate;
    const int32_t least = -kMostWeight - first_weight_, most = kMostWeight - first_weight_;
    for_each_context(contexts_, [&](uint32_t i) {
        const auto move = static_cast<int32_t>(pull * stretched_[i] >> kLearningShift);
        weight[i] = std::clamp(weight[i] + move, least, most);
        models[at_[i]].learn(bit);
    });
}

}  // namespace citystream::codec::bits
