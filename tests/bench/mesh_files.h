// Meshes for codec benches: the triangles of a file, city model or plain mesh, on a grid of so many bits.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "codec/mesh/grid_mesh.h"
#include "codec/result.h"

namespace citystream::bench {

struct SourceMesh {
    std::vector<std::array<double, 3>> points;  ///< metres, or the file's unit
    std::vector<std::array<uint32_t, 3>> triangles;
    uint64_t buildings = 0;   ///< 0 in files that know none
    bool has_ground = false;  ///< terrain, land use, roads or water
};

/// What is in `path`: OBJ, PLY or STL (by name, also with .xz after it), else a city model (every format that read_city
/// takes; a folder: all city models below it as one). Floors of buildings are left out, polygons of plain meshes become
/// fans. Error: the file cannot be read or has no triangle.
Result<SourceMesh> read_mesh_file(const std::string& path);

/// The generated city (tiles/city/generator.h), terrain included.
SourceMesh generated_mesh(uint32_t buildings, uint64_t seed);

/// The mesh with its longest side cut into 2^bits - 1 steps (bits 1..29): points welded by position and in order of
/// first use, triangles of fewer than three points left out.
struct QuantisedMesh {
    codec::mesh::GridMesh mesh;
    double step = 0;       ///< of the grid, in the file's unit
    double max_error = 0;  ///< largest distance of a point to the one it became
};
QuantisedMesh quantise(const SourceMesh& source, uint32_t bits);

}  // namespace citystream::bench
