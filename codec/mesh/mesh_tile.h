// A tile's triangles as the builder makes them, before anything is quantised but positions.
#pragma once

#include <cstdint>
#include <vector>

namespace citystream::codec::mesh {

/// A coordinate, and the extent of a tile, must be below 2^30 grid units (1,048 km); make_content asks for less.
inline constexpr uint32_t kMaxCoordinateBits = 30;

struct MeshVertex {
    int32_t position[3];  ///< grid units (2^-10 m) from the tile's minimum corner (x, y) and base height (z)
    float normal[3];      ///< unit length (the encoder takes any length; zero and non-finite mean +z)
    int32_t texcoord[2];  ///< 2^-16 repeats of the chart's image, v upwards
    friend bool operator==(const MeshVertex&, const MeshVertex&) = default;
};

/// Triangles [dressed_begin, count) are the flat stand-ins of walls that the facade layer can replace.
struct MeshTile {
    std::vector<MeshVertex> vertices;
    std::vector<uint32_t> indices;         ///< 3 a triangle, counter-clockwise from outside
    std::vector<uint32_t> triangle_chart;  ///< chart word (codec/chart_word.h), one a triangle
    uint32_t dressed_begin = 0;            ///< in triangles
};

}  // namespace citystream::codec::mesh
