// Fields of 0..32 bits packed without padding, least significant bit first, in 32-bit words. Twin: read_bits in
// shaders/bits.glsl.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace citystream::codec::bits {

/// Smallest number of bits that holds every value in 0..max_value (0 for 0).
uint32_t bits_for(uint64_t max_value);

/// Words that `count` fields of `bits` bits take. 64-bit so that hostile counts cannot overflow.
uint64_t words_for(uint64_t count, uint32_t bits);

class BitWriter {
  public:
    /// Appends the low `bits` (0..32) of value.
    void put(uint32_t value, uint32_t bits);
    /// Pads the last word with zeros and returns all words.
    std::vector<uint32_t> finish();

  private:
    std::vector<uint32_t> words_;
    uint64_t pending_ = 0;
    uint32_t pending_bits_ = 0;
};

/// Field of `bits` (0..32) bits that starts at bit `bit` of `words`. The caller has checked that it lies inside.
uint32_t read_bits(std::span<const uint32_t> words, uint64_t bit, uint32_t bits);

}  // namespace citystream::codec::bits
