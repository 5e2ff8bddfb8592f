// Walks the maximum mip form: passes blocks of 2^k x 2^k texels whose highest displacement lies below the ray, goes straight down to it and a
// level down in those where it does not, and a level up where it leaves the block above. Exact: blocks are left by whole texel numbers.
#ifndef CITYSTREAM_FACADE_STEP_MAX_MIP_GLSL
#define CITYSTREAM_FACADE_STEP_MAX_MIP_GLSL

#include "shaders/facade_lookup_max_mip.glsl"

// Where rays begin: higher blocks reach up to the top nearly everywhere (measured: the fewest loads on the facades of bench_facade).
const uint kFirstLevel = 5u;

FacadeHit step_max_mip(FacadeMap map, FacadeRay ray, FacadeSpan span) {
    uint width = map_width(map);
    uint height = map_height(map);
    uint top = (map.head.w >> 8) - 1u;
    bool right = ray.direction.x > 0.0;
    bool up = ray.direction.y > 0.0;
    uint x = facade_texel(ray, 0, span.enter, width);
    uint y = facade_texel(ray, 1, span.enter, height);
    float t = span.enter;
    int axis = span.axis;
    uint level = min(top, kFirstLevel);
    uint base = max_mip_level_base(map, level);
    // Every texel that the ray crosses costs at most a way down all levels.
    uint most_steps = STEP_BOUND((width + height + 2u) * (top + 1u));
    for (uint i = 0u; i < most_steps; ++i) {
        COUNT_STEP();
        uint x0 = x >> level << level;
        uint y0 = y >> level << level;
        uint x1 = min(x0 + (1u << level), width);
        uint y1 = min(y0 + (1u << level), height);
        float across_t = (right ? x1 == width : x0 == 0u) ? kNever : facade_break_t(ray, 0, float(right ? x1 : x0));
        float up_t = (up ? y1 == height : y0 == 0u) ? kNever : facade_break_t(ray, 1, float(up ? y1 : y0));
        float until = max(t, min(min(across_t, up_t), span.leave));
        uint label = max_mip_entry(map, base, level, x >> level, y >> level);
        if (!facade_passes(ray, t, until, label_depth(label))) {
            if (level > 0u) {
                float down = ray.direction.z < 0.0 ? facade_plane_t(ray, 2, label_depth(label)) : t;
                if (down > t) {
                    t = down;
                    x = clamp(facade_texel(ray, 0, t, width), x0, x1 - 1u);
                    y = clamp(facade_texel(ray, 1, t, height), y0, y1 - 1u);
                }
                level = level - 1u;
                base -= max_mip_level_words(map, level);
                continue;
            }
            FacadeHit hit = facade_arrive(ray, t, axis, label);
            if (!hit.hit) hit = facade_front(ray, t, until, label);
            if (hit.hit) {
                hit.label = label | max_mip_material(map, x, y) << 16;
                return hit;
            }
        }
        if (until >= span.leave) return facade_miss();
        t = until;
        uint from_x = x;
        uint from_y = y;
        if (up_t < across_t) {
            axis = 1;
            y = up ? y1 : y0 - 1u;
            x = clamp(facade_texel(ray, 0, t, width), x0, x1 - 1u);
        } else {
            axis = 0;
            x = right ? x1 : x0 - 1u;
            y = clamp(facade_texel(ray, 1, t, height), y0, y1 - 1u);
        }
        // In the block above, it would be found too low again.
        if (level < top && ((x ^ from_x) | (y ^ from_y)) >> (level + 1u) != 0u) {
            base += max_mip_level_words(map, level);
            level = level + 1u;
        }
    }
    return facade_stuck(t, lookup_max_mip(map, x, y));
}

#endif
