// shaders/page_sample.glsl compiled as C++ (glsl_on_cpu.h), behind a plain interface. Reading outside the words throws
// std::out_of_range.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace citystream::shaders_test {

/// RGB, 0..1, of a chart at a place (repeats) with the given change of it from pixel to pixel.
std::array<float, 3> sample_paged_on_cpu(std::span<const uint32_t> words, uint32_t chart,
                                         const std::array<float, 2>& place, const std::array<float, 2>& dx,
                                         const std::array<float, 2>& dy, float finest);

}  // namespace citystream::shaders_test
