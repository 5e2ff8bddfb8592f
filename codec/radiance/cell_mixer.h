// Decisions of the range coder whose probability is mixed from several contexts by logistic mixing, as in
// codec/bits/mixed_bits.h, but made for speed: a fixed number of contexts, tables that are there from the start, and
// what is known of a decision in four bytes. The cells of a receiver (visibility_code.h) are told so.
//
// All arithmetic is on integers (the tables are made at compile time), so bytes do not depend on the machine.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace citystream::codec::radiance {

/// Stretched probabilities ln(p / (1 - p)) are in 1/256, less than kStretchEnd in magnitude; probabilities in 2^-16.
struct MixingTables {
    static constexpr int32_t kStretchEnd = 2048;
    static constexpr uint32_t kStretchBits = 12;
    std::array<int16_t, 1 << kStretchBits> stretch;  ///< of the highest bits of a probability
    std::array<uint16_t, 2 * kStretchEnd> squash;    ///< the inverse, of stretched + kStretchEnd
};
extern const MixingTables kMixingTables;

/// By the bits seen: how far a model moves towards the next, 1 / (bits seen + 1.5) in 1/65536.
struct CellModelSteps {
    static constexpr uint32_t kMostSeen = 60;
    std::array<uint16_t, kMostSeen + 1> of{};
    constexpr CellModelSteps() {
        for (uint32_t seen = 0; seen <= kMostSeen; ++seen)
            of[seen] = static_cast<uint16_t>((2u << 16) / (2 * seen + 3));
    }
};
inline constexpr CellModelSteps kCellModelSteps;

template <uint32_t kContexts>
class CellMixer {
  public:
    /// Context i takes the values 0..context_counts[i] - 1; there are `nodes` different decisions under each, and
    /// `sets` sets of weights. Memory: 4 bytes for each value and node, and for each set, node and context.
    CellMixer(const std::array<uint32_t, kContexts>& context_counts, uint32_t nodes, uint32_t sets) : nodes_(nodes) {
        uint32_t models = 0;
        for (uint32_t i = 0; i < kContexts; ++i) {
            starts_[i] = models;
            models += context_counts[i] * nodes;
        }
        models_.assign(models, kUnknown);
        weights_.assign(size_t{sets} * nodes * kContexts, kFirstWeight);
        seen_.assign(size_t{sets} * nodes, 0);
    }

    /// Chooses the contexts of the decisions that follow: values below their counts, and a set of weights.
    void set_contexts(const std::array<uint32_t, kContexts>& values, uint32_t set) {
        for (uint32_t i = 0; i < kContexts; ++i) at_[i] = starts_[i] + values[i] * nodes_;
        set_ = set;
    }
    void set_weights(uint32_t set) { set_ = set; }

    /// Codes 0 or 1 at a node (0..nodes - 1).
    template <typename Coder>
    uint32_t code(Coder& coder, uint32_t node, uint32_t told) {
        const uint32_t row = set_ * nodes_ + node;
        int32_t* const weights = &weights_[size_t{row} * kContexts];
        uint32_t* const models = models_.data() + node;
        std::array<int32_t, kContexts> stretched;
        int64_t sum = 0;
        for (uint32_t i = 0; i < kContexts; ++i) {
            stretched[i] = kMixingTables.stretch[models[at_[i]] >> (32 - MixingTables::kStretchBits)];
            sum += int64_t{weights[i]} * stretched[i];
        }
        constexpr int64_t kMost = MixingTables::kStretchEnd - 1;
        const auto mixed = static_cast<uint32_t>(std::clamp(sum >> 16, -kMost, kMost) + MixingTables::kStretchEnd);
        const uint32_t probability = kMixingTables.squash[mixed];
        const uint32_t bit = coder.likely_bit(probability, told);
        const int32_t error = (static_cast<int32_t>(bit << 16) - static_cast<int32_t>(probability)) * rate_of(row);
        for (uint32_t i = 0; i < kContexts; ++i) {
            const auto move = static_cast<int32_t>(int64_t{error} * stretched[i] >> kLearningShift);
            weights[i] = std::clamp(weights[i] + move, -kMostWeight, kMostWeight);
            learn(models[at_[i]], bit);
        }
        return bit;
    }

  private:
    static constexpr int32_t kOneWeight = 1 << 16, kMostWeight = 8 * kOneWeight;
    static constexpr int32_t kFirstWeight = 5 * kOneWeight / static_cast<int32_t>(4 * kContexts);
    /// How far weights move: error (2^-16) times stretched (2^-8) times a rate that falls from kFirstRate to kLastRate
    /// by one for every kRateInterval bits, shifted.
    static constexpr int32_t kFirstRate = 32, kLastRate = 6, kRateInterval = 16, kLearningShift = 18;
    /// A model is a probability in the upper bits and the number of bits seen, up to kMostSeen, in the lower ones.
    static constexpr uint32_t kSeenBits = 6, kMostSeen = CellModelSteps::kMostSeen, kUnknown = 1u << 31;
    static constexpr uint32_t kSure = (1u << (32 - kSeenBits)) - 1;

    int32_t rate_of(uint32_t row) {
        uint16_t& seen = seen_[row];
        const int32_t rate = std::max(kFirstRate - seen / kRateInterval, kLastRate);
        if (seen < kFirstRate * kRateInterval) ++seen;
        return rate;
    }
    static void learn(uint32_t& model, uint32_t bit) {
        const uint32_t seen = model % (1u << kSeenBits), estimate = model >> kSeenBits;
        const int64_t distance = (bit != 0 ? int64_t{kSure} : 0) - int64_t{estimate};
        const auto moved = static_cast<uint32_t>(int64_t{estimate} + (distance * kCellModelSteps.of[seen] >> 16));
        model = moved << kSeenBits | std::min(seen + 1, kMostSeen);
    }
    uint32_t nodes_, set_ = 0;
    std::array<uint32_t, kContexts> starts_{}, at_{};  // of the contexts, and of the values chosen, in models_
    std::vector<uint32_t> models_;
    std::vector<int32_t> weights_;  // in 2^-16; of each set, node and context
    std::vector<uint16_t> seen_;    // bits coded with each set and node, up to a limit
};

}  // namespace citystream::codec::radiance
