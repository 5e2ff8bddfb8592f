// Any bytes as the steps of a mesh layer: valid content that encodes to itself again, or an error, in bounded time and
// memory.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/mesh/mesh_wire.h"
#include "tests/codec/mesh/mesh_contents.h"

namespace {

using namespace citystream::codec;
using namespace citystream::codec::mesh;

/// What an encoder may be given: coordinates that were cut may lie just outside.
bool is_on_grid(const MeshContent& content) {
    for (const GridPoint& p : content.points) {
        for (const int32_t v : p) {
            if (v <= -(1 << 30)) return false;
        }
    }
    for (const MeshPrism& prism : content.prisms) {
        if (prism.shape.base >= prism.shape.top) return false;
    }
    return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size == 0) return 0;
    // The first byte says, in 1/256 of the rest, where the second step begins; 0: there is none.
    const auto bytes = std::as_bytes(std::span(data, size).subspan(1));
    const size_t first = bytes.size() * data[0] / 256;
    std::vector<std::span<const std::byte>> steps = {bytes};
    if (data[0] != 0) steps = {bytes.first(first), bytes.subspan(first)};
    auto content = decode_mesh_wire(steps, {4096, 4096});
    if (!content) return 0;
    for (const MeshTriangle& t : content->triangles) {
        for (const MeshCorner& c : t.corners) {
            if (c.point >= content->points.size()) std::abort();
        }
    }
    if (!is_on_grid(*content)) return 0;
    content->dropped = {0};
    content->most_dropped.clear();
    const MeshWire wire = encode_mesh_wire(*content);
    const std::span<const std::byte> step = wire.steps[0];
    const auto again = decode_mesh_wire({&step, 1});
    if (!again || told_triangles(*again, 0) != told_triangles(*content, 0)) std::abort();
    if (again->prisms.size() != content->prisms.size()) std::abort();
    return 0;
}
