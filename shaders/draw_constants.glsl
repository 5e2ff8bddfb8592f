// The frame's and the tile's constants of client/render/draw_layout.h, and what vertex shaders do with them.
#ifndef CITYSTREAM_DRAW_CONSTANTS_GLSL
#define CITYSTREAM_DRAW_CONSTANTS_GLSL

#include "client/render/draw_layout.h"

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer FacadeMapTable {
    FacadeTableHead head;
    FacadeMapEntry entry[];
};

layout(buffer_reference, std430, buffer_reference_align = 4) readonly buffer PlacementMaps { uint entry[]; };

// Of the pipeline: the tile's atlas is in pages, and how the mesh pass gets the frames of charts in them.
layout(constant_id = PAGES_CONSTANT) const bool kPages = false;
layout(constant_id = CHART_TRANSPORT_CONSTANT) const uint kTransport = CHART_TRANSPORT_TABLE;

layout(push_constant) uniform Constants { DrawConstants constants; };

bool has_atlas() { return (constants.tile.atlas[0] | constants.tile.atlas[1]) != 0u; }
ivec3 tile_origin() { return ivec3(constants.tile.origin[0], constants.tile.origin[1], constants.tile.origin[2]); }
vec3 vec3_of(float v[3]) { return vec3(v[0], v[1], v[2]); }

const float kMetresPerGridUnit = 1.0 / 1024.0;

// Exact up to the one rounding that equal places in different tiles share: whole grid units from the camera's cell, then metres, then the camera's place in its cell.
vec3 camera_relative_metres(ivec3 grid_units) {
    return vec3(grid_units) * kMetresPerGridUnit - vec3_of(constants.frame.camera_fraction);
}

#ifdef SHADOW_PASS
// Parallel, towards the sun: metres from the middle of a cascade (client/render/shadow_cascades.h).
vec4 project(vec3 metres) {
    return vec4(dot(vec3_of(constants.frame.clip_x), metres), dot(vec3_of(constants.frame.clip_y), metres),
                0.5 + dot(vec3_of(constants.frame.clip_w), metres), 1.0);
}
#else
// Reversed z with an infinite far plane: depth = near_plane / distance along the view direction.
vec4 project(vec3 metres) {
    return vec4(dot(vec3_of(constants.frame.clip_x), metres), dot(vec3_of(constants.frame.clip_y), metres), constants.frame.near_plane,
                dot(vec3_of(constants.frame.clip_w), metres));
}
#endif

#endif
