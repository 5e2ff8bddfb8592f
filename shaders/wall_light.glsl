// Light of a wall, direction by direction, as its receivers gather it (codec/radiance/local_light.h), and what relief makes of it.
#ifndef CITYSTREAM_WALL_LIGHT_GLSL
#define CITYSTREAM_WALL_LIGHT_GLSL

#include "client/render/relief_draw_layout.h"
#include "codec/radiance/local_light_layout.h"
#include "shaders/btf.glsl"
#include "shaders/relief_mask.glsl"
#include "shaders/surface_light.glsl"

// Of the pipeline: walls have local light.
layout(constant_id = RELIEF_LIGHT_CONSTANT) const bool kReliefLight = false;

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer ReliefDrawRecord {
    ReliefDraw draw;
    ReliefDrawEntry entry[];
};

// What each direction adds to the wall's irradiance, in the unit of irradiance words.
vec3 wall_light[LOCAL_LIGHT_DIRECTIONS];

vec3 local_light(uint word) {
    uint mask = (1u << LOCAL_LIGHT_BITS) - 1u;
    float one = uintBitsToFloat((word >> 3 * LOCAL_LIGHT_BITS) + uint(127 - LOCAL_LIGHT_UNIT_BITS) << 23);
    return one * vec3(word & mask, word >> LOCAL_LIGHT_BITS & mask, word >> 2 * LOCAL_LIGHT_BITS & mask);
}

// Sets wall_light for a point of a wall: grid units from the tile's origin. False: its own receivers are not there.
bool gather_wall_light(ReliefDraw draw, vec3 place, vec3 outwards) {
    ReceiverShares shares = receiver_shares(layer_reference(draw.radiance.layer), place_among_receivers(draw.radiance, place), outwards);
    if (!shares.found || !shares.own_surface || draw.local_receivers == 0u) return false;
    uvec2 local = layer_reference(draw.local);
    for (uint group = 0u; group < uint(LOCAL_LIGHT_DIRECTIONS / 4); ++group) {
        vec3 sum[4] = vec3[4](vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
        for (uint k = 0u; k < 4u; ++k) {
            if (shares.weight[k] == 0.0) continue;
            uint receiver = min(shares.receiver[k], draw.local_receivers - 1u);
            uvec4 words = layer_words4(local, receiver * uint(LOCAL_LIGHT_DIRECTIONS / 4) + group);
            for (uint i = 0u; i < 4u; ++i) sum[i] += shares.weight[k] * local_light(words[i]);
        }
        for (uint i = 0u; i < 4u; ++i) wall_light[4u * group + i] = sum[i];
    }
    return true;
}

// The light on a point of the relief. `nearest`: of the masks around it the one that counts most stands for all.
vec3 masked_light(ReliefMask mask, ReliefShares shares, uint face, bool nearest) {
    vec4 share = vec4(shares.share[0], shares.share[1], shares.share[2], shares.share[3]);
    if (nearest) {
        float most = max(max(share.x, share.y), max(share.z, share.w));
        for (int k = 0; k < 4; ++k) {
            if (share[k] != most) continue;
            share = vec4(0.0);
            share[k] = 1.0 - shares.open;
            break;
        }
    }
    vec3 sum = vec3(0.0);
    for (uint part = 0u; part < 2u; ++part) {
        uvec4 bits = uvec4(shares.bits[0][part], shares.bits[1][part], shares.bits[2][part], shares.bits[3][part]);
        for (uint i = 0u; i < 32u; ++i) {
            uint direction = 32u * part + i;
            float free = shares.open + dot(vec4(bits >> i & 1u), share);
            if (face != uint(RELIEF_FACE_FRONT)) {
                if (free == 0.0) continue;
                free *= relief_weight(mask, face, direction) / relief_weight(mask, uint(RELIEF_FACE_FRONT), direction);
            }
            sum += free * wall_light[direction];
        }
    }
    return sum;
}

// The light that a BTF turns to the viewer.
vec3 btf_light(Btf btf, BtfPlace at) {
    vec3 sum = vec3(0.0);
    for (uint group = 0u; group < 4u; ++group) {
        BtfSixteen values = btf_values(btf, at, group);
        for (uint i = 0u; i < 16u; ++i) {
            uint direction = 16u * group + i;
            sum += values.four[i >> 2][i & 3u] / btf_mean_cosine(btf, direction) * wall_light[direction];
        }
    }
    return sum;
}

#endif
