// Bits and numbers whose probability is mixed from several contexts (logistic mixing).
//
// A MixedBits holds, for each of its contexts, a table of BitEstimates. Each decision is looked up under every context
// at once; what the models say is stretched (ln(p / (1 - p))), weighted, summed and squashed back, and the weights move
// towards the models that were right. So a context that says nothing costs next to nothing, and several that each say
// something are worth more than the best of them: contexts may be added without thinning the statistics.
//
// Writing and reading are one template over the coder, as in range_coder.h. All arithmetic is on integers (the tables
// are made at compile time), so bytes do not depend on the machine.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include "codec/bits/range_coder.h"

namespace citystream::codec::bits {

/// Bits of one kind: `nodes` different decisions, each under the same contexts.
class MixedBits {
  public:
    static constexpr uint32_t kMostContexts = 12;
    /// Context i takes the values 0..context_counts[i] - 1. There are `sets` sets of weights to choose from. Memory: 4
    /// bytes for each value, and for each that was met 8 for each node; 4 for each weight.
    MixedBits(std::initializer_list<uint32_t> context_counts, uint32_t nodes, uint32_t sets = 1);

    /// Chooses the contexts of the bits that follow: one value each, below its count (a greater one is taken as the
    /// last), and a set of weights.
    void set_contexts(std::initializer_list<uint32_t> values, uint32_t set = 0);
    /// Codes bit 0 or 1 of a node (0..nodes - 1).
    template <typename Coder>
    uint32_t code(Coder& coder, uint32_t node, uint32_t value = 0);
    uint32_t nodes() const { return nodes_; }

  private:
    uint32_t mix(uint32_t node);
    void learn(uint32_t node, uint32_t bit);

    uint32_t contexts_, nodes_, sets_, set_ = 0;
    int32_t first_weight_;
    uint32_t counts_[kMostContexts] = {}, starts_[kMostContexts] = {};  // of the contexts' values in rows_
    std::vector<uint32_t> rows_;        // of each value: 1 + where its nodes are in models_, 0: it was not met
    std::vector<BitEstimates> models_;  // nodes_ of each value that was met
    std::vector<uint16_t> seen_;        // bits mixed by each row of weights, up to a limit
    std::vector<int32_t> weights_;      // in 2^-16, less the first weight, one for each set, node and context
    uint32_t at_[kMostContexts] = {};   // of the values chosen, in models_
    int32_t stretched_[kMostContexts] = {};
    uint32_t mixed_ = 0;  // what the last mix() gave, in 2^-16
};

template <typename Coder>
uint32_t MixedBits::code(Coder& coder, uint32_t node, uint32_t value) {
    const uint32_t bit = coder.likely_bit(mix(node), value);
    learn(node, bit);
    return bit;
}

/// Numbers by the length of value + 1 and the bits below its leading one, under mixed contexts. Lengths are told in
/// groups of 2^group_bits: how many groups further, then which of the group. 0 (Elias gamma, as NumberModel) is best
/// where most are small, more where most are not: it asks less often.
template <uint32_t kGroupBits>
class MixedLengthNumbers {
  public:
    explicit MixedLengthNumbers(std::initializer_list<uint32_t> context_counts, uint32_t sets = 1)
        : bits_(context_counts, kNodes, sets) {}
    void set_contexts(std::initializer_list<uint32_t> values, uint32_t set = 0) { bits_.set_contexts(values, set); }
    template <typename Coder>
    uint32_t code(Coder& coder, uint32_t value = 0);

  private:
    static constexpr uint32_t kMostLength = 33, kGroup = 1u << kGroupBits;
    static constexpr uint32_t kGroups = (kMostLength + kGroup - 1) / kGroup, kLengthNodes = kGroups * kGroup;
    /// Below the leading one kModelledBits bits are modelled by what is above them, the rest are taken as equally
    /// likely.
    static constexpr uint32_t kModelledBits = 2, kMantissaNodes = (1 << kModelledBits) - 1;
    static constexpr uint32_t kAlike = 20, kNodes = kLengthNodes + kAlike * kMantissaNodes;
    MixedBits bits_;
};
using MixedNumbers = MixedLengthNumbers<0>;

template <uint32_t kGroupBits>
template <typename Coder>
uint32_t MixedLengthNumbers<kGroupBits>::code(Coder& coder, uint32_t value) {
    const uint64_t number = uint64_t{value} + 1;
    const auto told = static_cast<uint32_t>(std::bit_width(number)) - 1;
    uint32_t group = 0;
    while (group + 1 < kGroups && bits_.code(coder, group * kGroup, told >> kGroupBits > group ? 1 : 0) != 0) ++group;
    uint32_t in_group = 1;
    for (uint32_t bit = kGroupBits; bit-- > 0;)
        in_group = 2 * in_group + bits_.code(coder, group * kGroup + in_group, told >> bit & 1);
    const uint32_t length = group * kGroup + in_group - kGroup + 1;
    if (length > kMostLength) return 0;
    const uint32_t first = kLengthNodes + (std::min(length, kAlike) - 1) * kMantissaNodes - 1;
    uint64_t result = 1;
    uint32_t rest = length - 1;
    for (uint32_t i = 0; i < kModelledBits && rest > 0; ++i) {
        --rest;
        const uint32_t node = first + static_cast<uint32_t>(result);
        result = 2 * result + bits_.code(coder, node, static_cast<uint32_t>(number >> rest & 1));
    }
    result = result << rest | coder.plain_bits(rest, static_cast<uint32_t>(number));
    return static_cast<uint32_t>(result - 1);
}

}  // namespace citystream::codec::bits
