#include "codec/radiance/irradiance.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "codec/radiance/local_directions.h"
#include "codec/radiance/radiance_resident.h"

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kWeightOne = 1u << IRRADIANCE_WEIGHT_BITS;
/// Of halves: bits below the leading one, and the bit of a sum that is their least normal number's.
constexpr uint32_t kMantissaBits = 10, kLeastNormalBit = IRRADIANCE_SUM_BITS - 14;

}  // namespace

std::vector<uint32_t> irradiance_weights(uint32_t local_side) {
    std::vector<uint32_t> weights;
    for (const double cosine : cell_averages(LocalDirections(local_side)).cosine)
        weights.push_back(std::min(static_cast<uint32_t>(std::floor(cosine * kWeightOne + 0.5)), kWeightOne - 1));
    return weights;
}

std::array<float, 3> irradiance_unit(const WholeLight& light) {
    std::array<float, 3> unit{};
    constexpr double kSteps = static_cast<double>(uint64_t{1} << (IRRADIANCE_SUM_BITS - IRRADIANCE_WEIGHT_BITS));
    for (size_t c = 0; c < 3; ++c) unit[c] = static_cast<float>(kSteps * kQuarter * light.unit[c]);
    return unit;
}

uint32_t irradiance_half(uint64_t sum) {
    const auto leading = static_cast<uint32_t>(std::bit_width(sum | 1)) - 1;
    const uint32_t least = std::max(leading, kLeastNormalBit), shift = least - kMantissaBits;
    const auto rounded = static_cast<uint32_t>((sum + (uint64_t{1} << (shift - 1))) >> shift);
    return ((least - kLeastNormalBit) << kMantissaBits) + rounded;
}

float half_value(uint32_t half) {
    const uint32_t exponent = half >> kMantissaBits & 31, mantissa = half & ((1u << kMantissaBits) - 1);
    constexpr int kLeastExponent = -24;  // of the last bit of numbers without a leading one
    if (exponent == 0) return std::ldexp(static_cast<float>(mantissa), kLeastExponent);
    return std::ldexp(static_cast<float>(mantissa | 1u << kMantissaBits),
                      static_cast<int>(exponent) - 1 + kLeastExponent);
}

std::vector<uint32_t> irradiance_words(const RadianceLayerView& layer, const WholeLight& light,
                                       std::span<const uint32_t> weights) {
    const auto matrix = ResidentRadianceView::create(layer.matrix());
    if (!matrix || matrix->columns() != light.values.size() || matrix->locals() != weights.size()) return {};
    const auto rows = matrix->product(std::span<const Channels<uint32_t>>(light.values));
    std::vector<uint32_t> words;
    words.reserve(size_t{layer.receivers()} * IRRADIANCE_WORDS);
    for (uint32_t r = 0; r < layer.receivers(); ++r) {
        std::array<uint64_t, 3> sum{};
        for (uint32_t d = 0; d < weights.size(); ++d) {
            const Channels<uint32_t>& row = rows[matrix->row_of(r, d)];
            for (size_t c = 0; c < 3; ++c) sum[c] += uint64_t{weights[d]} * row[c];
        }
        words.push_back(irradiance_half(sum[0]) | irradiance_half(sum[1]) << 16);
        words.push_back(irradiance_half(sum[2]) | IRRADIANCE_LIT << 16);
    }
    return words;
}

std::array<float, 3> irradiance_of(std::span<const uint32_t> irradiance, uint32_t receiver,
                                   const std::array<float, 3>& unit) {
    const uint32_t first = irradiance[size_t{receiver} * IRRADIANCE_WORDS];
    const uint32_t second = irradiance[size_t{receiver} * IRRADIANCE_WORDS + 1];
    return {half_value(first & 0xffff) * unit[0], half_value(first >> 16) * unit[1],
            half_value(second & 0xffff) * unit[2]};
}

}  // namespace citystream::codec::radiance
