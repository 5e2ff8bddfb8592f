// shaders/local_strips.glsl compiled as C++ (glsl_on_cpu.h), behind a plain interface.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace citystream::shaders_test {

struct LocalTriangle {
    std::array<uint32_t, 3> corners;
    uint64_t loads;  ///< of words
};

/// Triangle `index` of the local strips that begin at word `at`. Throws std::out_of_range when a load is outside.
LocalTriangle local_triangle_on_cpu(std::span<const uint32_t> words, uint32_t at, uint32_t index);

}  // namespace citystream::shaders_test
