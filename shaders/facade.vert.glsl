#version 460
// Facade pass: the quads by which rays come into a placement's volume (the paper's section 4.2): one on top at the greatest displacement and,
// where relief stands out, at the sides; of the six faces those that the camera sees, at most one an axis. Where the camera is in the volume, or
// so near that the near plane could cut a quad, one quad over the whole picture at the near plane takes their place: each pixel's ray then starts
// inside. Whatever is hit lies behind the quad, so depth is conservative (facade.frag.glsl). Finds the placement's map by its dictionary index
// and leaves out maps in forms that FACADE_RENDERER does not draw.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/draw_constants.glsl"
#include "shaders/facade_cast.glsl"
#include "shaders/facade_edge.glsl"
#include "shaders/facade_placement.glsl"
#include "shaders/facade_tint.glsl"

layout(location = 0) out vec3 place;                 // facade space
layout(location = 1) flat out vec3 camera;           // facade space
layout(location = 2) flat out uvec2 map_layer;
layout(location = 3) flat out uvec4 map_head;
layout(location = 4) flat out uvec4 map_own;
layout(location = 5) flat out vec2 along;            // the wall's direction
layout(location = 6) flat out uint palette;          // word in the facade layer
layout(location = 7) flat out vec3 right;            // facade space: from pixel to pixel at distance 1 along the view direction
layout(location = 8) flat out vec3 down;
layout(location = 9) flat out vec2 finest;           // texels: the map's finest runs
layout(location = 10) flat out vec3 tint;            // place in the palette at the corner, and its change by a texel along u and a millimetre outwards

#ifdef FRAME_LIGHT
layout(location = 11) flat out vec3 wall_place;      // grid units from the tile's origin: the wall's lower left corner
layout(location = 12) flat out vec3 per_grid_unit;   // texels, texels, millimetres
layout(location = 13) flat out uint map_number;      // of the tile's maps
#endif

void hide() {
#ifdef FRAME_LIGHT
    wall_place = vec3(0.0);
    per_grid_unit = vec3(1.0);
    map_number = 0u;
#endif
    gl_Position = vec4(0.0, 0.0, -1.0, 1.0);
    place = camera = right = down = vec3(0.0);
    along = vec2(0.0);
    palette = 0u;
    finest = vec2(0.0);
    tint = vec3(0.0);
    map_layer = uvec2(0u);
    map_head = map_own = uvec4(0u);
}

// The point at distance 1 along the view direction that is seen at a place of the picture (-1..1), from the camera, metres.
vec3 unproject(vec2 at) {
    vec3 x = vec3_of(constants.frame.clip_x);
    vec3 y = vec3_of(constants.frame.clip_y);
    vec3 w = vec3_of(constants.frame.clip_w);
    return w / dot(w, w) + x * (at.x / dot(x, x)) + y * (at.y / dot(y, y));
}

void main() {
    FacadePlacement placement = facade_placement(uint(gl_InstanceIndex));
    if (!placement.visible) {
        hide();
        return;
    }
    FacadeMap map = facade_map(placement.layer);
    if (!facade_form_is_known(map)) {
        hide();
        return;
    }
    WallFrame wall = wall_frame(placement, map);
    camera = wall_direction(wall, -wall.corner);
    map_layer = placement.layer;
    map_head = map.head;
    map_own = map.own;
    along = wall.along;
    palette = placement.palette;
    finest = placement.finest;
#ifdef FRAME_LIGHT
    wall_place = vec3(placement.origin - tile_origin());
    per_grid_unit = wall.per_metre * kMetresPerGridUnit;
    map_number = placement.map_number;
#endif
    tint = vec3(0.0);
    if (kFacadeTint > 0.0) {
        vec2 change = vec2(wall.along.x + wall.along.y, wall.outwards.x + wall.outwards.y) * kTintsPerMetre;
        tint = vec3(tint_place(wall.corner), change / wall.per_metre.xz);
    }
    FacadeTableHead head = FacadeMapTable(layer_reference(constants.tile.facade_maps)).head;
    vec3 centre = unproject(vec2(0.0));
    right = wall_direction(wall, unproject(vec2(2.0 / float(head.width), 0.0)) - centre);
    down = wall_direction(wall, unproject(vec2(0.0, 2.0 / float(head.height))) - centre);

    vec3 low = vec3(vec2(-kEdgeMargin), map_depth_min(map));
    vec3 high = vec3(wall.size + kEdgeMargin, map_depth_max(map));
    uint axis = uint(gl_VertexIndex) >> 2;
    bvec2 far_side = bvec2((gl_VertexIndex & 1) != 0, (gl_VertexIndex & 2) != 0);

    vec3 reach = abs(wall.per_metre) * (near_reach() * 1.01);
    bool inside = all(greaterThanEqual(camera, low - reach)) && all(lessThanEqual(camera, high + reach));
    if (inside) {
        if (axis != 2u) {
            hide();
            return;
        }
        vec2 at = vec2(far_side.x ? 1.0 : -1.0, far_side.y ? 1.0 : -1.0);
        place = camera + wall_direction(wall, unproject(at));
        gl_Position = vec4(at, 1.0, 1.0);
        return;
    }
    bool is_low = camera[axis] < low[axis];
    bool is_seen = is_low || camera[axis] > high[axis];
    // A flat map has no sides.
    if (!is_seen || (axis != 2u && low.z == high.z)) {
        hide();
        return;
    }
    uint across = axis == 0u ? 1u : 0u;
    uint up = axis == 2u ? 1u : 2u;
    place[axis] = is_low ? low[axis] : high[axis];
    place[across] = far_side.x ? high[across] : low[across];
    place[up] = far_side.y ? high[up] : low[up];
    gl_Position = project(wall_metres(wall, place));
}
