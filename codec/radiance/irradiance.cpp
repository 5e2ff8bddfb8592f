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

/// 2^44 / n by two divisions of 32 bits. n: 2^14..2^16 - 1.
uint32_t quotient_of_2_44(uint32_t n) {
    const uint32_t first = (1u << 28) / n, rest = (1u << 28) % n;
    return first << 16 | (rest << 16) / n;
}

/// Nearest to the square root of a number below 2^31.
uint32_t rounded_root(uint32_t number) {
    uint32_t root = 0;
    for (uint32_t bit = 1u << 15; bit != 0; bit >>= 1) {
        const uint32_t more = root | bit;
        if (more * more <= number) root = more;
    }
    return root + (number - root * root > root ? 1 : 0);
}

}  // namespace

std::vector<uint32_t> irradiance_weights(uint32_t local_side) {
    std::vector<uint32_t> weights;
    for (const double cosine : cell_averages(LocalDirections(local_side)).cosine)
        weights.push_back(std::min(static_cast<uint32_t>(std::floor(cosine * kWeightOne + 0.5)), kWeightOne - 1));
    return weights;
}

WholeNormal whole_normal(uint32_t surface_class, const std::array<int8_t, 2>& tilt) {
    const uint32_t own = surface_class / 2;
    const int32_t a = +tilt[0], b = +tilt[1], one = RECEIVER_TILT_ONE;
    WholeNormal normal;
    normal.vector[own] = surface_class % 2 == 0 ? one : -one;
    normal.vector[(own + 1) % 3] = a;
    normal.vector[(own + 2) % 3] = b;
    static_assert(IRRADIANCE_SCALE_BITS == 22);
    normal.scale = rounded_root(quotient_of_2_44(static_cast<uint32_t>(one * one + a * a + b * b)));
    return normal;
}

uint64_t part_along(const WholeNormal& normal, const std::array<uint32_t, 3>& vector) {
    int64_t product = 0;
    for (size_t axis = 0; axis < 3; ++axis)
        product += int64_t{normal.vector[axis]} * static_cast<int32_t>(vector[axis]);
    if (product <= 0) return 0;
    constexpr uint32_t kShift = IRRADIANCE_SCALE_BITS - IRRADIANCE_WEIGHT_BITS - LIGHT_VECTOR_SHIFT;
    return (static_cast<uint64_t>(product) * normal.scale) >> kShift;
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

std::vector<uint32_t> irradiance_words(const RadianceLayerView& layer, const WholeLight& light) {
    const auto matrix = ResidentRadianceView::create(layer.matrix());
    const uint32_t side = texels_across_of(light.values.size());
    const auto table = ReceiverTableView::create(layer.table());
    if (!matrix || !table || side == 0 || matrix->columns() != light.values.size()) return {};
    const LightVectors vectors = light_vectors(light, texel_directions(side));
    std::array<std::vector<Channels<uint32_t>>, 3> rows;
    for (size_t axis = 0; axis < rows.size(); ++axis)
        rows[axis] = matrix->product(std::span<const Channels<uint32_t>>(vectors[axis]));
    const std::vector<ReceiverPlace> places = table->places();
    std::vector<uint32_t> words;
    words.reserve(places.size() * IRRADIANCE_WORDS);
    for (uint32_t r = 0; r < places.size(); ++r) {
        std::array<std::array<uint32_t, 3>, 3> sums{};  // of each channel x, y, z
        for (uint32_t d = 0; d < matrix->locals(); ++d) {
            const uint32_t row = matrix->row_of(r, d);
            for (size_t axis = 0; axis < rows.size(); ++axis) {
                for (size_t c = 0; c < 3; ++c) sums[c][axis] += rows[axis][row][c];
            }
        }
        const WholeNormal normal = whole_normal(places[r].surface_class, places[r].tilt);
        const auto half = [&](size_t c) { return irradiance_half(part_along(normal, sums[c])); };
        words.push_back(half(0) | half(1) << 16);
        words.push_back(half(2) | IRRADIANCE_LIT << 16);
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
