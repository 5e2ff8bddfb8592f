// Any bytes as the steps of a mesh: a valid mesh that encodes to itself again, or an error, in bounded time and memory.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/mesh/geometry_wire.h"
#include "tests/codec/mesh/mesh_cases.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec::mesh;
    if (size == 0) return 0;
    // The first byte says, in 1/256 of the rest, where the second step begins; 0: there is none.
    const auto bytes = std::as_bytes(std::span(data, size).subspan(1));
    const size_t first = bytes.size() * data[0] / 256;
    std::vector<std::span<const std::byte>> steps = {bytes};
    if (data[0] != 0) steps = {bytes.first(first), bytes.subspan(first)};
    const auto mesh = decode_geometry(steps, {4096, 4096});
    if (!mesh) return 0;
    for (const auto& t : mesh->triangles) {
        for (const uint32_t v : t) {
            if (v >= mesh->points.size()) std::abort();
        }
    }
    const uint32_t dropped = 0;
    for (const GridPoint& p : mesh->points) {
        for (const int32_t v : p) {
            if (v <= -(1 << 30)) return 0;  // a cut coordinate may lie just outside what an encoder takes
        }
    }
    const auto coded = encode_geometry(*mesh, {&dropped, 1});
    const std::span<const std::byte> step = coded.steps[0];
    const auto again = decode_geometry({&step, 1});
    if (!again || triangles_by_place(*again) != triangles_by_place(*mesh)) std::abort();
    return 0;
}
