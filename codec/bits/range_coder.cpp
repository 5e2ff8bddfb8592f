#include "codec/bits/range_coder.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <utility>

namespace citystream::codec::bits {

namespace {

constexpr uint32_t kOne = 1u << 16;

}  // namespace

BitModel::BitModel(double probability_of_one, uint32_t weight) {
    assert(probability_of_one > 0 && probability_of_one < 1 && weight <= kMostWeight);
    estimates_ = {static_cast<uint32_t>(probability_of_one * BitEstimates::kSure), weight};
}

double BitModel::cost(uint32_t bit) const {
    const double one = static_cast<double>(probability_of_one()) / kOne;
    return -std::log2(bit != 0 ? one : 1 - one);
}

void RangeEncoder::narrow(uint32_t start, uint32_t size) {
    low_ += start;
    if (low_ < start) {  // the carry: some byte before is not 0xff, for the whole number is below 1
        size_t i = bytes_.size();
        while (bytes_[--i] == std::byte{0xff}) bytes_[i] = std::byte{0};
        bytes_[i] = static_cast<std::byte>(std::to_integer<uint32_t>(bytes_[i]) + 1);
    }
    range_ = size;
    while (range_ < kLeastRange) {
        bytes_.push_back(static_cast<std::byte>(low_ >> 24));
        low_ <<= 8;
        range_ <<= 8;
    }
}

uint32_t RangeEncoder::likely_bit(uint32_t probability_of_one, uint32_t value) {
    const auto ones = static_cast<uint32_t>(uint64_t{range_} * probability_of_one >> 16);
    if (value != 0)
        narrow(0, ones);
    else
        narrow(ones, range_ - ones);
    return value;
}

uint32_t RangeEncoder::bit(BitModel& model, uint32_t value) {
    likely_bit(model.probability_of_one(), value);
    model.learn(value);
    return value;
}

uint32_t RangeEncoder::uniform(uint32_t count, uint32_t value) {
    assert(count >= 1 && count <= kOne && value < count);
    const uint32_t share = range_ / count;
    if (count > 1) narrow(share * value, share);
    return value;
}

uint32_t RangeEncoder::plain_bits(uint32_t bits, uint32_t value) {
    assert(bits <= 32);
    const uint32_t high_bits = bits > 16 ? bits - 16 : 0, low_bits = bits - high_bits;
    const uint32_t high = uniform(1u << high_bits, value >> 16 & ((1u << high_bits) - 1));
    return high << 16 | uniform(1u << low_bits, value & ((1u << low_bits) - 1));
}

double RangeEncoder::cost() const {
    return 8 * static_cast<double>(bytes_.size()) + 32 - std::log2(range_);
}

std::vector<std::byte> RangeEncoder::finish() {
    // The range is at least 2^24, so some number in the interval has zeros below its highest byte. Where that number is
    // 2^32 itself (a carry) or 0, it needs no byte at all.
    const uint32_t to_carry = 0u - low_;
    if (low_ != 0 && to_carry < range_) {
        narrow(to_carry, kLeastRange);
    } else if (low_ != 0) {
        bytes_.push_back(static_cast<std::byte>((low_ + kLeastRange - 1) >> 24));
    }
    low_ = 0;
    range_ = 0xffffffffu;
    return std::exchange(bytes_, {});
}

RangeDecoder::RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8 | next_byte();
}

uint32_t RangeDecoder::bit(BitModel& model, uint32_t /*ignored*/) {
    if (failed_) return 0;
    const uint32_t value = likely_bit(model.probability_of_one());
    model.learn(value);
    return value;
}

uint32_t RangeDecoder::uniform(uint32_t count, uint32_t /*ignored*/) {
    assert(count >= 1 && count <= kOne);
    if (failed_ || count == 1) return 0;
    const uint32_t share = range_ / count;
    // The encoder leaves the rest of the division unused: a code there comes from damaged bytes and means the last.
    const uint32_t value = std::min(code_ / share, count - 1);
    code_ = std::min(code_ - share * value, share - 1);
    narrow(0, share);
    return failed_ ? 0 : value;
}

uint32_t RangeDecoder::plain_bits(uint32_t bits, uint32_t /*ignored*/) {
    assert(bits <= 32);
    const uint32_t high = bits > 16 ? uniform(1u << (bits - 16)) : 0;
    return high << 16 | uniform(1u << std::min(bits, 16u));
}

Status RangeDecoder::finish() const {
    if (failed_) return Error{"range coded bytes end too early", bytes_.size()};
    // The code register is kPaddingBytes ahead of what the encoder had written when it came to its last byte.
    const size_t most = position_ - kPaddingBytes + 1;
    if (bytes_.size() > most) return Error{"bytes follow the range coded data", most};
    return Done{};
}

BitTree::BitTree(uint32_t count)
    : count_(count), bits_(static_cast<uint32_t>(std::bit_width(count - 1))), nodes_(size_t{1} << bits_) {
    assert(count >= 1);
}

}  // namespace citystream::codec::bits
