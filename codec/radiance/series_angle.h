// Sine and cosine by their series: only additions and multiplications, so that tables of directions, on which the bytes
// of a layer depend, are the same on every machine (the library's functions may differ in the last bit).
#pragma once

namespace citystream::codec::radiance {

struct AngleParts {
    double sine, cosine;
};

/// Of an angle of -7..7 radians, to 1e-14.
constexpr AngleParts angle_parts(double radians) {
    AngleParts parts{0, 0};
    double term = 1;
    for (int i = 0; i < 48; i += 2) {
        const double sign = i % 4 == 0 ? 1 : -1;
        parts.cosine += sign * term;
        term *= radians / (i + 1);
        parts.sine += sign * term;
        term *= radians / (i + 2);
    }
    return parts;
}

inline constexpr double kPi = 3.14159265358979323846;

}  // namespace citystream::codec::radiance
