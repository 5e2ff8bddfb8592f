#version 460
// Facade pass: casts the pixel's ray through the box, textures and lights what it hits, and writes its depth.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/atlas_sample.glsl"
#include "shaders/draw_constants.glsl"
#include "shaders/facade_cast.glsl"
#include "shaders/facade_margin.glsl"
#include "shaders/lighting.glsl"

layout(location = 0) in vec3 place;
layout(location = 1) flat in vec3 camera;
layout(location = 2) flat in uvec2 map_layer;
layout(location = 3) flat in uvec4 map_words;
layout(location = 4) flat in uvec2 data_words;
layout(location = 5) flat in vec2 depths;
layout(location = 6) flat in vec2 along_direction;

layout(location = 0) out vec4 colour;

// Of two surfaces in one plane, the one that is seen through a facade's edge, inside the neighbouring facade's wall, yields.
const float kEdgeYields = 0.999;

// How the hit moves from pixel to pixel: neighbouring rays meet the plane of the hit. Smooth over edges of the relief, unlike differences of hits.
vec3 hit_gradient(vec3 ray, vec3 ray_change, int axis, float t) {
    return t * (ray_change - ray * (ray_change[axis] / ray[axis]));
}

vec3 hit_normal(FacadeHit hit) {
    if (hit.axis == 0) return vec3(along_direction, 0.0) * hit.side;
    if (hit.axis == 1) return vec3(0.0, 0.0, hit.side);
    return vec3(along_direction.y, -along_direction.x, 0.0) * hit.side;
}

vec3 hit_texel(uint slot, vec2 at, vec2 dx, vec2 dy) {
    uvec2 facade = layer_reference(constants.tile.facade);
    uint entry = data_words.y + slot * FACADE_PALETTE_ENTRY_WORDS;
    float metres_per_repeat = uintBitsToFloat(layer_word(facade, entry + 1u));
    float repeats_per_texel = metres_per_repeat > 0.0 ? 0.01 / metres_per_repeat : 0.0;
    uvec2 atlas = layer_reference(constants.tile.atlas);
    return sample_chart(atlas, atlas_chart(atlas, layer_word(facade, entry)), constants.tile.atlas_finest_mip,
                        at * repeats_per_texel, dx * repeats_per_texel, dy * repeats_per_texel);
}

void main() {
    vec3 ray = place - camera;
    vec3 ray_dx = dFdx(place);
    vec3 ray_dy = dFdy(place);
    FacadeMap map = FacadeMap(map_layer, map_words.x, map_words.y, map_words.z, map_words.w, data_words.x, depths);
    // Counted from the box's back, where coordinates are small and exact, towards the camera at t = -1.
    FacadeHit hit = cast_facade_ray(map, place, ray, -1.0, kEdgeMargin);
    float distance = (1.0 + hit.t) / gl_FragCoord.w;
    float near_plane = constants.frame.near_plane;
    if (!hit.hit || distance < near_plane) discard;
    vec3 at = place + hit.t * ray;
    gl_FragDepth = near_plane / distance * (hit.at_edge && at.z <= 0.0 ? kEdgeYields : 1.0);

    vec3 texel = kUntexturedColour;
    if (has_atlas()) {
        vec3 dx = hit_gradient(ray, ray_dx, hit.axis, 1.0 + hit.t);
        vec3 dy = hit_gradient(ray, ray_dy, hit.axis, 1.0 + hit.t);
        // Hits in the margin show the facade's rim.
        vec2 on_wall = clamp(at.xy, vec2(0.0), vec2(map.size & 0xffffu, map.size >> 16));
        texel = hit_texel(hit.label >> 16, on_wall, dx.xy, dy.xy);
    }
    colour = lit(texel, hit_normal(hit));
}
