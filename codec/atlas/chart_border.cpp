#include "codec/atlas/chart_border.h"

#include <algorithm>
#include <cassert>

namespace citystream::codec::atlas {

namespace {

/// For each padded column (or row) the interior one that it shows.
std::vector<uint32_t> sources(uint32_t size, uint32_t border, bool repeat) {
    std::vector<uint32_t> from(size_t{size} + 2 * size_t{border});
    for (size_t i = 0; i < from.size(); ++i) {
        const int64_t at = static_cast<int64_t>(i) - border;
        const int64_t wrapped = (at % size + size) % size;
        from[i] = static_cast<uint32_t>(repeat ? wrapped : std::clamp<int64_t>(at, 0, int64_t{size} - 1));
    }
    return from;
}

}  // namespace

uint32_t border_for_mips(uint32_t mips) {
    assert(mips <= kMostMips);
    return mips == 0 ? 0 : 1u << (mips - 1);
}

ChartBorder border_of(BorderRule rule, uint32_t mips, bool repeat_u, bool repeat_v) {
    const uint32_t b = border_for_mips(mips), repeating = std::max(b, 1u);
    if (rule == BorderRule::kPaper) return {b, b};
    if (rule == BorderRule::kUniform) return {repeating, repeating};
    return {repeat_u ? repeating : 0, repeat_v ? repeating : 0};
}

uint64_t border_cost(RectangleSize interior, uint32_t b) {
    return border_cost(interior, ChartBorder{b, b});
}

uint64_t border_cost(RectangleSize interior, ChartBorder border) {
    return 2 * (uint64_t{border.v} * interior.width + uint64_t{border.u} * interior.height) +
           4 * uint64_t{border.u} * border.v;
}

uint32_t alignment_unit(uint32_t mips, bool blocks, bool packed_coordinates) {
    assert(mips <= kMostMips);
    const uint32_t texels = 1u << mips;
    if (blocks) return 4 * texels;
    return packed_coordinates ? std::max(4u, texels) : texels;
}

std::vector<uint8_t> add_border(std::span<const uint8_t> texels, RectangleSize interior, uint32_t channels,
                                ChartBorder border, bool repeat_u, bool repeat_v) {
    assert(interior.area() > 0 && texels.size() == interior.area() * channels);
    const std::vector<uint32_t> columns = sources(interior.width, border.u, repeat_u);
    const std::vector<uint32_t> rows = sources(interior.height, border.v, repeat_v);
    std::vector<uint8_t> padded;
    padded.reserve(columns.size() * rows.size() * channels);
    for (const uint32_t row : rows) {
        const uint8_t* from = texels.data() + size_t{row} * interior.width * channels;
        for (const uint32_t column : columns) {
            const uint8_t* texel = from + size_t{column} * channels;
            padded.insert(padded.end(), texel, texel + channels);
        }
    }
    return padded;
}

}  // namespace citystream::codec::atlas
