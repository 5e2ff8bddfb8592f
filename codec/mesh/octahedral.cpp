#include "codec/mesh/octahedral.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "codec/mesh/lattice_cell.h"

namespace citystream::codec::mesh {

namespace {

/// Up to here, angles between candidates are so wide that their cosines tell them apart.
constexpr uint32_t kMostBitsByCosine = 16;

double sign_of(double value) {
    return value < 0 ? -1.0 : 1.0;
}

std::array<int32_t, 3> fold(int32_t u, int32_t v, int32_t side) {
    const int32_t beside_u = side - std::abs(u), beside_v = side - std::abs(v);
    const int32_t z = beside_u - std::abs(v);
    if (z >= 0) return {u, v, z};
    return {u < 0 ? -beside_v : beside_v, v < 0 ? -beside_u : beside_u, z};
}

double length_of(const Direction& d) {
    return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/// Grow with the angle between d and n, both of any length: the cosine's negative, and the square of the chord, which
/// is exact for angles of any size but takes longer.
double negative_cosine(const Direction& d, const Direction& n) {
    return -(d[0] * n[0] + d[1] * n[1] + d[2] * n[2]) / length_of(d);
}
double squared_chord(const Direction& d, const Direction& n) {
    const double d_length = length_of(d), n_length = length_of(n);
    double sum = 0;
    for (size_t i = 0; i < 3; ++i) {
        const double part = d[i] / d_length - n[i] / n_length;
        sum += part * part;
    }
    return sum;
}

}  // namespace

uint64_t pack_octahedral(const Direction& normal, uint32_t bits) {
    const Direction n = scaled_direction(normal);
    const double l1 = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
    double u = n[0] / l1;
    double v = n[1] / l1;
    if (n[2] < 0) {
        const double folded = sign_of(u) * (1 - std::abs(v));
        v = sign_of(v) * (1 - std::abs(u));
        u = folded;
    }
    const int32_t side = octahedral_side(bits);
    const auto farness = [&](LatticePoint point) {
        const std::array<int32_t, 3> d = fold(static_cast<int32_t>(point.u), static_cast<int32_t>(point.v), side);
        const Direction direction = {static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2])};
        return bits <= kMostBitsByCosine ? negative_cosine(direction, n) : squared_chord(direction, n);
    };
    const LatticePoint low = {static_cast<int64_t>(std::floor(u * side)), static_cast<int64_t>(std::floor(v * side))};
    const LatticePoint best = nearest_of_cell(low, -side, side, farness);
    return static_cast<uint64_t>(best.u + side) | static_cast<uint64_t>(best.v + side) << bits;
}

std::array<int32_t, 3> unfold_octahedral(uint64_t packed, uint32_t bits) {
    const int32_t side = octahedral_side(bits);
    const auto centred = [&](uint64_t biased) {
        const auto value = static_cast<int64_t>(biased & ((uint64_t{1} << bits) - 1));
        return static_cast<int32_t>(std::min<int64_t>(value - side, side));
    };
    return fold(centred(packed), centred(packed >> bits), side);
}

Direction unpack_octahedral(uint64_t packed, uint32_t bits) {
    const std::array<int32_t, 3> d = unfold_octahedral(packed, bits);
    const Direction direction = {static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2])};
    const double length = length_of(direction);
    return {direction[0] / length, direction[1] / length, direction[2] / length};
}

std::array<float, 3> unpack_octahedral_float(uint64_t packed, uint32_t bits) {
    const std::array<int32_t, 3> d = unfold_octahedral(packed, bits);
    const auto x = static_cast<float>(d[0]), y = static_cast<float>(d[1]), z = static_cast<float>(d[2]);
    const float length = std::sqrt(x * x + y * y + z * z);
    return {x / length, y / length, z / length};
}

uint32_t pack_octahedral16(const float normal[3]) {
    return static_cast<uint32_t>(pack_octahedral({normal[0], normal[1], normal[2]}, 8));
}

void unfold_octahedral16(uint32_t packed, int32_t out[3]) {
    const std::array<int32_t, 3> d = unfold_octahedral(packed, 8);
    std::copy(d.begin(), d.end(), out);
}

void unpack_octahedral16(uint32_t packed, float out[3]) {
    const std::array<float, 3> unit = unpack_octahedral_float(packed, 8);
    std::copy(unit.begin(), unit.end(), out);
}

}  // namespace citystream::codec::mesh
