// Means of 8-bit sRGB values in linear light, in integers: what mips are made with. Means of the encoded values would
// darken whatever has contrast. The same bytes on every machine.
#pragma once

#include <array>
#include <cstdint>

namespace citystream::codec::atlas {

class LinearBytes {
  public:
    static const LinearBytes& tables();

    /// Linear light of a value; white is 2^18.
    uint32_t linear(uint8_t value) const { return linear_[value]; }

    /// The value nearest (in the encoded scale) to a quarter of the sum of four.
    uint8_t mean_of_four(uint32_t sum) const {
        const uint8_t byte = first_[sum >> kCellBits];
        return static_cast<uint8_t>(byte + (sum >= threshold_[byte + 1U] ? 1 : 0));
    }
    /// The same of weighted ones: `sum` of weight * linear over a `total` of weights (1..2^40).
    uint8_t mean(uint64_t sum, uint64_t total) const {
        return mean_of_four(static_cast<uint32_t>((4 * sum + total / 2) / total));
    }

  private:
    // Of sums of four. Neighbouring thresholds are more than a cell apart, so that a cell meets at most one.
    static constexpr uint32_t kWhite = 1U << 18, kCellBits = 8, kCells = 4 * kWhite >> kCellBits;
    LinearBytes();

    std::array<uint32_t, 256> linear_{};
    std::array<uint32_t, 257> threshold_{};    // value k holds the sums from threshold_[k] to threshold_[k + 1]
    std::array<uint8_t, kCells + 1> first_{};  // value of each cell's lower end
};

}  // namespace citystream::codec::atlas
