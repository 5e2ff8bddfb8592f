#include "codec/mesh/direction.h"

#include <algorithm>
#include <cmath>

namespace citystream::codec::mesh {

namespace {

double length_of(const Direction& d) {
    return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

}  // namespace

template <typename Real>
std::array<Real, 3> scaled_direction(const std::array<Real, 3>& vector) {
    Real largest = 0;
    for (const Real c : vector) {
        if (!std::isfinite(c)) return {0, 0, 1};
        largest = std::max(largest, std::abs(c));
    }
    if (largest == 0) return {0, 0, 1};
    return {vector[0] / largest, vector[1] / largest, vector[2] / largest};
}

template std::array<float, 3> scaled_direction(const std::array<float, 3>&);
template std::array<double, 3> scaled_direction(const std::array<double, 3>&);

Direction unit_direction(const Direction& vector) {
    const Direction d = scaled_direction(vector);
    const double length = length_of(d);
    return {d[0] / length, d[1] / length, d[2] / length};
}

double angle_between(const Direction& a, const Direction& b) {
    const Direction m = scaled_direction(a), n = scaled_direction(b);
    const Direction cross = {m[1] * n[2] - m[2] * n[1], m[2] * n[0] - m[0] * n[2], m[0] * n[1] - m[1] * n[0]};
    return std::atan2(length_of(cross), m[0] * n[0] + m[1] * n[1] + m[2] * n[2]);
}

}  // namespace citystream::codec::mesh
