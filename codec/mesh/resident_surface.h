// The triangles that are not prisms as ranges of vertices (RESIDENT.md): by whether they are dressed, and by what their
// vertices need. Where all that is shown belongs to faces, vertices are the welded points.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/mesh/mesh_content.h"
#include "codec/mesh/resident_charts.h"

namespace citystream::codec::mesh {

struct SurfaceVertex {
    uint32_t point = 0;
    uint32_t texcoord = 0;  ///< q_u | q_v << 16; 0 in ranges without
    uint32_t normal = 0;    ///< code; 0 in ranges without
    friend bool operator==(const SurfaceVertex&, const SurfaceVertex&) = default;
};

struct SurfaceRange {
    bool dressed = false, textured = false, smooth = false;
    std::vector<SurfaceVertex> vertices;  ///< in order of first use
    std::vector<std::array<uint32_t, 3>> triangles;
    std::vector<SurfaceFace> faces;  ///< one a triangle; with normals of vertices no normal
};

/// Ranges in order, none empty; undressed ones first. Classes of few triangles join one whose vertices hold more.
/// O(triangles log charts).
std::vector<SurfaceRange> split_surface(const MeshContent& content, const ResidentCharts& charts);

/// A range's topology as it lies in the layer.
struct RangeTopology {
    uint32_t kind = 0;  ///< RESIDENT_KIND_*
    std::vector<uint32_t> words;
    uint32_t index_bits = 0;  ///< of indices
};

/// Writes the topology in the wanted form, or as indices where that is no larger; brings vertices, triangles and faces
/// of the range into the order of what was written, with triangles that a strip code puts in.
RangeTopology lay_topology(SurfaceRange& range, MeshTopology wanted);

}  // namespace citystream::codec::mesh
