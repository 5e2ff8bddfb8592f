// The light on a surface where the frame's light is set: the sky's as the tile's receivers gather it, and the sun's.
#ifndef CITYSTREAM_SURFACE_LIGHT_GLSL
#define CITYSTREAM_SURFACE_LIGHT_GLSL

#include "codec/radiance/radiance_layer_layout.h"
#include "codec/radiance/receiver_layout.h"
#include "shaders/draw_constants.glsl"
#include "shaders/receiver_lookup.glsl"
#include "shaders/sun_shadow.glsl"
#include "shaders/tone.glsl"

// Of the pipeline: the frame's light has a sun; the tile has receivers.
layout(constant_id = SUN_CONSTANT) const bool kSun = true;
layout(constant_id = RECEIVERS_CONSTANT) const bool kReceivers = true;

// Shown light of a white surface under the open sky: what is assumed where a tile has no receivers, or none for a point.
vec3 open_sky_light(LightRecord record, vec3 n) {
    float basis[AMBIENT_TERMS] = float[AMBIENT_TERMS](1.0, n.x, n.y, n.z, n.x * n.y, n.y * n.z, n.z * n.x, n.z * n.z, n.x * n.x - n.y * n.y);
    vec3 sum = vec3(0.0);
    for (int i = 0; i < AMBIENT_TERMS; ++i)
        sum += vec3(record.light.ambient[3 * i], record.light.ambient[3 * i + 1], record.light.ambient[3 * i + 2]) * basis[i];
    return max(sum, vec3(0.0));
}

// How much more light the open sky has for one unit normal than for another, which a receiver of another surface has.
vec3 open_sky_ratio(LightRecord record, vec3 n, vec3 other) {
    const float least = 1e-9;
    const float most = 4.0;
    return min(open_sky_light(record, n) / max(open_sky_light(record, normalize(other)), vec3(least)), vec3(most));
}

// Receivers may be those of an ancestor of the tile.
vec3 place_among_receivers(RadianceDraw draw, vec3 place) { return place + vec3(draw.offset[0], draw.offset[1], draw.offset[2]); }

// Shown light of a white surface. `place`: grid units from the tile's origin; `face`: normal of the surface, any length;
// `normal`: unit normal that it is shaded by.
vec3 sky_light(RadianceDraw draw, vec3 place, vec3 face, vec3 normal) {
    LightRecord record = LightRecord(layer_reference(draw.light));
    bool lit = false;
    vec3 sum = vec3(0.0);
    if (kReceivers) {
        uvec2 layer = layer_reference(draw.layer);
        ReceiverShares shares = receiver_shares(layer, place_among_receivers(draw, place), face);
        if (shares.found) {
            // Irradiance follows the receivers' own words (codec/radiance/radiance_layer.h).
            uvec4 header = layer_words4(layer, 0u);
            uint first = header[RECEIVER_WORD_ENTRIES] + header[RECEIVER_WORD_COUNT];
            for (uint k = 0u; k < 4u; ++k) {
                uint at = first + uint(IRRADIANCE_WORDS) * shares.receiver[k];
                uint blue = layer_word(layer, at + 1u);
                lit = blue >> 16 != 0u;  // of all alike: whether the light passes have run
                sum += shares.weight[k] * vec3(unpackHalf2x16(layer_word(layer, at)), unpackHalf2x16(blue).x);
            }
            if (!shares.own_surface) sum *= open_sky_ratio(record, normal, shares.normal);
        }
    }
    return lit ? sum * light_vec3(record.light.sky) : open_sky_light(record, normal);
}

// The sun's, of which `share` reaches the surface.
vec3 sun_light(LightRecord record, vec3 normal, float share) {
    return light_vec3(record.light.sun) * (max(0.0, dot(normal, light_vec3(record.light.to_sun))) * share);
}

bool sun_reaches(LightRecord record, vec3 normal) {
    return dot(normal, light_vec3(record.light.to_sun)) > 0.0 && light_vec3(record.light.sun) != vec3(0.0);
}

// Metres from the camera.
vec3 metres_of_place(vec3 place) { return (vec3(tile_origin()) + place) * kMetresPerGridUnit - vec3_of(constants.frame.camera_fraction); }

#endif
