// Casts a ray against a facade map. Twin of FacadeMapView and cast_facade_ray in codec/facade/facade_map.h: same rules for edges, sides and backs.
// Facade space: u right, v up in texels of the map, w outwards in millimetres. What lies below the displacement is solid.
#ifndef CITYSTREAM_FACADE_CAST_GLSL
#define CITYSTREAM_FACADE_CAST_GLSL

#include "codec/facade/facade_layout.h"
#include "shaders/bits.glsl"

const float kNever = 1e30;

struct FacadeMap {
    uvec2 layer;
    uint cells;      // columns | rows << 16
    uint size;       // width | height << 16
    uint labels;     // word FACADE_MAP_WORD_LABELS
    uint offsets;    // word FACADE_MAP_WORD_OFFSETS
    uint cell_data;
    vec2 depths;     // least and greatest displacement
};

struct FacadeHit {
    bool hit;
    float t;
    uint label;
    int axis;        // of the normal: 0 u, 1 v, 2 w
    float side;      // sign of the normal
    bool at_edge;    // hit on the way in, through an edge of the facade
};

float label_depth(uint label) { return float(int(label << 16) >> 16); }

FacadeMap facade_map(uvec2 layer) {
    uint depths = layer_word(layer, FACADE_MAP_WORD_DEPTHS);
    return FacadeMap(layer, layer_word(layer, FACADE_MAP_WORD_CELLS), layer_word(layer, FACADE_MAP_WORD_SIZE),
                     layer_word(layer, FACADE_MAP_WORD_LABELS), layer_word(layer, FACADE_MAP_WORD_OFFSETS),
                     layer_word(layer, FACADE_MAP_WORD_CELL_DATA), vec2(label_depth(depths), label_depth(depths >> 16)));
}

uint facade_label(FacadeMap map, uint column, uint row) {
    uint bits = map.labels >> 16;
    uint cell = read_bits(map.layer, map.cell_data, (row * (map.cells & 0xffffu) + column) * bits, bits);
    return layer_word(map.layer, (map.offsets >> 16) + cell);
}

// One axis of the walk over the non-uniform grid. `margin` (0 in the twin) widens the facade's edges.
struct FacadeWalk {
    uint breaks;     // word of the first break
    uint cells;
    uint cell;
    float size;
    float origin;
    float direction;
    float margin;
};

float facade_break(uvec2 layer, FacadeWalk walk, uint i) {
    if (i == 0u) return -walk.margin;
    if (i == walk.cells) return walk.size + walk.margin;
    return float(layer_word(layer, walk.breaks + (i >> 1)) >> (16u * (i & 1u)) & 0xffffu);
}

FacadeWalk facade_walk(FacadeMap map, int axis, vec3 origin, vec3 direction, float margin, float t) {
    uint breaks = axis == 0 ? FACADE_MAP_HEADER_WORDS : map.offsets & 0xffffu;
    uint cells = axis == 0 ? map.cells & 0xffffu : map.cells >> 16;
    float size = float(axis == 0 ? map.size & 0xffffu : map.size >> 16);
    FacadeWalk walk = FacadeWalk(breaks, cells, 0u, size, origin[axis], direction[axis], margin);
    float coordinate = walk.origin + t * walk.direction;
    uint high = cells - 1u;
    while (walk.cell < high) {
        uint middle = (walk.cell + high + 1u) >> 1;
        float at = facade_break(map.layer, walk, middle);
        if (walk.direction < 0.0 ? at < coordinate : at <= coordinate) walk.cell = middle;
        else high = middle - 1u;
    }
    return walk;
}

// Where the ray leaves the current cell.
float facade_next(uvec2 layer, FacadeWalk walk) {
    if (walk.direction == 0.0) return kNever;
    return (facade_break(layer, walk, walk.direction > 0.0 ? walk.cell + 1u : walk.cell) - walk.origin) / walk.direction;
}

// False when the ray leaves the facade.
bool facade_step(inout FacadeWalk walk) {
    if (walk.direction > 0.0 ? walk.cell + 1u == walk.cells : walk.cell == 0u) return false;
    walk.cell = walk.direction > 0.0 ? walk.cell + 1u : walk.cell - 1u;
    return true;
}

FacadeHit facade_miss() { return FacadeHit(false, 0.0, 0u, 2, 1.0, false); }

FacadeHit facade_hit(float t, uint label, int axis, float direction, bool at_edge) {
    return FacadeHit(true, t, label, axis, direction > 0.0 ? -1.0 : 1.0, at_edge);
}

// First hit at origin + t * direction with t >= begin.
FacadeHit cast_facade_ray(FacadeMap map, vec3 origin, vec3 direction, float begin, float margin) {
    vec3 low = vec3(-margin, -margin, map.depths.x);
    vec3 high = vec3(vec2(map.size & 0xffffu, map.size >> 16) + margin, map.depths.y);
    float enter = begin;
    float leave = kNever;
    int entry = -1;
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0.0) {
            if (origin[axis] < low[axis] || origin[axis] > high[axis]) return facade_miss();
            continue;
        }
        float to_low = (low[axis] - origin[axis]) / direction[axis];
        float to_high = (high[axis] - origin[axis]) / direction[axis];
        float near = min(to_low, to_high);
        if (near > enter) {
            enter = near;
            entry = axis;
        }
        leave = min(leave, max(to_low, to_high));
    }
    if (enter > leave) return facade_miss();

    FacadeWalk across = facade_walk(map, 0, origin, direction, margin, enter);
    FacadeWalk up = facade_walk(map, 1, origin, direction, margin, enter);
    uint label = facade_label(map, across.cell, up.cell);
    float t = enter;
    if (entry == 2) {
        // The top and bottom of the volume are whole surfaces: rounding must not put the ray below them.
        if (direction.z > 0.0 || label_depth(label) >= map.depths.y) return facade_hit(t, label, 2, direction.z, false);
    } else if (origin.z + t * direction.z < label_depth(label)) {
        if (entry < 0) return facade_hit(t, label, 2, -1.0, false);
        return facade_hit(t, label, entry, direction[entry], true);
    }
    uint most_steps = across.cells + up.cells + 2u;
    for (uint i = 0u; i < most_steps; ++i) {
        float next_across = facade_next(map.layer, across);
        float next_up = facade_next(map.layer, up);
        int axis = next_up < next_across ? 1 : 0;
        float until = max(t, min(next_up, next_across));
        float depth = label_depth(label);
        if (direction.z < 0.0 && origin.z + until * direction.z <= depth) {
            return facade_hit(clamp((depth - origin.z) / direction.z, t, until), label, 2, direction.z, false);
        }
        if (until >= kNever) return facade_miss();
        bool inside = axis == 0 ? facade_step(across) : facade_step(up);
        if (!inside || (direction.z > 0.0 && origin.z + until * direction.z > map.depths.y)) return facade_miss();
        label = facade_label(map, across.cell, up.cell);
        t = until;
        if (origin.z + t * direction.z < label_depth(label)) return facade_hit(t, label, axis, direction[axis], false);
    }
    return facade_hit(t, label, 2, -1.0, false);
}

#endif
