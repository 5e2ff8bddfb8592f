// Adaptive binary range coder: numbers as binary decisions, each coded in as many bits as its probability says.
//
// An encoder and its decoder have the same calls: bit(model, value) and so on write `value` and return it, or ignore
// `value` and return what was read. So a format is written once, as a template over the coder, and both directions
// agree by construction. The models adapt in the same way on both sides; a model belongs to one coder at a time.
//
// Arithmetic: 32-bit range, probabilities of 16 bits, a carry runs back into the bytes written. Costs at most one byte
// over the sum of -log2 of the probabilities: the decoder reads zeros for up to kPaddingBytes bytes past the end, and
// the encoder ends with the number in its interval that has the most trailing zeros.
//
// Untrusted bytes: a decoder never reads outside its bytes. Past the padding it latches an error, and every read yields
// 0 from then on; check finish() before any decoded number is trusted. All calls end after a bounded number of steps.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/result.h"

namespace citystream::codec::bits {

/// By the bits seen: how far the two estimates of BitEstimates move towards the next, in 1/65536.
struct EstimateSteps {
    /// Bits after which they stop slowing down.
    static constexpr uint32_t kFastMemory = 24, kSlowMemory = 200;
    uint16_t fast[kSlowMemory + 1]{}, slow[kSlowMemory + 1]{};

    constexpr EstimateSteps() {
        for (uint32_t seen = 0; seen <= kSlowMemory; ++seen) {
            slow[seen] = static_cast<uint16_t>((2u << 16) / (2 * seen + 3));
            fast[seen] = slow[seen < kFastMemory ? seen : kFastMemory];
        }
    }
};
inline constexpr EstimateSteps kEstimateSteps;

/// What is known of a bit: the probability that it is 1, by two estimates, one that forgets fast and one that forgets
/// slowly. The first bits count most (as 1 / (bits seen + 1.5)), so that a handful says much. Eight bytes, all 0 when
/// nothing is known, so that a table of many costs no more than clearing its memory.
class BitEstimates {
  public:
    BitEstimates() = default;
    /// A first guess in 2^-28 that counts as much as `seen` bits.
    BitEstimates(uint32_t probability_of_one, uint32_t seen)
        : state_((probability_of_one | uint64_t{probability_of_one} << kEstimateBits | uint64_t{seen} << kSeenAt) ^
                 kHalves) {}
    /// In 1/65536, 1..65535.
    uint32_t probability_of_one() const {
        const uint64_t known = state_ ^ kHalves;
        const auto sum = static_cast<uint32_t>((known & kSure) + (known >> kEstimateBits & kSure));
        return std::max(sum >> (kEstimateBits + 1 - 16), 1u);
    }
    void learn(uint32_t bit);

    /// Estimates are in 2^-28: fine enough that a long run of equal bits comes to cost next to nothing.
    static constexpr uint32_t kEstimateBits = 28, kSure = (1u << kEstimateBits) - 1;

  private:
    static constexpr uint32_t kSeenAt = 2 * kEstimateBits;
    static constexpr uint64_t kHalf = uint64_t{1} << (kEstimateBits - 1), kHalves = kHalf | kHalf << kEstimateBits;
    uint64_t state_ = 0;  ///< fast, slow, bits seen from the lowest on; the first two less one half (exclusive or)
};
static_assert(sizeof(BitEstimates) == 8);

inline void BitEstimates::learn(uint32_t bit) {
    const uint64_t known = state_ ^ kHalves, seen = known >> kSeenAt;
    // An estimate of 1 moves up by its distance to sure as one of 0 moves down by its own.
    const uint64_t turn = bit != 0 ? kSure : 0;
    uint64_t fast = (known & kSure) ^ turn, slow = (known >> kEstimateBits & kSure) ^ turn;
    fast -= fast * kEstimateSteps.fast[seen] >> 16;
    slow -= slow * kEstimateSteps.slow[seen] >> 16;
    const uint64_t more = seen < EstimateSteps::kSlowMemory ? seen + 1 : seen;
    state_ = ((fast ^ turn) | (slow ^ turn) << kEstimateBits | more << kSeenAt) ^ kHalves;
}

/// The same of one kind of bits that a coder asks for by itself.
class BitModel {
  public:
    BitModel() = default;
    /// A first guess (0 < probability_of_one < 1) that counts as much as `weight` (0..kMostWeight) bits seen.
    explicit BitModel(double probability_of_one, uint32_t weight = 0);
    static constexpr uint32_t kMostWeight = 64;

    /// In 1/65536, 1..65535.
    uint32_t probability_of_one() const { return estimates_.probability_of_one(); }
    void learn(uint32_t bit) { estimates_.learn(bit); }
    /// What coding `bit` would cost now, in bits.
    double cost(uint32_t bit) const;

  private:
    BitEstimates estimates_{};
};

/// Coders keep their range at or above this.
inline constexpr uint32_t kLeastRange = 1u << 24;

class RangeEncoder {
  public:
    static constexpr bool kDecodes = false;
    /// Codes bit 0 or 1 and lets the model learn it.
    uint32_t bit(BitModel& model, uint32_t value);
    /// Codes bit 0 or 1, which is 1 with a probability of 1..65535 in 65536.
    uint32_t likely_bit(uint32_t probability_of_one, uint32_t value);
    /// A number of 0..count - 1, all equally likely; count 1..2^16.
    uint32_t uniform(uint32_t count, uint32_t value);
    /// The low `bits` (0..32) of value, equally likely.
    uint32_t plain_bits(uint32_t bits, uint32_t value);
    /// What all that was coded so far costs, in bits.
    double cost() const;
    /// The bytes; the encoder starts anew.
    std::vector<std::byte> finish();

  private:
    void narrow(uint32_t start, uint32_t size);
    std::vector<std::byte> bytes_;
    uint32_t low_ = 0, range_ = 0xffffffffu;
};

class RangeDecoder {
  public:
    static constexpr bool kDecodes = true;
    static constexpr size_t kPaddingBytes = 4;
    /// Borrows the bytes.
    explicit RangeDecoder(std::span<const std::byte> bytes);
    uint32_t bit(BitModel& model, uint32_t ignored = 0);
    uint32_t likely_bit(uint32_t probability_of_one, uint32_t ignored = 0);
    uint32_t uniform(uint32_t count, uint32_t ignored = 0);
    uint32_t plain_bits(uint32_t bits, uint32_t ignored = 0);
    /// False once the bytes have run out: all numbers read since may be wrong.
    bool ok() const { return !failed_; }
    /// Bytes taken so far, at most all.
    size_t position() const { return position_ < bytes_.size() ? position_ : bytes_.size(); }
    /// To be called after the last number: fails when the bytes ran out or when some are left over.
    Status finish() const;

  private:
    void narrow(uint32_t start, uint32_t size);
    uint32_t next_byte();
    std::span<const std::byte> bytes_;
    size_t position_ = 0;
    uint32_t code_ = 0, range_ = 0xffffffffu;
    bool failed_ = false;
};

inline uint32_t RangeDecoder::next_byte() {
    const size_t at = position_++;
    if (at < bytes_.size()) return std::to_integer<uint32_t>(bytes_[at]);
    if (at >= bytes_.size() + kPaddingBytes) {
        failed_ = true;
        position_ = at;
    }
    return 0;
}

inline void RangeDecoder::narrow(uint32_t start, uint32_t size) {
    code_ -= start;
    range_ = size;
    while (range_ < kLeastRange) {
        code_ = code_ << 8 | next_byte();
        range_ <<= 8;
    }
}

inline uint32_t RangeDecoder::likely_bit(uint32_t probability_of_one, uint32_t /*ignored*/) {
    if (failed_) return 0;
    const auto ones = static_cast<uint32_t>(uint64_t{range_} * probability_of_one >> 16);
    const uint32_t value = code_ < ones ? 1 : 0;
    if (value != 0)
        narrow(0, ones);
    else
        narrow(ones, range_ - ones);
    return failed_ ? 0 : value;
}

/// Numbers 0..count - 1 with a model for each inner node of the binary tree over them, most significant bit first;
/// branches without numbers cost nothing. Memory: count models, so the caller bounds the count.
class BitTree {
  public:
    explicit BitTree(uint32_t count);
    template <typename Coder>
    uint32_t code(Coder& coder, uint32_t value = 0);
    uint32_t count() const { return count_; }

  private:
    uint32_t count_, bits_;
    std::vector<BitModel> nodes_;
};

/// Any uint32 by Elias gamma code of value + 1: the length in unary, then the bits below the leading one; adaptive but
/// for the bits past the third below the leading one. For numbers that are mostly small.
class NumberModel {
  public:
    template <typename Coder>
    uint32_t code(Coder& coder, uint32_t value = 0);

  private:
    static constexpr uint32_t kMostLength = 33, kModelledBits = 3;
    BitModel longer_[kMostLength];
    BitModel mantissa_[kMostLength][1 << kModelledBits];
};

/// 0, -1, 1, -2, 2, ... <-> 0, 1, 2, 3, 4, ...
constexpr uint32_t zigzag(int32_t value) {
    return static_cast<uint32_t>(value) << 1 ^ (value < 0 ? ~0u : 0u);
}
constexpr int32_t unzigzag(uint32_t value) {
    return static_cast<int32_t>(value >> 1 ^ ((value & 1) != 0 ? ~0u : 0u));
}

template <typename Coder>
uint32_t BitTree::code(Coder& coder, uint32_t value) {
    uint32_t result = 0, node = 1;
    for (uint32_t bit = bits_; bit-- > 0;) {
        const uint32_t upper = result | 1u << bit;
        const uint32_t one = upper < count_ ? coder.bit(nodes_[node], value >> bit & 1) : 0;
        result = one != 0 ? upper : result;
        node = 2 * node + one;
    }
    return result;
}

template <typename Coder>
uint32_t NumberModel::code(Coder& coder, uint32_t value) {
    const uint64_t number = uint64_t{value} + 1;
    uint32_t length = 1;
    while (length < kMostLength && coder.bit(longer_[length - 1], number >> length != 0 ? 1 : 0) != 0) ++length;
    uint64_t result = 1;
    uint32_t rest = length - 1;
    for (uint32_t i = 0; i < kModelledBits && rest > 0; ++i) {
        --rest;
        const auto bit = static_cast<uint32_t>(number >> rest & 1);
        result = 2 * result + coder.bit(mantissa_[length - 1][result], bit);
    }
    result = result << rest | coder.plain_bits(rest, static_cast<uint32_t>(number));
    return static_cast<uint32_t>(result - 1);
}

}  // namespace citystream::codec::bits
