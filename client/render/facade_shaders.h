// The compiled shaders of the facade pass: one vertex and two fragment shaders a caster, for frames
// without and with a light.
#pragma once

#include <cstdint>
#include <span>

namespace citystream::client {

struct FacadeShaders {
    std::span<const uint32_t> vertex;
    std::span<const uint32_t> fragment;        ///< writes depth, conservatively
    std::span<const uint32_t> keyed_fragment;  ///< early depth test, hits into the key buffer
};

/// `caster`: a number of facade_renderer_layout.h; `lit`: for frames with a light.
FacadeShaders facade_shaders(uint32_t caster, bool lit);

}  // namespace citystream::client
