// The facade shaders of shaders/ compiled as C++ (glsl_on_cpu.h), behind a plain interface: for tests under sanitizers
// and for counting what a lookup or a ray costs. Every word read is checked: std::out_of_range when a shader leaves the
// map.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "client/render/facade_renderer.h"

namespace citystream::shaders_test {

/// Summed over calls. The two loads of the map's first eight words are not counted: a placement reads them once for all
/// its pixels.
struct ShaderCost {
    uint64_t loads = 0;  ///< of one word or of an aligned group of four
    uint64_t words = 0;
    uint64_t steps = 0;
};

struct ShaderHit {
    bool hit = false;
    float t = 0;
    uint32_t label = 0;
    int axis = 2;  ///< of the normal: 0 u, 1 v, 2 w
    int side = 1;  ///< sign of the normal
    bool at_edge = false;
};

/// cast_facade_ray of facade_cast.glsl for checked words in a form that the renderer draws; other forms are never hit.
ShaderHit cast_on_cpu(client::FacadeRenderer renderer, std::span<const uint32_t> words, const float origin[3],
                      const float direction[3], float begin = 0, float margin = 0, ShaderCost* cost = nullptr);

/// Place of a sample in its pixel, and how many a pixel takes, as facade_samples.glsl has them. `ray`, `right`, `down`:
/// in facade space, by pixel; `finest`: texels.
std::array<float, 2> sample_offset_on_cpu(uint32_t i, uint32_t count);
uint32_t sample_count_on_cpu(const float ray[3], const float right[3], const float down[3], float t,
                             const float finest[2], uint32_t most);

/// The most steps of every ray cast on this thread from now on, where it is below the stepper's own bound; without an
/// argument the steppers' own bounds again.
void limit_steps_on_cpu(uint32_t most = ~0u);

/// A renderer that casts rays exactly against maps of this form.
client::FacadeRenderer exact_renderer_of(codec::facade::FacadeForm form);

/// Label of a texel by the lookup of the map's form.
uint32_t lookup_on_cpu(std::span<const uint32_t> words, uint32_t x, uint32_t y, ShaderCost* cost = nullptr);

}  // namespace citystream::shaders_test
