#include "codec/mesh/flat_normals.h"

#include <algorithm>
#include <span>

#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_residual.h"
#include "codec/mesh/triangle_plane.h"

namespace citystream::codec::mesh {

namespace {

uint32_t code_of(const Direction& direction, uint32_t bits) {
    return static_cast<uint32_t>(canonical_octahedral(pack_octahedral(direction, bits), bits));
}

/// Whether a unit vector lies within the greatest error of a code, sqrt(2) * 2 / 2S (octahedral.h), of all the others,
/// which may be of any length. By chords, which are exact for small angles.
bool is_near(const Direction& unit, std::span<const Direction> others, uint32_t bits) {
    const double side = octahedral_side(bits);
    return std::all_of(others.begin(), others.end(), [&](const Direction& other) {
        const Direction o = unit_direction(other);
        double chord = 0;
        for (size_t c = 0; c < 3; ++c) chord += (o[c] - unit[c]) * (o[c] - unit[c]);
        return chord * side * side <= 2;
    });
}

Direction plane_at(std::array<GridPoint, 3> corners, uint32_t dropped) {
    for (GridPoint& corner : corners) {
        for (int32_t& c : corner) c = c >> dropped << dropped;
    }
    return plane_vector(corners);
}

}  // namespace

TriangleNormals triangle_normals(const std::array<GridPoint, 3>& corners, const std::array<Direction, 3>& given,
                                 uint32_t normal_bits, uint32_t coarsest, uint32_t finest) {
    TriangleNormals out;
    for (size_t k = 0; k < 3; ++k) out.codes[k] = code_of(given[k], normal_bits);
    if (out.codes[0] != out.codes[1] || out.codes[1] != out.codes[2]) return out;
    for (const uint32_t dropped : {coarsest, finest}) {
        const Direction plane = plane_at(corners, dropped);
        const uint32_t code = code_of(plane, normal_bits);
        if (plane == Direction{} || !is_near(unpack_octahedral(code, normal_bits), given, normal_bits)) continue;
        out.codes.fill(code);
        break;
    }
    const Direction plane = plane_vector(corners);
    out.of_plane = plane != Direction{} && is_near(unit_direction(plane), given, normal_bits);
    return out;
}

}  // namespace citystream::codec::mesh
