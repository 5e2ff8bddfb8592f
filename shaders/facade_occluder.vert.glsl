#version 460
// Depth prepass of facades: the backs of opaque placements. Whoever looks through a placement's front on its back meets its relief before, so
// what lies behind the back is hidden: all else that would be cast there is rejected by depth. Drawn without fragment shader.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/facade_edge.glsl"
#include "shaders/facade_placement.glsl"

// Inside the edges (texels), and behind the relief's own hits (millimetres), whatever is rounded.
const float kShrink = 0.5;
const float kBehind = 20.0;

void main() {
    gl_Position = vec4(0.0, 0.0, -1.0, 1.0);
    FacadePlacement placement = facade_placement(uint(gl_InstanceIndex));
    if (!placement.visible || !placement.is_opaque) return;
    FacadeMap map = facade_map(placement.layer);
    WallFrame wall = wall_frame(placement, map);
    vec3 camera = wall_direction(wall, -wall.corner);
    // Hits nearer than the near plane are not drawn: from there on the back hides nothing.
    if (camera.z < map_depth_max(map) + near_reach() * 1010.0) return;
    vec2 corner = vec2((gl_VertexIndex & 1) != 0 ? wall.size.x - kShrink : kShrink, (gl_VertexIndex & 2) != 0 ? wall.size.y - kShrink : kShrink);
    // Moved back along the rays, not along the wall's normal: a ray that passes beside the volume must not meet it. Farther than hits at the edges,
    // which yield: where walls meet at less than a right angle, the end of one stands out of the other's front and hides it.
    float back = map_depth_min(map);
    float moved = (camera.z - back + kBehind) / (camera.z - back) / kEdgeYields;
    gl_Position = project(moved * wall_metres(wall, vec3(corner, back)));
}
