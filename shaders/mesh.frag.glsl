#version 460
// Mesh pass: the atlas chart, lit: by the light of the frame where it has one (FRAME_LIGHT).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/atlas_sample.glsl"
#include "shaders/draw_constants.glsl"
#include "shaders/facade_tint.glsl"
#include "shaders/page_chart.glsl"
#ifdef FRAME_LIGHT
#include "client/render/mesh_draw_layout.h"
#include "codec/mesh/mesh_resident_layout.h"
#include "shaders/surface_light.glsl"
#else
#include "shaders/lighting.glsl"
#endif

layout(location = 0) in vec3 normal;
layout(location = 1) in vec2 texcoord;
layout(location = 2) flat in uvec3 chart_place;
layout(location = 3) flat in uvec4 chart_words;
layout(location = 4) in float tint;

layout(location = 0) out vec4 colour;

#ifdef FRAME_LIGHT
layout(location = 5) in vec3 place;

layout(constant_id = MESH_FORM_CONSTANT) const uint kMeshForm = MESH_FORM_ANY;

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer LitDrawRecord { LitMeshDraw lit; };

// The triangle's own normal, of any length: that of its corners may be smoothed.
vec3 face_normal(vec3 towards) {
    bool may_be_smooth = kMeshForm == MESH_FORM_ANY || (kMeshForm >> 8 & RESIDENT_FLAG_NORMALS) != 0u;
    vec3 across = cross(dFdx(place), dFdy(place));
    float cosine = dot(across, towards);
    return may_be_smooth && cosine != 0.0 ? across * sign(cosine) : towards;
}

vec4 lit(vec3 texel, vec3 towards) {
    RadianceDraw draw = LitDrawRecord(layer_reference(constants.tile.mesh_draw)).lit.radiance;
    LightRecord record = LightRecord(layer_reference(draw.light));
    vec3 light = sky_light(draw, place, face_normal(towards), towards);
    if (kSun && sun_reaches(record, towards)) light += sun_light(record, towards, sun_share(record, metres_of_place(place), towards));
    return vec4(shown_light(srgb_decoded(texel) * light), 1.0);
}
#endif

void main() {
    vec2 dx = dFdx(texcoord);
    vec2 dy = dFdy(texcoord);
    vec3 texel;
    if (kPages) {
        texel = sample_surface(PageSurface(chart_place, chart_words), texcoord, dx, dy);
    } else {
        AtlasChart chart =
            AtlasChart(chart_place.xy, uintBitsToFloat(chart_place.z), chart_words.x, chart_words.y, chart_words.z, chart_words.w);
        if (kAlphaTest && has_alpha(chart) && sample_alpha(chart, texcoord, dx, dy) < 0.5) {
            discard;
            return;
        }
        texel = sample_chart(chart, texcoord, dx, dy);
    }
    vec3 towards = normalize(normal);
    colour = lit(tinted(texel, towards, tint), towards);
}
