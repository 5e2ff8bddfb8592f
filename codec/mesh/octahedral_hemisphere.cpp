#include "codec/mesh/octahedral_hemisphere.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "codec/mesh/lattice_cell.h"
#include "codec/mesh/octahedral.h"

namespace citystream::codec::mesh {

namespace {

std::array<int64_t, 3> unfold(int64_t u, int64_t v, int64_t side) {
    return {u + v, v - u, 2 * (side - std::max(std::abs(u), std::abs(v)))};
}

Direction unit_of(const std::array<int64_t, 3>& d) {
    return unit_direction({static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2])});
}

}  // namespace

uint64_t pack_hemisphere(const Direction& normal, uint32_t bits) {
    Direction n = scaled_direction(normal);
    n[2] = std::max(n[2], 0.0);
    n = unit_direction(n);
    const double l1 = std::abs(n[0]) + std::abs(n[1]) + n[2];
    const int64_t side = octahedral_side(bits);
    const auto squared_chord = [&](LatticePoint point) {
        const Direction d = unit_of(unfold(point.u, point.v, side));
        double sum = 0;
        for (size_t i = 0; i < 3; ++i) sum += (d[i] - n[i]) * (d[i] - n[i]);
        return sum;
    };
    const auto below = [&](double place) {
        return static_cast<int64_t>(std::floor(place / l1 * static_cast<double>(side)));
    };
    const LatticePoint best = nearest_of_cell({below(n[0] - n[1]), below(n[0] + n[1])}, -side, side, squared_chord);
    return static_cast<uint64_t>(best.u + side) | static_cast<uint64_t>(best.v + side) << bits;
}

std::array<int64_t, 3> unfold_hemisphere(uint64_t packed, uint32_t bits) {
    const int64_t side = octahedral_side(bits);
    const auto centred = [&](uint64_t biased) {
        return std::min(static_cast<int64_t>(biased & ((uint64_t{1} << bits) - 1)) - side, side);
    };
    return unfold(centred(packed), centred(packed >> bits), side);
}

Direction unpack_hemisphere(uint64_t packed, uint32_t bits) {
    return unit_of(unfold_hemisphere(packed, bits));
}

}  // namespace citystream::codec::mesh
