#version 460
// Twin of PrecisionView::fetch and shown_position, or of TexcoordWords::coordinate: every vertex of a precision buffer.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/precision_fetch.glsl"
#include "shaders/twin_records.glsl"

ivec3 input_ivec3(uint word) { return ivec3(twin_input().word[word], twin_input().word[word + 1u], twin_input().word[word + 2u]); }

void main() {
    uint vertex = gl_GlobalInvocationID.x;
    if (vertex >= constants.count) return;
    TwinOutput target = twin_output();
    if (constants.first == 2u) {
        ivec2 place = precision_texcoord(layer_reference(constants.layer), vertex, input_ivec3(0u).xy, uvec2(input_ivec3(3u).xy));
        target.word[vertex * TWIN_PRECISION_WORDS] = uint(place.x);
        target.word[vertex * TWIN_PRECISION_WORDS + 1u] = uint(place.y);
        return;
    }
    PrecisionVertex fetched = precision_fetch3(layer_reference(constants.layer), vertex);
    ivec3 shown = precision_shown(fetched, input_ivec3(0u), input_ivec3(3u), twin_input().word[6], twin_input().word[7], twin_input().word[8]);
    uint words[TWIN_PRECISION_WORDS] = uint[](fetched.words.x, fetched.words.y, fetched.words.z, fetched.level, uint(shown.x), uint(shown.y),
                                              uint(shown.z), 0u);
    for (uint i = 0u; i < TWIN_PRECISION_WORDS; ++i) target.word[vertex * TWIN_PRECISION_WORDS + i] = words[i];
}
