#version 460
// Averages scale x scale samples a pixel: the mean of the 8-bit channel values, rounded half up.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "client/render/draw_layout.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer Samples { uint sample_at[]; };
layout(buffer_reference, std430, buffer_reference_align = 4) writeonly buffer Pixels { uint pixel_at[]; };

layout(push_constant) uniform Constants { FilterConstants constants; };

void main() {
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= constants.width || pixel.y >= constants.height) return;
    Samples samples = Samples(uvec2(constants.source[0], constants.source[1]));
    uint scale = constants.scale;
    uvec4 sum = uvec4(scale * scale / 2u);
    for (uint y = 0u; y < scale; ++y) {
        for (uint x = 0u; x < scale; ++x) {
            uint value = samples.sample_at[((pixel.y * scale + y) * constants.width + pixel.x) * scale + x];
            sum += uvec4(value, value >> 8, value >> 16, value >> 24) & 255u;
        }
    }
    uvec4 mean = sum / (scale * scale);
    Pixels(uvec2(constants.target[0], constants.target[1])).pixel_at[pixel.y * constants.width + pixel.x] =
        mean.x | mean.y << 8 | mean.z << 16 | mean.w << 24;
}
