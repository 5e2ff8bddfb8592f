// The frame's light (client/render/light_layout.h), and where passes find it.
#ifndef CITYSTREAM_LIGHT_RECORD_GLSL
#define CITYSTREAM_LIGHT_RECORD_GLSL

#include "client/render/light_layout.h"

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer LightRecord { LightConstants light; };

vec3 light_vec3(float v[3]) { return vec3(v[0], v[1], v[2]); }

#endif
