// Tone and sRGB of lit frames: twin of shaders/tone.glsl (tone_layout.h has the curve), for who shades on the CPU.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "client/render/tone_layout.h"

namespace citystream::client {

/// 0..1 from 0..1.
inline double srgb_decoded(double value) {
    if (value <= SRGB_ENCODED_END) return value / SRGB_SLOPE;
    return std::pow((value + SRGB_OFFSET) / (1 + SRGB_OFFSET), SRGB_EXPONENT);
}
inline double srgb_encoded(double value) {
    if (value <= SRGB_LINEAR_END) return value * SRGB_SLOPE;
    return (1 + SRGB_OFFSET) * std::pow(value, 1 / SRGB_EXPONENT) - SRGB_OFFSET;
}

/// Of one channel: radiance times exposure, at least 0, to 0..1, linear.
inline double tone(double light) {
    if (light <= TONE_LINEAR) return light;
    const double t = (std::min(light, TONE_MOST) - TONE_LINEAR) / (1 - TONE_LINEAR);
    return TONE_LINEAR + (1 - TONE_LINEAR) * t / (1 + t);
}

/// What a pixel shows, sRGB 0..1.
inline std::array<double, 3> shown_light(const std::array<double, 3>& light) {
    return {srgb_encoded(tone(light[0])), srgb_encoded(tone(light[1])), srgb_encoded(tone(light[2]))};
}

}  // namespace citystream::client
