// Directions of light: cells of a cube around the point, as a cube map has its texels.
//
// A grid of side S has 6 x S x S cells, numbered (face * S + row) * S + column. Faces and their axes are those of
// Vulkan and of OpenImageIO's cube maps: +x, -x, +y, -y, +z, -z; on a face with major axis m, column c and row r have
// s = (2c + 1 - S) / S, t = (2r + 1 - S) / S and directions
//   +x (1, -t, -s)  -x (-1, -t, s)  +y (s, 1, t)  -y (s, -1, -t)  +z (s, -t, 1)  -z (-s, -t, -1).
// The axes are the world's: x east, y north, z up; a map that has y up is turned by whoever loads it.
//
// Source texels are the cells of a grid of side n; the rays that say what a receiver sees are the cells of one of side
// 2n (kSamplesAcross to a texel's side), so that a texel's visibility is a number of quarters (Sun et al. 2011, section
// 4.1: 2^m x 2^m down-sampling, m = 1).
#pragma once

#include <array>
#include <cstdint>

namespace citystream::codec::radiance {

inline constexpr uint32_t kCubeFaces = 6;
inline constexpr uint32_t kSamplesAcross = 2;
inline constexpr uint32_t kSamplesInTexel = kSamplesAcross * kSamplesAcross;
/// Texels on a side: 1..kMostCubeSide, so that a texel's number has 16 bits.
inline constexpr uint32_t kMostCubeSide = 64;

/// A vector of any length in integers: exact, whatever the machine.
using GridDirection = std::array<int32_t, 3>;

constexpr uint32_t cube_cells(uint32_t side) {
    return kCubeFaces * side * side;
}
constexpr uint32_t texel_count(uint32_t texels_across) {
    return cube_cells(texels_across);
}
/// The cube that has so many texels; 0: none has.
constexpr uint32_t texels_across_of(uint64_t texels) {
    for (uint32_t side = 1; side <= kMostCubeSide; ++side) {
        if (texel_count(side) == texels) return side;
    }
    return 0;
}
constexpr uint32_t sample_count(uint32_t texels_across) {
    return cube_cells(kSamplesAcross * texels_across);
}

/// Centre of a cell times `side`: the major axis is +-side, the others are below it in magnitude.
GridDirection cell_direction(uint32_t side, uint32_t cell);

/// The scalar product of a vector with the centres of a face's cells (cell_direction), which is linear in column and
/// row.
struct FaceProduct {
    int64_t first = 0, right = 0, down = 0;
    int64_t at(uint32_t column, uint32_t row) const { return first + int64_t{column} * right + int64_t{row} * down; }
};
/// Components below 2^40 in magnitude.
FaceProduct face_product(const std::array<int64_t, 3>& vector, uint32_t side, uint32_t face);

/// The cell that holds a direction of any length. Of components of the same size z goes before y and y before x, as
/// Vulkan has it; on a border between cells of one face the one with the greater number. Zero is +z.
uint32_t cell_of(const std::array<double, 3>& direction, uint32_t side);
/// The same in integers, exactly. Components below 2^31 in magnitude.
uint32_t cell_of(const std::array<int64_t, 3>& direction, uint32_t side);

/// Texel of a sample; both numbered as cells, for a source of so many texels on a side.
uint32_t texel_of_sample(uint32_t texels_across, uint32_t sample);

/// Steradians: A(x1, y1) - A(x0, y1) - A(x1, y0) + A(x0, y0) with A(x, y) = atan2(xy, sqrt(x^2 + y^2 + 1)). All cells
/// add up to 4 pi.
double cell_solid_angle(uint32_t side, uint32_t cell);

/// Mean of the unit vectors to all points of a cell, a little shorter than they are: the vector irradiance of even
/// light over the cell, divided by its solid angle. Exact: half the sum over the cell's edges of the angle each spans
/// times the unit normal of its plane (Lambert 1760, as Arvo 1994 has it for polygons).
std::array<double, 3> cell_mean_direction(uint32_t side, uint32_t cell);

}  // namespace citystream::codec::radiance
