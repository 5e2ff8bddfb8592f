// The frame's and the tile's record of client/render/draw_layout.h, reached through push constants.
#ifndef CITYSTREAM_DRAW_RECORDS_GLSL
#define CITYSTREAM_DRAW_RECORDS_GLSL

#include "client/render/draw_layout.h"

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer FrameReference { FrameRecord record; };
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer TileReference { TileDrawRecord record; };
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer FacadeMapTable { FacadeMapEntry entry[]; };

layout(push_constant) uniform Constants { DrawConstants constants; };

FrameReference frame_reference() { return FrameReference(uvec2(constants.frame[0], constants.frame[1])); }
TileReference tile_reference() { return TileReference(uvec2(constants.tile[0], constants.tile[1])); }

vec3 vec3_of(float v[3]) { return vec3(v[0], v[1], v[2]); }

const float kMetresPerGridUnit = 1.0 / 1024.0;

// Exact up to the one rounding that equal places in different tiles share: whole grid units from the camera's cell, then metres, then the camera's place in its cell.
vec3 camera_relative_metres(ivec3 grid_units, FrameReference frame) {
    return vec3(grid_units) * kMetresPerGridUnit - vec3_of(frame.record.camera_fraction);
}

// Reversed z with an infinite far plane: depth = near_plane / distance along the view direction.
vec4 project(vec3 metres, FrameReference frame) {
    return vec4(dot(vec3_of(frame.record.clip_x), metres), dot(vec3_of(frame.record.clip_y), metres), frame.record.near_plane,
                dot(vec3_of(frame.record.clip_w), metres));
}

#endif
