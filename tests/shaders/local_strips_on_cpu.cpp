#include "tests/shaders/local_strips_on_cpu.h"

#include "tests/shaders/glsl_on_cpu.h"

namespace citystream::shaders_test {
namespace {

// NOLINTNEXTLINE: the shaders use GLSL's names.
using namespace citystream::glsl;

#include "shaders/local_strips.glsl"

}  // namespace

LocalTriangle local_triangle_on_cpu(std::span<const uint32_t> words, uint32_t at, uint32_t index) {
    const uint64_t loads_before = counted_loads;
    const uvec3 corners = local_triangle(layer_reference(words), at, index);
    return {{corners.x, corners.y, corners.z}, counted_loads - loads_before};
}

}  // namespace citystream::shaders_test
