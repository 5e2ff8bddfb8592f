// shaders/wrap_coordinate.glsl compiled as C++ (glsl_on_cpu.h), behind a plain interface.
#pragma once

#include <array>
#include <cstdint>

namespace citystream::shaders_test {

std::array<float, 4> wrap_frame_on_cpu(const std::array<uint32_t, 2>& words, uint32_t border);
std::array<float, 2> wrap_place_on_cpu(const std::array<uint32_t, 2>& words);
std::array<float, 2> wrap_texel_on_cpu(const std::array<float, 4>& frame, const std::array<float, 2>& place,
                                       float level);
float wrap_level_on_cpu(const std::array<float, 4>& frame, const std::array<float, 2>& dx,
                        const std::array<float, 2>& dy, float finest, float coarsest);

}  // namespace citystream::shaders_test
