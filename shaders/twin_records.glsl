// Where the twin passes read and write.
#ifndef CITYSTREAM_TWIN_RECORDS_GLSL
#define CITYSTREAM_TWIN_RECORDS_GLSL

#include "client/render/twin_layout.h"
#include "shaders/bits.glsl"

layout(local_size_x = TWIN_GROUP) in;

layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer TwinOutput { uint word[]; };

layout(push_constant) uniform Constants { TwinConstants constants; };

TwinOutput twin_output() { return TwinOutput(uvec2(constants.output_words[0], constants.output_words[1])); }
WordArray twin_input() { return WordArray(uvec2(constants.input_words[0], constants.input_words[1])); }

#endif
