// How many bits a vertex may drop without its surroundings being shaded differently (Meyer 2012, section 3.5.1, P5):
// where a position moves, a pixel shows another place of its triangle, with other normals or texture coordinates.
//
// For a triangle with corners p and attributes a in R^k, E_t = ||A M^-1|| (spectral norm) is how fast the attributes
// change along it. A movement of eps / (k_f E_t) changes what is shaded by eps, where k_f bounds the slope of shading
// (erratum of the printed text: a vertex takes the *finest* of what its triangles ask for). A flat-shaded face asks for
// nothing.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/grid_mesh.h"

namespace citystream::codec::mesh {

/// k_f of Blinn-Phong with exponent s and intensities of at most 1 (with the erratum of J J^T): s + 1. Pictures need
/// less; it is a knob.
constexpr double blinn_slope(double exponent) {
    return exponent + 1;
}
/// k_f of texture coordinates in repeats of an image (erratum: the greater of both): neighbours black and white.
constexpr double texture_slope(uint32_t width, uint32_t height) {
    return width > height ? width : height;
}

/// E_t in attribute units a grid unit. `attributes`: k of each corner, one corner after the other. 0 where they are the
/// same at all corners; infinity where they are not and the triangle has no area (no movement is allowed).
double attribute_slope(const std::array<GridPoint, 3>& corners, std::span<const double> attributes);

/// What one kind of attribute asks for.
struct AttributeLimit {
    std::span<const double> corner_values;  ///< `dimensions` for each corner of each triangle, in order
    uint32_t dimensions = 3;
    double error = 1.0 / 255;  ///< eps: allowed change of a colour of 0..1
    double slope = 1;          ///< k_f
};

/// Most dropped bits of each vertex, 0..common_dropped, the same for all vertices at one position (else cracks).
/// `on_border` (empty: none): vertices that other tiles may have, too; they follow adaptive precision alone,
/// common_dropped, because two tiles do not see each other's triangles. O((triangles + vertices) log vertices).
std::vector<uint32_t> constrained_dropped(std::span<const GridPoint> points,
                                          std::span<const std::array<uint32_t, 3>> triangles,
                                          std::span<const AttributeLimit> limits, std::span<const uint8_t> on_border,
                                          uint32_t common_dropped);

/// Gives all vertices at one position the least of their values.
void share_among_duplicates(std::span<const GridPoint> points, std::span<uint32_t> dropped);

}  // namespace citystream::codec::mesh
