// The codecs that bench_mesh compares on whole files: ours, Draco, meshoptimizer and glTF files, all given the same
// welded triangles on the same grid.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "codec/mesh/mesh_wire.h"
#include "tests/bench/mesh_files.h"

namespace citystream::bench {

/// What is known of where bits go: parts by name.
using PartBits = std::vector<std::pair<std::string, double>>;

/// Of our layer: prisms, positions, topology (both of what is no prism, those of all steps), normals, attributes
/// (colours, charts, texture coordinates, which triangles are dressed).
PartBits bits_by_part(const codec::mesh::MeshWireBits& bits);

/// A coded mesh: one byte string for each thing that travels on its own.
struct CodedMesh {
    struct Part {
        std::string name;
        std::vector<std::byte> bytes;
        uint32_t decoded_bytes = 0;  ///< of a zstd frame, or of a layer in GPU memory
    };
    std::vector<Part> parts;
    uint32_t points = 0, indices = 0, bits = 0;
    double step = 1;  ///< of the grid
    PartBits bits_of{};
    uint64_t wire_bytes() const;
};

struct MeshCodec {
    std::string name;
    std::function<CodedMesh(const QuantisedMesh&, uint32_t bits)> encode;
    std::function<bool(const CodedMesh&, codec::mesh::GridMesh&)> decode;  ///< false: the bytes were refused
    /// What a renderer keeps of the mesh, coded and decoded.
    std::function<uint64_t(const CodedMesh&, const codec::mesh::GridMesh&)> resident_bytes;
};

/// default, draco, meshopt, glb-meshopt, glb.
std::vector<MeshCodec> mesh_codecs();

/// Equal as multisets of oriented triangles with their positions.
bool same_triangles(const codec::mesh::GridMesh& a, const codec::mesh::GridMesh& b);

}  // namespace citystream::bench
