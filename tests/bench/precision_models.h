// Models in sub-meshes with normals, as precision benches want them.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "codec/mesh/binned_buffer.h"
#include "codec/mesh/grid_mesh.h"

namespace citystream::bench {

/// A vertex is a place and a normal; places with several normals are several vertices.
struct PrecisionPart {
    std::vector<codec::mesh::GridPoint> points;
    std::vector<float> normals;      ///< three a vertex
    std::vector<uint8_t> on_border;  ///< whether other parts have the place, too
    std::vector<std::array<uint32_t, 3>> triangles;

    std::vector<double> corner_normals() const;
};

struct PrecisionModel {
    std::string name;
    std::vector<PrecisionPart> parts;
    std::array<double, 3> centre{};  ///< grid units
    double extent = 0;               ///< longest side, grid units
    double ground = 0;               ///< lowest height, grid units
    double units_a_metre = 0;        ///< of cities; 0: another model

    uint64_t vertices() const;
};

/// Cuts a mesh into parts of a cubic lattice, as many as make about `triangles_a_part`, with smooth normals where faces
/// meet at less than 35 degrees. Deterministic.
PrecisionModel precision_model(const std::string& name, const codec::mesh::GridMesh& mesh, size_t triangles_a_part);

/// A part as adaptive (most_dropped empty) or constrained positions, with all else in the same order.
struct PackedPart {
    codec::mesh::PositionWords positions;
    std::vector<float> normals;
    std::vector<uint32_t> indices;
    std::array<uint32_t, 3> low{}, high{};  ///< of the words
};
PackedPart pack_part(const PrecisionPart& part, std::span<const uint32_t> most_dropped, uint32_t common_dropped,
                     codec::mesh::Reconstruction reading);

}  // namespace citystream::bench
