// Positions and indices by meshoptimizer's codecs, in the order that it compresses best.
#pragma once

#include <meshoptimizer.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "codec/mesh/grid_mesh.h"

namespace citystream::bench {

struct MeshoptArrays {
    std::vector<unsigned char> vertices, indices;
    size_t vertex_count = 0, index_count = 0;
};

/// Row: an array of 3 or 4 coordinates, its size a multiple of 4 bytes.
template <typename Row>
MeshoptArrays encode_meshopt_arrays(const codec::mesh::GridMesh& mesh) {
    std::vector<Row> rows(mesh.points.size()), fetched(mesh.points.size());
    for (size_t v = 0; v < rows.size(); ++v) {
        for (size_t c = 0; c < 3; ++c) rows[v][c] = static_cast<typename Row::value_type>(mesh.points[v][c]);
    }
    const uint32_t* given = mesh.triangles.empty() ? nullptr : mesh.triangles[0].data();
    std::vector<uint32_t> indices(3 * mesh.triangles.size());
    meshopt_optimizeVertexCacheStrip(indices.data(), given, indices.size(), rows.size());
    MeshoptArrays coded;
    coded.index_count = indices.size();
    coded.vertex_count = meshopt_optimizeVertexFetch(fetched.data(), indices.data(), indices.size(), rows.data(),
                                                     rows.size(), sizeof(Row));
    coded.vertices.resize(meshopt_encodeVertexBufferBound(coded.vertex_count, sizeof(Row)));
    coded.vertices.resize(meshopt_encodeVertexBuffer(coded.vertices.data(), coded.vertices.size(), fetched.data(),
                                                     coded.vertex_count, sizeof(Row)));
    coded.indices.resize(meshopt_encodeIndexBufferBound(indices.size(), coded.vertex_count));
    coded.indices.resize(
        meshopt_encodeIndexBuffer(coded.indices.data(), coded.indices.size(), indices.data(), indices.size()));
    return coded;
}

/// False: the bytes were refused.
template <typename Row>
bool decode_meshopt_arrays(std::span<const unsigned char> vertices, size_t vertex_count,
                           std::span<const unsigned char> indices, size_t index_count, codec::mesh::GridMesh& out) {
    std::vector<Row> rows(vertex_count);
    if (meshopt_decodeVertexBuffer(rows.data(), rows.size(), sizeof(Row), vertices.data(), vertices.size()) != 0)
        return false;
    out.points.resize(rows.size());
    for (size_t v = 0; v < rows.size(); ++v) {
        for (size_t c = 0; c < 3; ++c) out.points[v][c] = static_cast<int32_t>(rows[v][c]);
    }
    out.triangles.resize(index_count / 3);
    return meshopt_decodeIndexBuffer(out.triangles.data(), index_count, sizeof(uint32_t), indices.data(),
                                     indices.size()) == 0;
}

}  // namespace citystream::bench
