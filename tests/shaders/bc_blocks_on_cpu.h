// shaders/bc_blocks.glsl compiled as C++ (glsl_on_cpu.h), behind a plain interface.
#pragma once

#include <array>
#include <cstdint>

namespace citystream::shaders_test {

std::array<int32_t, 3> bc1_texel_on_cpu(const uint32_t block[2], uint32_t i);
int32_t bc4_texel_on_cpu(const uint32_t block[2], uint32_t i);
std::array<int32_t, 4> bc3_texel_on_cpu(const uint32_t block[4], uint32_t i);

}  // namespace citystream::shaders_test
