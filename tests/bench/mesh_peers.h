// The representations that bench_mesh compares: our mesh layer, Draco, meshoptimizer and plain arrays, all of the same
// triangles with the same precision: positions on the 2^-10 m grid, normals of 8 + 8 bits, 16-bit texture coordinates
// within a chart, a chart for every triangle.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "codec/mesh/mesh_layer.h"
#include "tests/bench/mesh_codecs.h"

namespace citystream::bench {

/// A vertex as a renderer would keep it without a codec of its own.
struct PeerVertex {
    std::array<uint32_t, 3> position;  ///< grid units from the mesh's minimum corner
    std::array<uint16_t, 2> texcoord;  ///< code within the chart's span
    uint16_t normal;                   ///< octahedral, 8 + 8 bits
    uint16_t chart;                    ///< in PeerMesh::chart_names
    friend auto operator<=>(const PeerVertex&, const PeerVertex&) = default;
};
static_assert(sizeof(PeerVertex) == 20);

/// Full precision, as a plain renderer uploads it.
struct RawVertex {
    std::array<float, 3> position, normal;
    std::array<float, 2> texcoord;
    uint32_t chart;
};
static_assert(sizeof(RawVertex) == 36);

/// One tile, ready for every representation. Without triangles of no area, which Draco leaves out; corners that are
/// the same to a PeerVertex are one vertex.
struct PeerMesh {
    codec::mesh::MeshTile tile;
    std::vector<PeerVertex> vertices;
    std::vector<RawVertex> raw;
    std::vector<uint32_t> indices;
    std::vector<uint32_t> chart_names;  ///< charts of the tile, ascending: their numbers may take more than 16 bits
    uint32_t charts = 0;
};
PeerMesh make_peer_mesh(const codec::mesh::MeshTile& tile);

/// What travels: byte strings, and for each the number of bytes that it holds decoded where the decoder must be told.
struct Wire {
    std::vector<std::vector<std::byte>> parts;
    std::vector<uint32_t> decoded_bytes;
    uint32_t vertices = 0, indices = 0, charts = 0;
    PartBits bits_of{};
    uint64_t bytes() const;
};

/// What is kept for drawing; each representation fills what it draws from.
struct Resident {
    std::vector<uint32_t> words;  ///< of our layer
    codec::mesh::MeshTile tile;   ///< what they show
    std::vector<PeerVertex> vertices;
    std::vector<RawVertex> raw;
    std::vector<uint32_t> indices;
    uint64_t bytes() const;
};

/// A corner as compared after a round trip: grid position from the minimum corner, and chart.
using Corner = std::array<uint32_t, 4>;
/// All triangles, each turned to begin with its least corner, sorted.
using Triangles = std::vector<std::array<Corner, 3>>;

struct Representation {
    std::string name;
    std::function<Wire(const PeerMesh&)> encode;
    std::function<bool(const Wire&, Resident&)> decode;  ///< false: the bytes were refused
};

/// default, draco, meshopt, packed (the 20-byte vertices), raw (the 36-byte ones), these three in zstd frames.
std::vector<Representation> mesh_representations();

Triangles triangles_of(const PeerMesh& mesh);
Triangles triangles_of(const Resident& resident, const PeerMesh& of);

}  // namespace citystream::bench
