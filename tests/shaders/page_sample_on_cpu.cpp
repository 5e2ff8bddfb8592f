#include "tests/shaders/page_sample_on_cpu.h"

#include "tests/shaders/glsl_on_cpu.h"

namespace citystream::shaders_test {
namespace {

// NOLINTNEXTLINE: the shaders use GLSL's names.
using namespace citystream::glsl;

#include "shaders/page_sample.glsl"

}  // namespace

std::array<float, 3> sample_paged_on_cpu(std::span<const uint32_t> words, uint32_t chart,
                                         const std::array<float, 2>& place, const std::array<float, 2>& dx,
                                         const std::array<float, 2>& dy, float finest) {
    const LayerWords layer = words;
    const Pages pages = pages_of(layer_reference(layer));
    const PagedChart own = paged_chart(pages, chart);
    if ((own.flags & PAGES_CHART_FLAT) != 0u) {
        const vec3 colour = flat_chart_colour(own);
        return {colour.x, colour.y, colour.z};
    }
    const vec3 colour = sample_paged(pages, own.flags >> 16, paged_frame(pages, own), vec2(place[0], place[1]),
                                     vec2(dx[0], dx[1]), vec2(dy[0], dy[1]), finest);
    return {colour.x, colour.y, colour.z};
}

}  // namespace citystream::shaders_test
