// Any bytes as a mesh layer of the Draco transport: an error, or content that can be made a layer of again.
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/mesh/draco_transport.h"
#include "codec/mesh/mesh_triangles.h"

using namespace citystream::codec::mesh;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    constexpr MeshLimits kLimits = {1u << 16, 1u << 15};
    const auto bytes = std::as_bytes(std::span(data, size));
    const auto content = decode_draco_mesh(bytes, kLimits);
    if (!content) return 0;
    if (content->points.size() > kLimits.points || content->triangles.size() > kLimits.triangles) std::abort();
    for (const MeshTriangle& triangle : content->triangles) {
        for (const MeshCorner& corner : triangle.corners) {
            if (corner.point >= content->points.size()) std::abort();
            if (corner.normal >> (2 * content->normal_bits) != 0 && content->normal_bits < 16) std::abort();
        }
    }
    uint64_t visited = 0;
    for_each_triangle(*content, [&](const PlacedTriangle&) { ++visited; });
    if (visited != triangle_count(*content)) std::abort();
    return 0;
}
