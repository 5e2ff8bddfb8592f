// Tints that vary over a city, so that facades that show one texture do not look alike. An option of the renderer.
//
// Source: "Space-Optimized Texture Atlases", appendix ("Visual improvements"), as corrected in the notes: the two
// weights are swapped there, so that the tint jumps at every whole t; here it is continuous.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace citystream::codec::atlas {

using Tint = std::array<float, 3>;  ///< linear RGB

enum class TintField : uint8_t {
    kProduct,  ///< the paper's t = |x| |y| / step: changes the faster the farther from the origin (pitfall 20)
    kSum,      ///< t = (|x| + |y|) / step: one colour per step everywhere
};

/// t at a place on the ground, metres from the city's own origin. step > 0, metres (kProduct: square metres).
double tint_parameter(TintField field, double x, double y, double step);

/// C[floor(t) mod n] (1 - f) + C[(floor(t) + 1) mod n] f with f = t - floor(t). t >= 0 and finite, palette not empty
/// (programming errors). Above 2^53 there is no fraction left.
Tint tint_at(std::span<const Tint> palette, double t);

}  // namespace citystream::codec::atlas
