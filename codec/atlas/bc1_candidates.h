// Many candidates for the words of one BC1 block at a time: what rate-distortion weighs (bc1_rate.h). Whole numbers;
// the same on every machine.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "codec/atlas/bc1_fit.h"

namespace citystream::codec::atlas {

/// J of rate-distortion is a squared error in these units, plus a cost.
inline constexpr uint32_t kErrorUnits = 16;

/// For every endpoints word a bound that its error cannot be below, whatever the indices: cheap. Sizes are equal.
void bound_bc1_errors(const Bc1Texels& texels, const ChannelWeights& weights, std::span<const uint32_t> endpoints,
                      std::span<int32_t> bounds);

/// For every endpoints word, as it is, the error with each texel's nearest colour. Sizes are equal.
void least_bc1_errors(const Bc1Texels& texels, const ChannelWeights& weights, std::span<const uint32_t> endpoints,
                      std::span<uint32_t> errors);

/// For fixed endpoints the squared error of every byte of an index word, which is a row of four texels.
class Bc1RowErrors {
  public:
    Bc1RowErrors(const Bc1Texels& texels, const ChannelWeights& weights, uint32_t endpoints);

    uint32_t of(uint32_t indices) const {
        return static_cast<uint32_t>(error_[0][indices & 255] + error_[1][indices >> 8 & 255] +
                                     error_[2][indices >> 16 & 255] + error_[3][indices >> 24]);
    }

    /// For every index word J: its error in sixteenths plus its cost. Sizes are equal. Returns the least J.
    uint64_t weigh(std::span<const uint32_t> indices, std::span<const uint32_t> costs, std::span<uint64_t> js) const;

    /// The index word whose every byte has the least J with its cost (the lowest among equals). J stays below 2^31.
    uint32_t cheapest(std::span<const int32_t, 256> byte_costs) const;

  private:
    std::array<std::array<int32_t, 256>, 4> error_;  ///< below 2^26
};

}  // namespace citystream::codec::atlas
