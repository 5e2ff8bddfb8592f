// Any words as a mesh layer in GPU memory: what is accepted is read without leaving them, and every corner names a
// chart.
#include "codec/mesh/mesh_resident.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/chart_word.h"
#include "tests/fuzz/layer_words.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec::mesh;
    constexpr uint32_t kCharts = 5, kMostLookedAt = 3000;
    const auto words = citystream::words_of({data, size});
    const auto mesh = ResidentMeshView::create(words, kCharts);
    if (!mesh) return 0;
    const uint32_t triangles = mesh->triangle_count();
    // Positions without bits say any number of triangles in few words.
    for (uint32_t t = 0; t < triangles; t += std::max(1u, triangles / kMostLookedAt)) {
        const PositionView view = {{-77777, 123456, -5}, {300 + t, RESIDENT_CELL_BITS}, t % (kMeshGridBits + 1)};
        for (uint32_t k = 0; k < 3; ++k) {
            const ResidentCorner corner = mesh->corner(t, k, view);
            int32_t texcoord[2];
            mesh->texcoord(t, k, texcoord);
            if (corner.normal == std::array<int32_t, 3>{} || corner.chart_entry >= words.size()) std::abort();
        }
        if (!citystream::codec::is_chart_word(mesh->chart_word(t), kCharts)) std::abort();
    }
    return 0;
}
