// What the parts of facade ray casting share: the map, the ray, the hit, and the rules that decide where a ray hits. Written in the common
// subset of GLSL and C++ (words.glsl).
//
// Facade space: u right, v up in texels of the map, w outwards in millimetres. The volume is 0..width x 0..height x depth_min..depth_max;
// what lies below the displacement is solid down to depth_min, an open texel is air all the way. Twin of codec/facade/facade_ray.h.
//
// Parts:
//   lookup   shaders/facade_lookup_FORM.glsl   uint lookup_FORM(FacadeMap map, uint x, uint y)
//            The label (displacement | material << 16) of texel x < width, y < height (row 0 at the bottom).
//   stepper  shaders/facade_step_FORM.glsl     FacadeHit step_FORM(FacadeMap map, FacadeRay ray, FacadeSpan span)
//            The first hit at span.enter <= t <= span.leave, or facade_miss(). The ray is already clipped to the volume (widened by the
//            caller's margin at the four edges, so coordinates can lie a little outside 0..size: facade_texel clamps them; the first and
//            last cells reach to the margin: their outer breaks are never crossed, span.leave ends the ray there).
// A stepper calls facade_arrive(ray, t, axis, label) for the first cell with (span.enter, span.axis) and for every cell that it steps into
// with the axis it crossed (0 u, 1 v); then facade_front(ray, t, until, label) with the t at which the ray leaves the cell, never more than
// span.leave; and ends with a miss when that is span.leave. On a break the ray is in the cell that it goes into (the upper one when it runs
// along the break); at equal t a step in u goes first. Surfaces are compared by these functions alone (never by z at t), so that
// neighbouring cells decide alike whatever is rounded; whole bands, stripes and blocks are passed where facade_passes(ray, t, until, highest)
// says so. A stepper counts COUNT_STEP() per step and is bounded: after its most steps it answers facade_stuck(t, label).
// A device may end a ray sooner (llvmpipe stops looping after 65,535 iterations of all loops of a fragment together), and a lane that is not
// drawn holds anything: its material is then any number, and whoever indexes by it clamps it.
// facade_cast.glsl chooses the stepper by renderer and by the map's form.
#ifndef CITYSTREAM_FACADE_RAY_GLSL
#define CITYSTREAM_FACADE_RAY_GLSL

#include "codec/facade/facade_form_layout.h"
#include "shaders/bits.glsl"

const float kNever = 1e30;

struct FacadeMap {
    uvec2 layer;
    uvec4 head;  // words 0..3 of the map: the head that all forms share, and the form's own first word
    uvec4 own;   // words 4..7
};

// Points origin + t * direction. Components of the direction are 0 or not tiny.
struct FacadeRay {
    vec3 origin;
    vec3 direction;
    vec3 inverse;  // 1 / direction; 0 where the direction is 0
    float back;    // t at which it comes in through the back, -kNever when it does not
};

struct FacadeSpan {
    float enter;  // the part of the ray in the volume
    float leave;
    int axis;     // of the face it comes in by: 0 u, 1 v (edges), 2 w (top or back), -1: the ray starts inside
};

struct FacadeHit {
    bool hit;
    float t;
    uint label;
    int axis;      // of the normal: 0 u, 1 v, 2 w
    float side;    // sign of the normal
    bool at_edge;  // on the way in, through an edge of the facade (set by cast_facade_ray)
};

FacadeMap facade_map(uvec2 layer) { return FacadeMap(layer, layer_words4(layer, 0u), layer_words4(layer, 1u)); }

uint map_form(FacadeMap map) { return map.head.x >> 16; }
uint map_width(FacadeMap map) { return map.head.y & 0xffffu; }
uint map_height(FacadeMap map) { return map.head.y >> 16; }

// Displacement in millimetres.
float label_depth(uint label) { return float(int(label << 16) >> 16); }
bool label_is_open(uint label) { return (label & 0xffffu) == (uint(FACADE_OPEN_DISPLACEMENT) & 0xffffu); }
float map_depth_min(FacadeMap map) { return label_depth(map.head.z); }
float map_depth_max(FacadeMap map) { return label_depth(map.head.z >> 16); }

float facade_inverse(float direction) { return direction == 0.0 ? 0.0 : 1.0 / direction; }

FacadeRay facade_ray(vec3 origin, vec3 direction) {
    // What moves less than a thousandth of a texel in any span is parallel: its reciprocal would not be finite.
    const float kTiny = 1e-18;
    vec3 d = vec3(abs(direction.x) < kTiny ? 0.0 : direction.x, abs(direction.y) < kTiny ? 0.0 : direction.y,
                  abs(direction.z) < kTiny ? 0.0 : direction.z);
    return FacadeRay(origin, d, vec3(facade_inverse(d.x), facade_inverse(d.y), facade_inverse(d.z)), -kNever);
}

// Where the ray meets the plane of an axis. Precondition: its direction there is not 0.
float facade_plane_t(FacadeRay ray, int axis, float at) { return (at - ray.origin[axis]) * ray.inverse[axis]; }

// The same for breaks of cells: kNever when the ray runs along them.
float facade_break_t(FacadeRay ray, int axis, float at) {
    return ray.direction[axis] == 0.0 ? kNever : (at - ray.origin[axis]) * ray.inverse[axis];
}

FacadeHit facade_miss() { return FacadeHit(false, 0.0, 0u, 2, 1.0, false); }

FacadeHit facade_hit(float t, uint label, int axis, float direction) {
    return FacadeHit(true, t, label, axis, direction > 0.0 ? -1.0 : 1.0, false);
}

// Stated fallback when a stepper's bound is reached (rounding, or a map that lies): the front of the cell where the ray is. No hole.
FacadeHit facade_stuck(float t, uint label) { return facade_hit(t, label, 2, -1.0); }

// Whether the ray at t is in what reaches up to `depth`; on the back it is in all.
bool facade_is_below(FacadeRay ray, float t, float depth) {
    if (ray.direction.z == 0.0) return ray.origin.z < depth;
    float surface = facade_plane_t(ray, 2, depth);
    return ray.direction.z < 0.0 ? t > surface : t < surface || t <= ray.back;
}

// The ray comes to a cell at t through a plane of `axis` (-1: it starts there): hits the back, or the side when it comes in below the front.
FacadeHit facade_arrive(FacadeRay ray, float t, int axis, uint label) {
    if (label_is_open(label) || !facade_is_below(ray, t, label_depth(label))) return facade_miss();
    if (t <= ray.back) return facade_hit(t, label, 2, ray.direction.z);
    if (axis < 0) return facade_hit(t, label, 2, -1.0);
    return facade_hit(t, label, axis, axis == 0 ? ray.direction.x : ray.direction.y);
}

// The ray, not below the cell's front at t, stays in the cell until `until`: hits the front, or does not.
FacadeHit facade_front(FacadeRay ray, float t, float until, uint label) {
    if (ray.direction.z >= 0.0 || label_is_open(label)) return facade_miss();
    float front = facade_plane_t(ray, 2, label_depth(label));
    if (front > until) return facade_miss();
    return facade_hit(max(front, t), label, 2, ray.direction.z);
}

// Whether the ray from t to `until` keeps above all that is not higher than `highest`.
bool facade_passes(FacadeRay ray, float t, float until, float highest) {
    if (ray.direction.z < 0.0) return facade_plane_t(ray, 2, highest) > until;
    return !facade_is_below(ray, t, highest);
}

// The texel at t along one axis; on a break, the one that the ray goes into.
uint facade_texel(FacadeRay ray, int axis, float t, uint size) {
    float at = ray.origin[axis] + t * ray.direction[axis];
    float texel = ray.direction[axis] < 0.0 ? ceil(at) - 1.0 : floor(at);
    return uint(clamp(texel, 0.0, float(size - 1u)));
}

// The part of the ray in the volume from t = begin on; enter > leave when it misses. `margin` widens the four edges.
FacadeSpan facade_clip(FacadeMap map, FacadeRay ray, float begin, float margin) {
    vec3 low = vec3(-margin, -margin, map_depth_min(map));
    vec3 high = vec3(float(map_width(map)) + margin, float(map_height(map)) + margin, map_depth_max(map));
    FacadeSpan span = FacadeSpan(begin, kNever, -1);
    for (int axis = 0; axis < 3; ++axis) {
        if (ray.direction[axis] == 0.0) {
            if (ray.origin[axis] < low[axis] || ray.origin[axis] > high[axis]) span.leave = -kNever;
            continue;
        }
        float to_low = facade_plane_t(ray, axis, low[axis]);
        float to_high = facade_plane_t(ray, axis, high[axis]);
        float near = min(to_low, to_high);
        if (near > span.enter) {
            span.enter = near;
            span.axis = axis;
        }
        span.leave = min(span.leave, max(to_low, to_high));
    }
    return span;
}

#endif
