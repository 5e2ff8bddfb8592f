// Walks the quotient or the tiled form of a facade map: through blocks of 2^BLOCK_LOG2 x 2^BLOCK_LOG2 texels straight down to their greatest
// displacement, below it from run cell to run cell. Exact: cells and blocks are left by whole texel numbers.
#ifndef CITYSTREAM_FACADE_STEP_QUOTIENT_GLSL
#define CITYSTREAM_FACADE_STEP_QUOTIENT_GLSL

#include "shaders/facade_lookup_quotient.glsl"
#include "shaders/facade_lookup_tiled.glsl"

// One axis of the walk.
struct RunWalk {
    uint breaks;      // first group of the breaks
    uint size;
    uint group;       // the group of breaks that is at hand
    uvec4 group_words;
    FacadeRun run;
    uint key;         // what lookups know the run by: its class, or the run itself
};

RunWalk run_walk(uint breaks, uint size) {
    return RunWalk(breaks, size, 0xffffffffu, uvec4(0u), FacadeRun(0u, 0u, 0u), 0u);
}

// Moves the walk to the run of a texel.
void run_walk_to(FacadeMap map, INOUT(RunWalk) walk, int axis, uint texel) {
    if (texel >= walk.run.begin && texel < walk.run.end) return;
    uint group = texel / uint(RUN_GROUP_TEXELS);
    if (group != walk.group) {
        walk.group = group;
        walk.group_words = layer_words4(map.layer, walk.breaks + group);
    }
    uint first = group * uint(RUN_GROUP_TEXELS);
    walk.run = group_run(walk.group_words, first, texel - first);
    walk.key = walk.run.index;
    if (map_form(map) == uint(FACADE_FORM_QUOTIENT)) {
        walk.key = axis == 0 ? quotient_column(map, walk.run.begin) : quotient_row(map, walk.run.begin);
    }
}

// Where the ray leaves the texels begin..end - 1 of an axis; kNever behind the last.
float run_exit(FacadeRay ray, int axis, uint begin, uint end, uint size) {
    bool rises = ray.direction[axis] > 0.0;
    if (rises ? end >= size : begin == 0u) return kNever;
    return facade_break_t(ray, axis, float(rises ? end : begin));
}

FacadeHit step_quotient(FacadeMap map, FacadeRay ray, FacadeSpan span) {
    uint width = map_width(map);
    uint height = map_height(map);
    RunWalk across = run_walk(uint(RUN_BREAKS_GROUP), width);
    RunWalk up = run_walk(run_row_breaks(map), height);
    uint maxima = run_block_maxima(map);
    uint blocks_across = (width + (1u << uint(BLOCK_LOG2)) - 1u) >> uint(BLOCK_LOG2);
    uint x = facade_texel(ray, 0, span.enter, width);
    uint y = facade_texel(ray, 1, span.enter, height);
    float t = span.enter;
    int axis = span.axis;
    uint tested = 0xffffffffu;
    // A step leaves a texel column, a texel row, or the part of a block above its greatest displacement; and one begins the walk.
    uint most_steps = STEP_BOUND(2u * (width + height) + 2u);
    for (uint i = 0u; i < most_steps; ++i) {
        COUNT_STEP();
        uint x0 = x >> uint(BLOCK_LOG2) << uint(BLOCK_LOG2);
        uint y0 = y >> uint(BLOCK_LOG2) << uint(BLOCK_LOG2);
        uint x1 = x0 + (1u << uint(BLOCK_LOG2));
        uint y1 = y0 + (1u << uint(BLOCK_LOG2));
        uint block = (y >> uint(BLOCK_LOG2)) * blocks_across + (x >> uint(BLOCK_LOG2));
        bool passes = false;
        if (block != tested) {
            tested = block;
            uint level = layer_word(map.layer, 4u * maxima + (block >> 2)) >> (8u * (block & 3u)) & 255u;
            float greatest = block_greatest(map, level);
            float leave = min(min(run_exit(ray, 0, x0, x1, width), run_exit(ray, 1, y0, y1, height)), span.leave);
            passes = facade_passes(ray, t, max(t, leave), greatest);
            // Down to the greatest displacement nothing can be hit.
            float down = ray.direction.z < 0.0 ? facade_plane_t(ray, 2, greatest) : t;
            if (!passes && down > t) {
                t = down;
                axis = 2;
                x = clamp(facade_texel(ray, 0, t, width), x0, min(x1, width) - 1u);
                y = clamp(facade_texel(ray, 1, t, height), y0, min(y1, height) - 1u);
            }
        }
        if (!passes) {
            run_walk_to(map, across, 0, x);
            run_walk_to(map, up, 1, y);
            x0 = across.run.begin;
            x1 = across.run.end;
            y0 = up.run.begin;
            y1 = up.run.end;
        }
        float across_t = run_exit(ray, 0, x0, x1, width);
        float up_t = run_exit(ray, 1, y0, y1, height);
        float until = max(t, min(min(across_t, up_t), span.leave));
        if (!passes) {
            uint label = map_form(map) == uint(FACADE_FORM_QUOTIENT) ? quotient_class_label(map, across.key, up.key)
                                                               : tiled_run_label(map, across.key, up.key);
            FacadeHit hit = facade_arrive(ray, t, axis, label);
            if (!hit.hit) hit = facade_front(ray, t, until, label);
            if (hit.hit) return hit;
        }
        if (until >= span.leave) return facade_miss();
        t = until;
        if (up_t < across_t) {
            axis = 1;
            y = ray.direction.y > 0.0 ? y1 : y0 - 1u;
            x = clamp(facade_texel(ray, 0, t, width), x0, min(x1, width) - 1u);
        } else {
            axis = 0;
            x = ray.direction.x > 0.0 ? x1 : x0 - 1u;
            y = clamp(facade_texel(ray, 1, t, height), y0, min(y1, height) - 1u);
        }
    }
    return facade_stuck(t, map_form(map) == uint(FACADE_FORM_QUOTIENT) ? lookup_quotient(map, x, y) : lookup_tiled(map, x, y));
}

#endif
