// Chart words: what a surface of a tile shows, a chart of the tile's atlas layer or one colour. A tile whose surfaces
// are of single colours has no atlas layer.
#pragma once

#include <array>
#include <cstdint>

#include "codec/chart_word_layout.h"

namespace citystream::codec {

constexpr uint32_t colour_word(const std::array<uint8_t, 3>& rgb) {
    return CHART_WORD_COLOUR | uint32_t{rgb[0]} | uint32_t{rgb[1]} << 8 | uint32_t{rgb[2]} << 16;
}

constexpr bool names_colour(uint32_t chart_word) {
    return (chart_word & CHART_WORD_COLOUR) != 0;
}

/// Whether a word read from a layer is a colour, or a chart of an atlas of `chart_count`.
constexpr bool is_chart_word(uint32_t word, uint32_t chart_count) {
    return names_colour(word) ? (word & ~(CHART_WORD_COLOUR | CHART_WORD_COLOUR_MASK)) == 0 : word < chart_count;
}

}  // namespace citystream::codec
