#include "codec/mesh/octahedral_residual.h"

#include <cstdlib>

#include "codec/mesh/octahedral.h"

namespace citystream::codec::mesh {

namespace {

using Place = std::array<int64_t, 2>;

/// Of a vector on the octahedron: unfold_octahedral's inverse, at the rim the place with the larger coordinates.
Place place_of(const std::array<int32_t, 3>& d, int64_t side) {
    if (d[2] >= 0) return {d[0], d[1]};
    const int64_t u = side - std::abs(int64_t{d[1]}), v = side - std::abs(int64_t{d[0]});
    return {d[0] < 0 ? -u : u, d[1] < 0 ? -v : v};
}

uint64_t code_of(const Place& place, int64_t side, uint32_t bits) {
    return static_cast<uint64_t>(place[0] + side) | static_cast<uint64_t>(place[1] + side) << bits;
}

/// The place of a code, of its mirror image if `mirrored`.
Place place_of_code(uint64_t packed, bool mirrored, uint32_t bits) {
    std::array<int32_t, 3> d = unfold_octahedral(packed, bits);
    if (mirrored) d[2] = -d[2];
    return place_of(d, octahedral_side(bits));
}

bool is_lower(uint64_t packed, uint32_t bits) {
    return unfold_octahedral(packed, bits)[2] < 0;
}

int64_t wrapped(int64_t value, int64_t side) {
    const int64_t count = 2 * side + 1;
    const int64_t rest = (value + side) % count;
    return (rest < 0 ? rest + count : rest) - side;
}

}  // namespace

uint64_t canonical_octahedral(uint64_t packed, uint32_t bits) {
    return code_of(place_of_code(packed, false, bits), octahedral_side(bits), bits);
}

uint64_t fold_octahedral(const std::array<int32_t, 3>& direction, uint32_t bits) {
    const int64_t side = octahedral_side(bits);
    return code_of(place_of(direction, side), side, bits);
}

std::array<int32_t, 2> octahedral_residual(uint64_t actual, uint64_t predicted, uint32_t bits) {
    const int64_t side = octahedral_side(bits);
    const bool mirrored = is_lower(predicted, bits);
    const Place a = place_of_code(actual, mirrored, bits), p = place_of_code(predicted, mirrored, bits);
    return {static_cast<int32_t>(wrapped(a[0] - p[0], side)), static_cast<int32_t>(wrapped(a[1] - p[1], side))};
}

uint64_t octahedral_of_residual(const std::array<int32_t, 2>& residual, uint64_t predicted, uint32_t bits) {
    const int64_t side = octahedral_side(bits);
    const bool mirrored = is_lower(predicted, bits);
    const Place p = place_of_code(predicted, mirrored, bits);
    const Place a = {wrapped(p[0] + residual[0], side), wrapped(p[1] + residual[1], side)};
    return code_of(place_of_code(code_of(a, side, bits), mirrored, bits), side, bits);
}

}  // namespace citystream::codec::mesh
