// Any bytes as the steps of a mesh layer, in any transport: what is accepted becomes GPU words whose view accepts them,
// and names no chart that is not there. The first byte says how many steps follow, each but the last a two-byte length
// before it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/chart_word.h"
#include "codec/mesh/mesh_layer.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec;
    constexpr uint32_t kCharts = 4, kDecodedBytes = 1 << 16;
    if (size < 1) return 0;
    std::span<const uint8_t> rest(data + 1, size - 1);
    std::vector<std::span<const std::byte>> wire;
    for (uint32_t i = data[0] % mesh::kMostMeshSteps; i > 0 && rest.size() >= 2; --i) {
        const size_t length = std::min<size_t>(rest[0] | rest[1] << 8, rest.size() - 2);
        wire.push_back(std::as_bytes(rest.subspan(2, length)));
        rest = rest.subspan(2 + length);
    }
    wire.push_back(std::as_bytes(rest));
    const auto content = mesh::decode_mesh_content(wire, kDecodedBytes, kCharts);
    if (!content) return 0;
    const auto resident = mesh::make_resident(*content);
    const auto words = resident.with_steps(static_cast<uint32_t>(wire.size()));
    const auto view = mesh::ResidentMeshView::create(words, kCharts);
    if (!view) std::abort();
    for (uint32_t triangle = 0; triangle < view->triangle_count(); ++triangle) {
        if (!is_chart_word(view->chart_word(triangle), kCharts)) std::abort();
    }
    return 0;
}
