#version 460
// Facade pass: casts the pixel's ray into the volume, textures and lights what it hits, and writes its depth. Compiled for each facade renderer,
// in two ways. Hits lie behind the quad (reversed z), so what is hidden need not be cast:
//   plain  writes conservative depth, by which a GPU rejects hidden fragments before their shader runs;
//   keyed  (FACADE_KEYED) for devices that do so only where no depth is written (lavapipe): tests the quad's depth, writes none, and puts the
//          hit as depth | colour into its pixel's key, of which the greatest stays. facade_resolve.frag.glsl draws the keys.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#ifdef FACADE_KEYED
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif

#include "codec/facade/facade_layout.h"
#include "shaders/atlas_sample.glsl"
#include "shaders/draw_constants.glsl"
#include "shaders/facade_cast.glsl"
#include "shaders/facade_margin.glsl"
#include "shaders/lighting.glsl"

layout(location = 0) in vec3 place;
layout(location = 1) flat in vec3 camera;
layout(location = 2) flat in uvec2 map_layer;
layout(location = 3) flat in uvec4 map_head;
layout(location = 4) flat in uvec4 map_own;
layout(location = 5) flat in vec2 along;
layout(location = 6) flat in uint palette;

#ifdef FACADE_KEYED
layout(early_fragment_tests) in;
layout(buffer_reference, std430, buffer_reference_align = 8) buffer KeyArray { uint64_t key[]; };

void write_hit(float depth, vec4 colour) {
    FacadeTableHead head = FacadeMapTable(layer_reference(constants.tile.facade_maps)).head;
    uvec2 pixel = uvec2(gl_FragCoord.xy);
    uint64_t key = uint64_t(floatBitsToUint(depth)) << 32 | uint64_t(packUnorm4x8(colour));
    atomicMax(KeyArray(layer_reference(head.keys)).key[pixel.y * head.width + pixel.x], key);
}
#else
layout(depth_less) out float gl_FragDepth;
layout(location = 0) out vec4 colour_out;

void write_hit(float depth, vec4 colour) {
    gl_FragDepth = depth;
    colour_out = colour;
}
#endif

// Of two surfaces in one plane, the one that is seen through a facade's edge, inside the neighbouring facade's wall, yields.
const float kEdgeYields = 0.999;

// How the hit moves from pixel to pixel: neighbouring rays meet the plane of the hit. Smooth over edges of the relief, unlike differences of hits.
vec3 hit_gradient(vec3 ray, vec3 ray_change, int axis, float t) {
    return t * (ray_change - ray * (ray_change[axis] / ray[axis]));
}

vec3 hit_normal(FacadeHit hit) {
    if (hit.axis == 0) return vec3(along, 0.0) * hit.side;
    if (hit.axis == 1) return vec3(0.0, 0.0, hit.side);
    return vec3(along.y, -along.x, 0.0) * hit.side;
}

vec3 hit_texel(uint slot, vec2 at, vec2 dx, vec2 dy) {
    uvec2 facade = layer_reference(constants.tile.facade);
    uint entry = palette + slot * FACADE_PALETTE_ENTRY_WORDS;
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
    FacadeMap map = FacadeMap(map_layer, map_head, map_own);
    // Counted from the quad, where coordinates are small and exact; the camera is at t = -1.
    FacadeHit hit = cast_facade_ray(map, place, ray, -1.0, kEdgeMargin);
    float distance = (1.0 + hit.t) / gl_FragCoord.w;
    float near_plane = constants.frame.near_plane;
    if (!hit.hit || distance < near_plane) {
        discard;
        return;
    }
    vec3 at = place + hit.t * ray;
    float depth = near_plane / distance * (hit.at_edge && at.z <= 0.0 ? kEdgeYields : 1.0);

    vec3 texel = kUntexturedColour;
    if (has_atlas()) {
        vec3 dx = hit_gradient(ray, ray_dx, hit.axis, 1.0 + hit.t);
        vec3 dy = hit_gradient(ray, ray_dy, hit.axis, 1.0 + hit.t);
        // Hits in the margin show the facade's rim.
        vec2 on_wall = clamp(at.xy, vec2(0.0), vec2(map_width(map), map_height(map)));
        texel = hit_texel(hit.label >> 16, on_wall, dx.xy, dy.xy);
    }
    write_hit(min(depth, gl_FragCoord.z), lit(texel, hit_normal(hit)));
}
