// The compiled passes that make relief masks and BTFs: one of each a caster.
#pragma once

#include <cstdint>
#include <span>

namespace citystream::client {

struct ReliefShaders {
    std::span<const uint32_t> mask;
    std::span<const uint32_t> btf;
};

/// `caster`: a number of facade_renderer_layout.h.
ReliefShaders relief_shaders(uint32_t caster);

}  // namespace citystream::client
