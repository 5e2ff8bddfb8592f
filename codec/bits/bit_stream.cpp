#include "codec/bits/bit_stream.h"

#include <bit>
#include <cassert>
#include <utility>

namespace citystream::codec::bits {

namespace {

uint64_t low_mask(uint32_t bits) {
    return (uint64_t{1} << bits) - 1;
}

}  // namespace

uint32_t bits_for(uint64_t max_value) {
    return static_cast<uint32_t>(std::bit_width(max_value));
}

uint64_t words_for(uint64_t count, uint32_t bits) {
    // Split so that count * bits cannot overflow: 32 fields of `bits` bits fill `bits` words exactly.
    const uint64_t rest = (count % 32) * bits;
    return count / 32 * bits + (rest + 31) / 32;
}

void BitWriter::put(uint32_t value, uint32_t bits) {
    assert(bits <= 32);
    pending_ |= (value & low_mask(bits)) << pending_bits_;
    pending_bits_ += bits;
    if (pending_bits_ >= 32) {
        words_.push_back(static_cast<uint32_t>(pending_));
        pending_ >>= 32;
        pending_bits_ -= 32;
    }
}

std::vector<uint32_t> BitWriter::finish() {
    if (pending_bits_ > 0) words_.push_back(static_cast<uint32_t>(pending_));
    pending_ = 0;
    pending_bits_ = 0;
    return std::exchange(words_, {});
}

uint32_t read_bits(std::span<const uint32_t> words, uint64_t bit, uint32_t bits) {
    assert(bits <= 32);
    if (bits == 0) return 0;
    const size_t word = static_cast<size_t>(bit / 32);
    const uint32_t shift = static_cast<uint32_t>(bit % 32);
    uint64_t value = words[word];
    // The next word is touched only by fields that reach into it: the last field of a layer may end its last word.
    if (shift + bits > 32) value |= uint64_t{words[word + 1]} << 32;
    return static_cast<uint32_t>((value >> shift) & low_mask(bits));
}

}  // namespace citystream::codec::bits
