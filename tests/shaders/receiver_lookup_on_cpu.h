// shaders/receiver_lookup.glsl compiled as C++ (glsl_on_cpu.h), behind a plain interface.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace citystream::shaders_test {

struct LookedUpReceivers {
    uint32_t count;
    bool own_surface;
    std::array<float, 3> normal;
    std::array<uint32_t, 4> receiver;
    std::array<float, 4> weight;
    uint64_t loads;  ///< of words
};

/// Throws std::out_of_range when a load is outside.
LookedUpReceivers receivers_on_cpu(std::span<const uint32_t> words, const std::array<float, 3>& point,
                                   const std::array<float, 3>& normal);

}  // namespace citystream::shaders_test
