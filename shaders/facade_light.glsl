// The light on facades in frames with a light; part of facade.frag.glsl.
#ifndef CITYSTREAM_FACADE_LIGHT_GLSL
#define CITYSTREAM_FACADE_LIGHT_GLSL

#include "shaders/wall_light.glsl"

layout(location = 11) flat in vec3 wall_place;
layout(location = 12) flat in vec3 per_grid_unit;

layout(location = 13) flat in uint map_number;      // of the tile's maps

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer RadianceRecord { RadianceDraw draw; };

RadianceDraw radiance_draw() { return RadianceRecord(layer_reference(constants.tile.mesh_draw)).draw; }
LightRecord light_record() { return LightRecord(layer_reference(radiance_draw().light)); }
vec3 wall_outwards() { return vec3(along.y, -along.x, 0.0); }

// Grid units from the tile's origin.
vec3 place_in_tile(vec3 at) {
    vec3 units = at / per_grid_unit;
    return wall_place + vec3(along * units.x + vec2(along.y, -along.x) * units.z, units.y);
}

// Of facade space: a direction in space, and one seen along (u, v, w) in metres.
vec3 facade_direction(vec3 metres) {
    return vec3(dot(metres.xy, along), metres.z, dot(metres.xy, wall_outwards().xy)) * per_grid_unit * (1.0 / kMetresPerGridUnit);
}
vec3 wall_metres(vec3 direction) { return direction / per_grid_unit * kMetresPerGridUnit; }

// The sun reaches relief where it reaches the wall, by its triangles: those are what casts shadows.
float sun_on_wall(LightRecord record, vec3 at) {
    vec3 outwards = wall_outwards();
    if (dot(outwards, light_vec3(record.light.to_sun)) <= 0.0) return 0.0;
    return sun_share(record, metres_of_place(place_in_tile(vec3(at.xy, max(at.z, 0.0)))), outwards);
}

// Whether the relief itself lets the sun reach a point of it.
bool sun_reaches_relief(FacadeMap map, FacadeHit hit, vec3 at, vec3 to_sun) {
    vec3 from = at;
    // Half a millimetre off the surface.
    from[hit.axis] += hit.side * (hit.axis == 2 ? 0.5 : 0.05);
    return !cast_facade_ray(map, from, facade_direction(to_sun), 0.0, 0.0).hit;
}

// What the samples of a pixel hit, by side of the relief (axis and sign), where there is no mask: all of a side take the sky's light where the first of
// them is, which changes over metres.
uint hit_sides = 0u;
vec3 side_place[6];
vec3 side_albedo[6];

// Of a pixel whose relief is shaded by its mask.
bool has_mask = false;
ReliefMask relief;
vec3 hit_light = vec3(0.0);
float wall_sun = 0.0;

// Before the first hit of a pixel is added; `at`: the hit.
void begin_light(vec3 at) {
    if (kSun) wall_sun = sun_on_wall(light_record(), at);
    if (!kReliefLight) return;
    ReliefDrawRecord record = ReliefDrawRecord(layer_reference(constants.tile.mesh_draw));
    uvec2 mask = layer_reference(record.entry[map_number].mask);
    if (mask == uvec2(0u) || !gather_wall_light(record.draw, place_in_tile(vec3(at.xy, 0.0)), wall_outwards())) return;
    relief = relief_mask(mask);
    has_mask = true;
}

// `nearest`: the pixel has many samples. What is seen through a facade's edge is no relief, but the end of the wall: its light is that of its side.
void add_hit(FacadeMap map, FacadeHit hit, vec3 texel, vec3 normal, vec3 at, bool nearest) {
    vec3 albedo = srgb_decoded(texel);
    if (has_mask && !hit.at_edge) {
        LightRecord record = light_record();
        vec3 light = light_vec3(record.light.sky) *
                     masked_light(relief, relief_shares(relief, at, hit.label, hit.axis, hit.side), relief_face(hit.axis, hit.side), nearest);
        if (kSun && wall_sun > 0.0 && sun_reaches(record, normal) && sun_reaches_relief(map, hit, at, light_vec3(record.light.to_sun)))
            light += sun_light(record, normal, wall_sun);
        hit_light += albedo * light;
        return;
    }
    uint side = 2u * uint(hit.axis) + (hit.side < 0.0 ? 1u : 0u);
    if ((hit_sides >> side & 1u) == 0u) {
        side_place[side] = at;
        side_albedo[side] = vec3(0.0);
    }
    side_albedo[side] += albedo;
    hit_sides |= 1u << side;
}

vec3 mean_light(float hits) {
    LightRecord record = light_record();
    vec3 sum = hit_light;
    for (uint left = hit_sides; left != 0u; left &= left - 1u) {
        int side = findLSB(left);
        vec3 normal = hit_normal(FacadeHit(true, 0.0, 0u, side >> 1, (side & 1) != 0 ? -1.0 : 1.0, false));
        vec3 light = sky_light(radiance_draw(), place_in_tile(side_place[side]), normal, normal) + sun_light(record, normal, wall_sun);
        sum += side_albedo[side] * light;
    }
    return sum / hits;
}

// What a pixel shows of a wall without casting rays.
struct FacadeQuad {
    float share;  // of the pixel's colour; 0: none
    float t;      // where the ray meets the wall
    vec3 light;
};

// Mean of the palette's albedos by their shares in the light that is turned to the viewer.
vec3 btf_albedo(Btf btf, BtfPlace place, vec2 at, vec2 dx, vec2 dy) {
    BtfSixteen shares = btf_slot_shares(btf, place);
    vec3 sum = vec3(0.0);
    for (uint left = btf.slots; left != 0u; left &= left - 1u) {
        uint slot = uint(findLSB(left));
        float share = shares.four[slot >> 2][slot & 3u];
        if (share == 0.0) continue;
        sum += share * srgb_decoded(tinted(hit_texel(slot, at, dx, dy), wall_outwards(), tint.x + tint.y * at.x));
    }
    return sum;
}

vec3 seen_along_wall(vec3 direction) { return vec3(dot(direction.xy, along), direction.z, dot(direction, wall_outwards())); }

// The BTF's light, direction by direction: wall_light is gathered.
vec3 detailed_light(Btf btf, BtfPlace place, float sun) {
    LightRecord record = light_record();
    vec3 light = light_vec3(record.light.sky) * btf_light(btf, place);
    if (sun > 0.0) light += light_vec3(record.light.sun) * (sun * btf_sun_cosine(btf, place, seen_along_wall(light_vec3(record.light.to_sun))));
    return light;
}

// The wall's irradiance, less what the relief hides of an even sky on the whole wall, and what it hides of the sun.
vec3 mean_light_of_wall(Btf btf, BtfPlace whole, ReliefDraw draw, vec2 at, float sun) {
    LightRecord record = light_record();
    vec3 outwards = wall_outwards();
    vec3 light = sky_light(draw.radiance, place_in_tile(vec3(at, 0.0)), outwards, outwards) * btf_openness(btf, whole);
    if (sun > 0.0) light += light_vec3(record.light.sun) * (sun * btf_sun_cosine(btf, whole, seen_along_wall(light_vec3(record.light.to_sun))));
    return light;
}

// `ray` from the camera at t = -1 to the pixel's place at t = 0, which is at distance `reach`.
FacadeQuad facade_quad(FacadeMap map, vec3 ray, float reach, vec3 ray_dx, vec3 ray_dy) {
    FacadeQuad quad = FacadeQuad(0.0, 0.0, vec3(0.0));
    ReliefDrawRecord record = ReliefDrawRecord(layer_reference(constants.tile.mesh_draw));
    uvec2 layer = layer_reference(record.entry[map_number].btf);
    float plane = clamp(0.0, map_depth_min(map), map_depth_max(map));
    if (layer == uvec2(0u) || ray.z >= 0.0) return quad;
    quad.t = (plane - place.z) / ray.z;
    float distance = (1.0 + quad.t) * reach;
    vec3 at = place + quad.t * ray;
    vec2 size = vec2(map_width(map), map_height(map));
    bool outside = any(lessThan(at.xy, vec2(-kEdgeMargin))) || any(greaterThan(at.xy, size + kEdgeMargin));
    if (outside || distance < constants.frame.near_plane) return quad;
    vec2 on_wall = clamp(at.xy, vec2(0.0), size);
    Btf btf = btf_at(layer);
    vec2 wall_metres_across = wall_metres(vec3(size, 0.0)).xy;
    float wall_pixels = max(wall_metres_across.x, wall_metres_across.y) / (length(wall_metres(right)) * distance);
    float texel_pixels = wall_pixels / float(1u << btf.patch_log2);
    float share = clamp(2.0 - texel_pixels * (2.0 / RELIEF_CAST_PIXELS), 0.0, 1.0);
    if (share == 0.0) return quad;
    float detail = clamp(2.0 * wall_pixels / RELIEF_WALL_PIXELS - 1.0, 0.0, 1.0);
    if (detail > 0.0 && !gather_wall_light(record.draw, place_in_tile(vec3(on_wall, 0.0)), wall_outwards())) return quad;
    // A texel of the mip covers a pixel or more.
    uint mip = uint(clamp(-log2(texel_pixels), 0.0, float(btf.patch_log2)));
    vec3 to_viewer = wall_metres(-ray);
    BtfPlace where = btf_place(btf, on_wall / size, to_viewer, mip);
    if (btf_coverage(btf, where) < 0.5) return quad;
    float sun = kSun ? sun_on_wall(light_record(), vec3(on_wall, 0.0)) : 0.0;
    vec3 light = detail > 0.0 ? detailed_light(btf, where, sun) : vec3(0.0);
    if (detail < 1.0) {
        BtfPlace whole = btf_place(btf, vec2(0.5), to_viewer, btf.patch_log2);
        light = mix(mean_light_of_wall(btf, whole, record.draw, on_wall, sun), light, detail);
    }
    float t = 1.0 + quad.t;
    vec3 albedo = btf_albedo(btf, where, on_wall, hit_gradient(ray, ray_dx, 2, t).xy, hit_gradient(ray, ray_dy, 2, t).xy);
    quad.share = share;
    quad.light = albedo * light;
    return quad;
}

#endif
