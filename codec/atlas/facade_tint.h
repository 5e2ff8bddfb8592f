// Tints that vary over a city, so that facades that show one texture do not look alike. An option of both renderers,
// which draw the same; only what stands upright is tinted.
//
// Source: "Space-Optimized Texture Atlases", appendix ("Visual improvements"), as corrected in the notes: the two
// weights are swapped there, so that the tint jumps at every whole t; here it is continuous. Its t = |x| |y| / step
// changes the faster the farther from the origin; here one colour takes one step everywhere. It mixes tint and texture;
// the renderers multiply, so that panes stay dark.
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <span>
#include <string_view>

#include "codec/result.h"

namespace citystream::codec::atlas {

using Tint = std::array<float, 3>;  ///< RGB

/// C[floor(t) mod n] (1 - f) + C[(floor(t) + 1) mod n] f with f = t - floor(t). t >= 0 and finite, palette not empty
/// (programming errors). Above 2^53 there is no fraction left.
Tint tint_at(std::span<const Tint> palette, double t);

/// What the renderers do.
struct FacadeTint {
    double strength = 0;      ///< colours are multiplied by 1 - strength + strength * tint; 0: nothing is computed
    double step_metres = 40;  ///< east or north, from a colour to the next
    auto operator<=>(const FacadeTint&) const = default;
};

/// "STRENGTH[,METRES]", METRES 1 to 1e5. Error: one line.
Result<FacadeTint> parse_facade_tint(std::string_view text);

/// The colours of tint_layout.h, sRGB.
std::span<const Tint> tint_palette();

/// Where in the palette a place is, 0 <= place < TINT_COLOURS: t = (x + y) / step, modulo the palette so that floats
/// hold it everywhere (and without the fold at the axes). Position: absolute metres.
double tint_place(const std::array<double, 3>& position, const FacadeTint& tint);

}  // namespace citystream::codec::atlas
