#version 460
// Twin of cast_facade_ray: casts rays against a facade map. Compiled for each facade renderer.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/facade_cast.glsl"
#include "shaders/twin_records.glsl"

vec3 input_vector(uint at) {
    WordArray words = twin_input();
    return vec3(uintBitsToFloat(words.word[at]), uintBitsToFloat(words.word[at + 1u]), uintBitsToFloat(words.word[at + 2u]));
}

void main() {
    uint ray = gl_GlobalInvocationID.x;
    if (ray >= constants.count) return;
    vec3 origin = input_vector(ray * TWIN_RAY_WORDS);
    vec3 direction = input_vector(ray * TWIN_RAY_WORDS + 3u);
    FacadeHit hit = cast_facade_ray(facade_map(layer_reference(constants.layer)), origin, direction, 0.0, 0.0);
    TwinOutput target = twin_output();
    target.word[ray * TWIN_HIT_WORDS] = hit.hit ? 1u : 0u;
    target.word[ray * TWIN_HIT_WORDS + 1u] = floatBitsToUint(hit.t);
    target.word[ray * TWIN_HIT_WORDS + 2u] = hit.label;
    target.word[ray * TWIN_HIT_WORDS + 3u] = uint(hit.axis) | (hit.side > 0.0 ? 256u : 0u);
}
