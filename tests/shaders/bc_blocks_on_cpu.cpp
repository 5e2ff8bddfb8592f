#include "tests/shaders/bc_blocks_on_cpu.h"

#include "tests/shaders/glsl_on_cpu.h"

namespace citystream::shaders_test {
namespace {

// NOLINTNEXTLINE: the shaders use GLSL's names.
using namespace citystream::glsl;

#include "shaders/bc_blocks.glsl"

}  // namespace

std::array<int32_t, 3> bc1_texel_on_cpu(const uint32_t block[2], uint32_t i) {
    const ivec3 texel = bc1_texel(uvec2(block[0], block[1]), i);
    return {texel.x, texel.y, texel.z};
}

int32_t bc4_texel_on_cpu(const uint32_t block[2], uint32_t i) {
    return bc4_texel(uvec2(block[0], block[1]), i);
}

std::array<int32_t, 4> bc3_texel_on_cpu(const uint32_t block[4], uint32_t i) {
    const ivec4 texel = bc3_texel(uvec4(block[0], block[1], block[2], block[3]), i);
    return {texel.x, texel.y, texel.z, texel.w};
}

}  // namespace citystream::shaders_test
