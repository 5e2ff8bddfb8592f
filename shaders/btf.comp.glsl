#version 460
// Makes the finest mip of a facade map's BTF (codec/radiance/btf.h), a workgroup four texels of a view: first a thread a ray, then a thread four light
// directions of a texel. Compiled for each facade renderer. Which rays hit what is in floats, all else in whole numbers.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "codec/facade/facade_layout.h"
#include "shaders/btf_words.glsl"
#include "shaders/facade_cast.glsl"
#include "shaders/relief_mask.glsl"

const uint kNothing = 0xffffffffu;

// Of each ray: its palette slot | face << 8, or kNothing; the mask where it hits; and how much light that leaves (codec/radiance/btf.cpp).
shared uint met[BTF_GROUP];
shared uvec2 bits[BTF_GROUP];
shared uint ray_light[BTF_GROUP];
shared uint weights[RELIEF_FACES * RELIEF_MASK_FACE_WORDS];

// What lies straight behind a place of the plane w = 0.
FacadeHit behind(FacadeMap map, vec3 origin) {
    uint x = min(uint(origin.x), map_width(map) - 1u);
    uint y = min(uint(origin.y), map_height(map) - 1u);
    uint label = facade_label(map, x, y);
    if (label_is_open(label)) return facade_miss();
    return FacadeHit(true, 0.0, label, 2, 1.0, false);
}

bool is_free(uint ray, uint direction) { return ((direction < 32u ? bits[ray].x : bits[ray].y) >> (direction & 31u) & 1u) != 0u; }

uint weight_of(uint face, uint direction) {
    return weights[face * uint(RELIEF_MASK_FACE_WORDS) + (direction >> 1)] >> (16u * (direction & 1u)) & 0xffffu;
}

void cast_ray(FacadeMap map, vec3 origin, vec3 to_viewer, uint ray) {
    float across = uintBitsToFloat(layer_word(layer_reference(constants.btf), uint(BTF_WORD_SCALES)));
    float up = uintBitsToFloat(layer_word(layer_reference(constants.btf), uint(BTF_WORD_SCALES + 1)));
    vec3 direction = vec3(-to_viewer.x * across, -to_viewer.y * up, -to_viewer.z * 1000.0);
    float begin = (max(map_depth_max(map), 0.0) + 1.0) / direction.z;
    FacadeHit hit = cast_facade_ray(map, origin, direction, begin, 0.0);
    vec3 at = origin + hit.t * direction;
    if (!hit.hit) {
        // What comes to the back within the facade went through an open texel.
        vec3 back = origin + map_depth_min(map) / direction.z * direction;
        bool through = back.x >= 0.0 && back.y >= 0.0 && back.x <= float(map_width(map)) && back.y <= float(map_height(map));
        if (!through) hit = behind(map, origin);
        at = vec3(origin.x, origin.y, label_depth(hit.label));
    }
    met[ray] = kNothing;
    if (!hit.hit) return;
    uint slot = min(hit.label >> 16, uint(BTF_SLOTS) - 1u);
    uint face = relief_face(hit.axis, hit.side);
    met[ray] = slot | face << 8;
    ReliefShares shares = relief_shares(relief_mask(layer_reference(constants.mask)), at, hit.label, hit.axis, hit.side);
    uint best = 0u;
    for (uint k = 1u; k < 4u; ++k) best = shares.share[k] > shares.share[best] ? k : best;
    bits[ray] = shares.open > shares.share[best] ? uvec2(~0u) : shares.bits[best];
    uint sum = 0u;
    for (uint i = 0u; i < uint(RELIEF_DIRECTIONS); ++i) sum += is_free(ray, i) ? weight_of(face, i) : 0u;
    ray_light[ray] = (sum >> 4) + 1u;
}

// Sum of the weights of four directions over a texel's rays.
uvec4 light_sum(uint texel, uint four) {
    uvec4 sum = uvec4(0u);
    for (uint r = 0u; r < uint(BTF_RAYS); ++r) {
        uint ray = texel * uint(BTF_RAYS) + r;
        if (met[ray] == kNothing) continue;
        for (uint i = 0u; i < 4u; ++i) sum[i] += is_free(ray, 4u * four + i) ? weight_of(met[ray] >> 8, 4u * four + i) : 0u;
    }
    return sum;
}

// The light of four palette slots over a texel's rays, and of all slots.
uvec4 slot_sum(uint texel, uint four, out uint all_light) {
    uvec4 sum = uvec4(0u);
    all_light = 0u;
    for (uint r = 0u; r < uint(BTF_RAYS); ++r) {
        uint ray = texel * uint(BTF_RAYS) + r;
        if (met[ray] == kNothing) continue;
        all_light += ray_light[ray];
        for (uint i = 0u; i < 4u; ++i) sum[i] += (met[ray] & 255u) == 4u * four + i ? ray_light[ray] : 0u;
    }
    return sum;
}

uint hits_of(uint texel) {
    uint hits = 0u;
    for (uint r = 0u; r < uint(BTF_RAYS); ++r) hits += met[texel * uint(BTF_RAYS) + r] != kNothing ? 1u : 0u;
    return hits;
}

void main() {
    uint group = gl_WorkGroupID.y * uint(RELIEF_PASS_ROW_GROUPS) + gl_WorkGroupID.x;
    if (group >= constants.groups) return;
    group += constants.first_group;
    Btf btf = btf_at(layer_reference(constants.btf));
    FacadeMap map = facade_map(layer_reference(constants.map));
    uint groups_a_view = (1u << (2u * btf.patch_log2)) / uint(BTF_GROUP_TEXELS);
    uint view = group / groups_a_view;
    uint first_texel = group % groups_a_view * uint(BTF_GROUP_TEXELS);
    uint thread = gl_LocalInvocationID.x;
    for (uint i = thread; i < uint(RELIEF_FACES * RELIEF_MASK_FACE_WORDS); i += uint(BTF_GROUP))
        weights[i] = layer_word(layer_reference(constants.mask), uint(RELIEF_MASK_WEIGHTS) + i);
    barrier();

    uint texel = first_texel + thread / uint(BTF_RAYS);
    uint ray = thread % uint(BTF_RAYS);
    uint side = 1u << btf.patch_log2;
    vec2 in_texel = vec2(float(ray) + 0.5, float(ray * uint(BTF_RAY_GENERATOR) % uint(BTF_RAYS)) + 0.5) / float(BTF_RAYS);
    vec2 place = (vec2(float(texel & (side - 1u)), float(texel >> btf.patch_log2)) + in_texel) / float(side);
    vec3 origin = vec3(place.x * float(map_width(map)), place.y * float(map_height(map)), 0.0);
    if (facade_form_is_known(map)) cast_ray(map, origin, btf_table_direction(btf.layer, uint(BTF_VIEW_TABLE), view), thread);
    else met[thread] = kNothing;
    barrier();

    uint own = thread / uint(BTF_RAYS);
    uint four = thread % uint(BTF_RAYS);
    uint hits = hits_of(own);
    uint record = view * btf.texels_a_view + first_texel + own;
    uint word = btf.records + record * uint(BTF_RECORD_WORDS) + four;
    uvec4 light = hits == 0u ? uvec4(0u) : (light_sum(own, four) * 255u + hits * 32768u) / (hits * 65536u);
    write_word(word, packed(light));
    if (four < uint(BTF_RECORD_WORDS - BTF_RECORD_SLOTS)) {
        uint all_light;
        uvec4 slots = slot_sum(own, four, all_light);
        slots = hits == 0u ? uvec4(0u) : (slots * 255u + all_light / 2u) / all_light;
        write_word(word + uint(BTF_RECORD_SLOTS), packed(slots));
    }
    if (btf.coverage != 0u && thread == 0u) {
        uint covered = 0u;
        for (uint i = 0u; i < uint(BTF_GROUP_TEXELS); ++i)
            covered |= (hits_of(i) * 255u + uint(BTF_RAYS) / 2u) / uint(BTF_RAYS) << (8u * i);
        write_word(btf.coverage + (record >> 2), covered);
    }
}
