// Any bytes as the normals of a mesh that is made from the first of them: what decodes are canonical codes, which
// encode to what decodes the same.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/mesh/corner_normals.h"
#include "codec/mesh/octahedral_residual.h"

namespace {

constexpr size_t kHeadBytes = 34;  // bits a parameter, triangles, 32 of coordinates and indices

/// Folded strips of up to 63 triangles, some of them degenerate.
citystream::codec::mesh::GridMesh mesh_of(std::span<const uint8_t> head) {
    citystream::codec::mesh::GridMesh mesh;
    const uint32_t count = head[1] % 64;
    const auto byte = [&](uint32_t i) { return static_cast<int32_t>(head[2 + i % 32]); };
    for (uint32_t i = 0; i < count + 2; ++i)
        mesh.points.push_back(
            {static_cast<int32_t>(100 * i), byte(i) << (i % 23), byte(3 * i + 1) * (i % 2 == 0 ? 9 : -9)});
    for (uint32_t i = 0; i < count; ++i)
        mesh.triangles.push_back(
            {i, i + 1 + static_cast<uint32_t>(byte(i) % 2), static_cast<uint32_t>(byte(i + 7)) % (count + 2)});
    return mesh;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    namespace mesh = citystream::codec::mesh;
    if (size < kHeadBytes) return 0;
    const auto input = std::span(data, size);
    const uint32_t bits = 2 + input[0] % (mesh::kMostCornerNormalBits - 1);
    const mesh::GridMesh shape = mesh_of(input.first(kHeadBytes));
    const auto codes = mesh::decode_corner_normals(shape, bits, std::as_bytes(input.subspan(kHeadBytes)));
    if (!codes) return 0;
    if (codes->size() != 3 * shape.triangles.size()) std::abort();
    for (const uint64_t code : *codes) {
        if (mesh::canonical_octahedral(code, bits) != code) std::abort();
    }
    const auto again = mesh::decode_corner_normals(shape, bits, mesh::encode_corner_normals(shape, *codes, bits));
    if (!again || *again != *codes) std::abort();
    return 0;
}
