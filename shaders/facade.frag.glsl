#version 460
// Facade pass: casts the pixel's ray into the volume, textures and lights what it hits, and writes its depth. A pixel that covers more than the
// finest parts of its map casts more rays beside that one, which alone decides whether and where something is hit, and takes the mean of the
// colours (facade_samples.glsl): relief below a pixel neither shimmers nor changes its tint. Compiled for each facade renderer, in two ways.
// Hits lie behind the quad (reversed z), so what is hidden need not be cast:
//   plain  writes conservative depth, by which a GPU rejects hidden fragments before their shader runs;
//   keyed  (FACADE_KEYED) for devices that do so only where no depth is written (lavapipe): tests the quad's depth, writes none, and puts the
//          hit as depth | colour into its pixel's key, of which the greatest stays. facade_resolve.frag.glsl draws the keys.
// FRAME_LIGHT: for frames with a light; the mean of the samples is one of light. Where walls have local light (wall_light.glsl) relief is shaded by its
// mask, and further away drawn by its BTF instead of rays, then by its mean colour (facade_btf.glsl).
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require
#ifdef FACADE_KEYED
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif

#include "codec/facade/facade_layout.h"
#include "shaders/draw_constants.glsl"
#include "shaders/facade_cast.glsl"
#include "shaders/facade_edge.glsl"
#include "shaders/facade_samples.glsl"
#include "shaders/facade_tint.glsl"
#include "shaders/page_chart.glsl"
#include "shaders/tile_chart.glsl"
#ifndef FRAME_LIGHT
#include "shaders/lighting.glsl"
#endif

layout(location = 0) in vec3 place;
layout(location = 1) flat in vec3 camera;
layout(location = 2) flat in uvec2 map_layer;
layout(location = 3) flat in uvec4 map_head;
layout(location = 4) flat in uvec4 map_own;
layout(location = 5) flat in vec2 along;
layout(location = 6) flat in uint palette;
layout(location = 7) flat in vec3 right;
layout(location = 8) flat in vec3 down;
layout(location = 9) flat in vec2 finest;
layout(location = 10) flat in vec3 tint;

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
    // The material of a ray that the device cut short is any number (facade_ray.glsl).
    uint entry = palette + min(slot, uint(FACADE_PALETTE_SLOTS) - 1u) * FACADE_PALETTE_ENTRY_WORDS;
    float metres_per_repeat = uintBitsToFloat(layer_word(facade, entry + 1u));
    float repeats_per_texel = metres_per_repeat > 0.0 ? 0.01 / metres_per_repeat : 0.0;
    if (kPages) {
        PageSurface surface = surface_of_word(pages_of(layer_reference(constants.tile.atlas)), layer_word(facade, entry));
        return sample_surface(surface, at * repeats_per_texel, dx * repeats_per_texel, dy * repeats_per_texel);
    }
    return sample_chart(tile_chart(layer_word(facade, entry)), at * repeats_per_texel, dx * repeats_per_texel,
                        dy * repeats_per_texel);
}

#ifdef FRAME_LIGHT
#include "shaders/facade_light.glsl"
#else
vec3 hit_sum = vec3(0.0);

void begin_light(vec3 at) {}
void add_hit(FacadeMap map, FacadeHit hit, vec3 texel, vec3 normal, vec3 at, bool nearest) { hit_sum += lit(texel, normal).rgb; }
#endif

// Adds a hit to what the pixel shows. `change_x`, `change_y`: how the ray changes over what the sample stands for; `samples`: of the pixel.
void shade(FacadeMap map, FacadeHit hit, vec3 start, vec3 ray, vec3 change_x, vec3 change_y, uint samples) {
    float t = 1.0 + hit.t;
    // Hits in the margin show the facade's rim.
    vec2 on_wall = clamp((start + hit.t * ray).xy, vec2(0.0), vec2(map_width(map), map_height(map)));
    vec3 texel = hit_texel(hit.label >> 16, on_wall, hit_gradient(ray, change_x, hit.axis, t).xy, hit_gradient(ray, change_y, hit.axis, t).xy);
    vec3 normal = hit_normal(hit);
    vec3 at = start + hit.t * ray;
    add_hit(map, hit, tinted(texel, normal, tint.x + tint.y * at.x + tint.z * at.z), normal, at, samples > 1u);
}

void main() {
    FacadeMap map = FacadeMap(map_layer, map_head, map_own);
    // Counted from the quad, where coordinates are small and exact; the camera is at t = -1.
    vec3 ray = place - camera;
    float reach = 1.0 / gl_FragCoord.w;  // of the quad, along the view direction
    float near_plane = constants.frame.near_plane;
    vec3 ray_dx = right * reach;
    vec3 ray_dy = down * reach;
#ifdef FRAME_LIGHT
    FacadeQuad quad = FacadeQuad(0.0, 0.0, vec3(0.0));
    if (kReliefLight) quad = facade_quad(map, ray, reach, ray_dx, ray_dy);
    float quad_depth = near_plane / ((1.0 + quad.t) * reach);
    if (quad.share == 1.0) {
        write_hit(min(quad_depth, gl_FragCoord.z), vec4(shown_light(quad.light), 1.0));
        return;
    }
#endif
    FacadeHit hit = cast_facade_ray(map, place, ray, -1.0, kEdgeMargin);
    float distance = (1.0 + hit.t) * reach;
    if (!hit.hit || distance < near_plane) {
#ifdef FRAME_LIGHT
        if (quad.share > 0.5) {
            write_hit(min(quad_depth, gl_FragCoord.z), vec4(shown_light(quad.light), 1.0));
            return;
        }
#endif
        discard;
        return;
    }
    vec3 at = place + hit.t * ray;
    float depth = near_plane / distance * (hit.at_edge && at.z <= 0.0 ? kEdgeYields : 1.0);

    FacadeTableHead head = FacadeMapTable(layer_reference(constants.tile.facade_maps)).head;
    uint count = facade_sample_count(facade_footprint(ray, ray_dx, ray_dy, 1.0 + hit.t), finest, head.samples);
    float share = inversesqrt(float(count));
    begin_light(at);
    shade(map, hit, place, ray, ray_dx * share, ray_dy * share, count);
    float hits = 1.0;
    for (uint i = 1u; i < count; ++i) {
        vec2 offset = facade_sample_offset(i, count);
        vec3 aside = offset.x * ray_dx + offset.y * ray_dy;
        FacadeHit other = cast_facade_ray(map, place + aside, ray + aside, -1.0, kEdgeMargin);
        if (other.hit && (1.0 + other.t) * reach >= near_plane) {
            shade(map, other, place + aside, ray + aside, ray_dx * share, ray_dy * share, count);
            hits += 1.0;
        }
    }
#ifdef FRAME_LIGHT
    vec3 colour = shown_light(mix(mean_light(hits), quad.light, quad.share));
#else
    vec3 colour = hit_sum / hits;
#endif
    write_hit(min(depth, gl_FragCoord.z), vec4(colour, 1.0));
}
