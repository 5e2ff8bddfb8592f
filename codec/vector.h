// Vectors of three doubles: what codecs, selection and light reckon with.
#pragma once

#include <array>

namespace citystream::codec {

using Vector = std::array<double, 3>;

/// Summed in the order of the components.
constexpr double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Right-handed.
constexpr Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace citystream::codec
