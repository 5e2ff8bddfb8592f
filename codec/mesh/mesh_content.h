// What a tile's mesh layer says, as both its forms have it: on the wire (mesh_wire.h) and in GPU memory
// (mesh_resident.h). Points are welded by place; charts, normals and texture coordinates belong to triangles and
// corners, so that hard edges and texture seams do not cut the surface; vertical walls of one colour under flat tops
// of one colour are prisms.
//
// Coordinates are grid units (2^-10 m) from the tile's minimum corner and base height *plus kMeshBias*. Both corner
// and base height are multiples of every step's 2^dropped, so that cutting low bits off cuts at the same places in all
// tiles; known bits are read as kThirds (precision.h): with the bias taken off again a multiple of 2^s is exact
// whatever was cut, and no coordinate is off by more than two thirds of 2^s.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/mesh/grid_mesh.h"
#include "codec/mesh/prisms.h"

namespace citystream::codec::mesh {

/// No step drops more bits, and origins of positions are multiples of 2^this, less the bias.
inline constexpr uint32_t kMeshGridBits = 16;
inline constexpr int32_t kMeshBias = 0x5555;  ///< PRECISION_THIRDS_PATTERN in kMeshGridBits bits
inline constexpr uint32_t kMostMeshSteps = 4;
/// Bits a parameter of an octahedral normal.
inline constexpr uint32_t kLeastMeshNormalBits = 4, kMostMeshNormalBits = 16;

/// How the triangles that are not prisms lie in GPU memory: the builder chooses, the layer says.
enum class MeshTopology : uint8_t {
    kIndices = 0,      ///< fields of as many bits as the largest index has
    kLocalStrips = 1,  ///< local_strips.h: random access, no pass before drawing
    kStripCode = 2     ///< strip_code.h: fewest bits, decoded by the GPU before drawing
};

struct MeshCorner {
    uint32_t point = 0;
    uint32_t normal = 0;                ///< octahedral code (octahedral.h) of normal_bits a parameter
    std::array<int32_t, 2> texcoord{};  ///< 2^-16 repeats of the chart's image; 0 where the triangle has one colour
    friend bool operator==(const MeshCorner&, const MeshCorner&) = default;
};

struct MeshTriangle {
    std::array<MeshCorner, 3> corners;  ///< counter-clockwise from outside
    uint32_t chart_word = 0;            ///< codec/chart_word.h
    bool dressed = false;               ///< flat stand-in of a wall that the facade layer can replace
    friend bool operator==(const MeshTriangle&, const MeshTriangle&) = default;
};

/// Each face of a prism has the normal of its plane at full precision; all walls have one colour, so has the top, and
/// the floor.
struct MeshPrism {
    Prism shape;
    uint32_t wall_chart = 0, top_chart = 0, floor_chart = 0;  ///< chart words that name colours
};

struct MeshContent {
    /// Low bits that each step leaves out: 1..kMostMeshSteps entries, strictly decreasing, at most kMeshGridBits.
    std::vector<uint32_t> dropped = {0};
    uint32_t normal_bits = 8;  ///< a parameter
    MeshTopology topology = MeshTopology::kIndices;
    std::vector<MeshPrism> prisms;
    std::vector<GridPoint> points;  ///< bits that are not known are 0
    std::vector<MeshTriangle> triangles;
    /// Constrained precision: bits that a point may drop at most, one number a point; empty: no more than each step
    /// says. Points that share a place have the same.
    std::vector<uint8_t> most_dropped;
};

}  // namespace citystream::codec::mesh
