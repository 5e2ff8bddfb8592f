#include "tests/shaders/wrap_coordinate_on_cpu.h"

#include "tests/shaders/glsl_on_cpu.h"

namespace citystream::shaders_test {
namespace {

// NOLINTNEXTLINE: the shaders use GLSL's names.
using namespace citystream::glsl;

#include "shaders/wrap_coordinate.glsl"

vec2 vector(const std::array<float, 2>& v) {
    return vec2(v[0], v[1]);
}

vec4 vector(const std::array<float, 4>& v) {
    return vec4(v[0], v[1], v[2], v[3]);
}

}  // namespace

std::array<float, 4> wrap_frame_on_cpu(const std::array<uint32_t, 2>& words, uint32_t border) {
    const vec4 frame = wrap_frame(uvec2(words[0], words[1]), border);
    return {frame.x, frame.y, frame.z, frame.w};
}

std::array<float, 2> wrap_place_on_cpu(const std::array<uint32_t, 2>& words) {
    const vec2 place = wrap_place(uvec2(words[0], words[1]));
    return {place.x, place.y};
}

std::array<float, 2> wrap_texel_on_cpu(const std::array<float, 4>& frame, const std::array<float, 2>& place,
                                       float level) {
    const vec2 texel = wrap_texel(vector(frame), vector(place), level);
    return {texel.x, texel.y};
}

float wrap_level_on_cpu(const std::array<float, 4>& frame, const std::array<float, 2>& dx,
                        const std::array<float, 2>& dy, float finest, float coarsest) {
    return wrap_level(vector(frame), vector(dx), vector(dy), finest, coarsest);
}

}  // namespace citystream::shaders_test
