// What unit vectors are used for, so that bench_unit_vectors can say what their errors do: shading, normal maps and the
// faces of cities; and a spread of points that is more even than any parameterisation's.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "codec/mesh/direction.h"
#include "codec/result.h"

namespace citystream::bench {

/// Radians from each of some unit vectors to the nearest of `count` points on a spherical Fibonacci spiral (Keinert et
/// al. 2015), found among the points of its latitudes.
std::vector<double> distances_to_fibonacci(const std::vector<codec::mesh::Direction>& directions, uint32_t count);

/// A highlight on a gently curved sheet (Blinn and Phong's, one directional light), whose normals lie round the
/// octahedron's worst direction, against the same with normals in floats.
struct HighlightError {
    std::string format;
    uint32_t bits = 0, pixels = 0, differ_at_8 = 0, differ_at_13 = 0;  ///< pixels that differ at so many bits a colour
    double psnr = 0;
};
std::vector<HighlightError> highlight_errors();

/// Texels of a tangent-space normal map.
struct TexelError {
    std::string texel;
    uint32_t bytes = 0;
    double largest = 0, mean = 0;  ///< radians
    bool flat_is_exact = false;
};
/// Of directions all over the half sphere, or of slopes that are gentle (standard deviation 0.3) as in most maps.
std::vector<TexelError> texel_errors(bool gentle);

/// A triangle or facade wall.
struct Face {
    codec::mesh::Direction normal = {};
    double area = 0;
};
std::vector<Face> faces_generated(uint32_t buildings, uint64_t seed);
Result<std::vector<Face>> faces_of_file(const std::string& file);

}  // namespace citystream::bench
