#include "codec/radiance/local_light.h"

#include <algorithm>
#include <bit>

#include "codec/radiance/irradiance.h"
#include "codec/radiance/radiance_resident.h"

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kMantissa = (1u << LOCAL_LIGHT_BITS) - 1;

uint32_t rounded(uint32_t value, uint32_t shift) {
    return shift == 0 ? value : (value + (1u << (shift - 1))) >> shift;
}

/// What a direction adds to irradiance, in 2^-31 of its unit; `row`: of one channel x, y, z.
uint32_t direction_irradiance(const WholeNormal& normal, const std::array<uint32_t, 3>& row) {
    const uint64_t part = part_along(normal, row) >> (IRRADIANCE_SUM_BITS - LOCAL_LIGHT_UNIT_BITS);
    return static_cast<uint32_t>(std::min<uint64_t>(part, (uint64_t{1} << LOCAL_LIGHT_UNIT_BITS) - 1));
}

}  // namespace

uint32_t local_light_word(const std::array<uint32_t, 3>& value) {
    const uint32_t greatest = std::max({value[0], value[1], value[2]});
    const auto bits = static_cast<uint32_t>(std::bit_width(greatest));
    uint32_t exponent = std::max<uint32_t>(bits, LOCAL_LIGHT_BITS) - LOCAL_LIGHT_BITS;
    if (rounded(greatest, exponent) > kMantissa) ++exponent;
    uint32_t word = exponent << 3 * LOCAL_LIGHT_BITS;
    for (uint32_t c = 0; c < 3; ++c) word |= rounded(value[c], exponent) << c * LOCAL_LIGHT_BITS;
    return word;
}

std::array<uint32_t, 3> local_light_value(uint32_t word) {
    std::array<uint32_t, 3> value{};
    for (uint32_t c = 0; c < 3; ++c)
        value[c] = (word >> c * LOCAL_LIGHT_BITS & kMantissa) << (word >> 3 * LOCAL_LIGHT_BITS);
    return value;
}

uint32_t wall_receivers(std::span<const uint32_t> table) {
    constexpr size_t kFirstOther = 4;  // +z
    for (size_t other = kFirstOther; other < RECEIVER_CLASSES; ++other) {
        const size_t at = RECEIVER_WORD_CLASSES + other * RECEIVER_CLASS_WORDS;
        if (table[at + RECEIVER_CLASS_ROWS] == 0) continue;
        const size_t row = size_t{table[at + RECEIVER_CLASS_ROW_TABLE]} + RECEIVER_ROW_FIRST;
        if (row < table.size()) return std::min(table[row], table[RECEIVER_WORD_COUNT]);
    }
    return table[RECEIVER_WORD_COUNT];
}

std::vector<uint32_t> local_light_words(const RadianceLayerView& layer, const WholeLight& light) {
    const auto matrix = ResidentRadianceView::create(layer.matrix());
    const auto table = ReceiverTableView::create(layer.table());
    const uint32_t side = texels_across_of(light.values.size());
    if (!matrix || !table || side == 0 || matrix->columns() != light.values.size()) return {};
    if (matrix->locals() != LOCAL_LIGHT_DIRECTIONS) return {};
    const LightVectors vectors = light_vectors(light, texel_directions(side));
    std::array<std::vector<Channels<uint32_t>>, 3> rows;
    for (size_t axis = 0; axis < rows.size(); ++axis)
        rows[axis] = matrix->product(std::span<const Channels<uint32_t>>(vectors[axis]));
    const std::vector<ReceiverPlace> places = table->places();
    const uint32_t walls = wall_receivers(layer.table());
    std::vector<uint32_t> words;
    words.reserve(size_t{walls} * LOCAL_LIGHT_DIRECTIONS);
    for (uint32_t r = 0; r < walls; ++r) {
        const WholeNormal normal = whole_normal(places[r].surface_class, places[r].tilt);
        for (uint32_t d = 0; d < LOCAL_LIGHT_DIRECTIONS; ++d) {
            const uint32_t row = matrix->row_of(r, d);
            std::array<uint32_t, 3> value{};
            for (size_t c = 0; c < 3; ++c)
                value[c] = direction_irradiance(normal, {rows[0][row][c], rows[1][row][c], rows[2][row][c]});
            words.push_back(local_light_word(value));
        }
    }
    return words;
}

}  // namespace citystream::codec::radiance
