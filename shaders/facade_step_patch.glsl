// Marches a ray through the patch form: over bands and stripes that it passes above, cell by cell through patches that reach up to it. Meets
// the same cells in the same order as a walk over all cells, decided by the same functions (facade_ray.glsl), so hits are exact. Every loop
// is bounded: bands, stripes and cells are left for good; all steps together by the map's size, with facade_stuck as the answer beyond.
#ifndef CITYSTREAM_FACADE_STEP_PATCH_GLSL
#define CITYSTREAM_FACADE_STEP_PATCH_GLSL

#include "shaders/facade_lookup_patch.glsl"

// How far the ray has come. `axis`: of the last plane crossed, as facade_arrive wants it.
struct PatchMarch {
    float t;
    int axis;
    bool is_over;
    FacadeHit hit;  // when over; its label's low half
    uint hit_label;  // index of the label
    uint steps_left;
    bool has_moved;  // from where it came in
    bool with_ties;  // breaks in u at exactly t have been crossed: a step in v was the last
    PatchGroup kept;    // bands, stripes and patches
    PatchGroup labels;
};

// A rectangle of the map and where the ray leaves it.
struct PatchExit {
    float along_t;  // kNever at the map's ends
    float across_t;
};

// Number of facade_ray's axis that runs along the bands; the other one crosses them.
int patch_along(PatchShape shape) { return shape.is_transposed ? 1 : 0; }

// At equal t a step in u goes first.
bool patch_leaves_along(PatchShape shape, PatchExit way) {
    return shape.is_transposed ? way.along_t < way.across_t : way.along_t <= way.across_t;
}

float patch_leave_t(PatchExit way, float t, FacadeSpan span) { return max(t, min(min(way.along_t, way.across_t), span.leave)); }

PatchPlace patch_place(FacadeRay ray, PatchMarch march, int axis, float texel) {
    if (!march.has_moved || ray.direction[axis] == 0.0) return patch_texel_place(texel);
    return PatchPlace(ray.origin[axis], ray.inverse[axis], ray.direction[axis] > 0.0, texel, march.t, march.with_ties && axis == 0,
                      ray.origin[axis] + march.t * ray.direction[axis]);
}

// Down to what is not higher than `highest`: nothing can be hit before. A march that has no steps left ends where it is.
void patch_descend(FacadeRay ray, INOUT(PatchMarch) march, float highest) {
    if (ray.direction.z >= 0.0 || march.steps_left == 0u) return;
    float t = facade_plane_t(ray, 2, highest);
    if (t <= march.t) return;
    march.t = t;
    march.has_moved = true;
    march.with_ties = false;
}

void patch_cross(INOUT(PatchMarch) march, float t, int axis) {
    march.t = t;
    march.axis = axis;
    march.has_moved = true;
    march.with_ties = axis == 1;
}

// Side and front of a cell of one label. True when the march is over.
bool patch_meet(PatchShape shape, FacadeRay ray, INOUT(PatchMarch) march, float until, uint label_index) {
    uint label = patch_label_depth(shape, march.labels, label_index);
    march.hit = facade_arrive(ray, march.t, march.axis, label);
    if (!march.hit.hit) march.hit = facade_front(ray, march.t, until, label);
    if (!march.hit.hit && march.steps_left == 0u) march.hit = facade_stuck(march.t, label);
    march.hit_label = label_index;
    march.is_over = march.hit.hit;
    return march.is_over;
}

// One step more; when there are none left, the next cell met ends the march.
void patch_count_step(INOUT(PatchMarch) march) {
    COUNT_STEP();
    if (march.steps_left > 0u) march.steps_left = march.steps_left - 1u;
}

// Cell by cell through a patch; `outer`: where the ray leaves the stripe. Ends at the cell from which it does.
void patch_march_cells(PatchShape shape, FacadeRay ray, FacadeSpan span, INOUT(PatchMarch) march, vec2 texel, PatchRun band, PatchRun stripe,
                       PatchExit outer) {
    Patch opened = patch_open(shape, march.kept, patch_stripe_content(shape, stripe.word) - shape.labels);
    int along = patch_along(shape);
    int across = 1 - along;
    patch_descend(ray, march, patch_stripe_max(shape, stripe.word));
    uint row = patch_cell(shape, opened.rows, patch_place(ray, march, across, texel[across]), band.low);
    uint column = patch_cell(shape, opened.columns, patch_place(ray, march, along, texel[along]), stripe.low);
    bool right = ray.direction[along] > 0.0;
    bool up = ray.direction[across] > 0.0;
    for (uint i = 0u; i <= opened.rows.count + opened.columns.count; ++i) {
        patch_count_step(march);
        bool last_column = right ? column == opened.columns.count : column == 0u;
        bool last_row = up ? row == opened.rows.count : row == 0u;
        PatchExit way = outer;
        if (!last_column) {
            float at = patch_break(shape, opened.columns, right ? column : column - 1u);
            way.along_t = facade_break_t(ray, along, stripe.low + at);
        }
        if (!last_row) {
            float at = patch_break(shape, opened.rows, up ? row : row - 1u);
            way.across_t = facade_break_t(ray, across, band.low + at);
        }
        float until = patch_leave_t(way, march.t, span);
        if (patch_meet(shape, ray, march, until, patch_cell_label(shape, opened, column, row))) return;
        if (until >= span.leave) return;
        bool leaves_along = patch_leaves_along(shape, way);
        if (leaves_along ? last_column : last_row) return;
        patch_cross(march, until, leaves_along ? along : across);
        if (leaves_along) column = right ? column + 1u : column - 1u;
        else row = up ? row + 1u : row - 1u;
    }
}

// To the next record of a list, upwards or downwards; its other end is read only where the ray leaves by it.
void patch_next(PatchShape shape, INOUT(PatchGroup) kept, PatchRecords records, INOUT(PatchRun) run, bool upwards) {
    run.index = upwards ? run.index + 1u : run.index - 1u;
    run.word = patch_word(shape.layer, kept, records.at + run.index * records.stride);
    if (upwards) {
        run.low = run.high;
        run.high = records.size;
        uint next = run.index + 1u;
        if (next < records.count) run.high = patch_record_low(records, patch_word(shape.layer, kept, records.at + next * records.stride));
    } else {
        run.high = run.low;
        run.low = patch_record_low(records, run.word);
    }
}

// Stripe by stripe through a band until the ray leaves it by `across_t`, or the facade.
void patch_march_stripes(PatchShape shape, FacadeRay ray, FacadeSpan span, INOUT(PatchMarch) march, vec2 texel, PatchRun band,
                         float across_t) {
    int along = patch_along(shape);
    PatchRecords stripes = patch_stripes(shape, march.kept, band.index, band.word);
    patch_descend(ray, march, patch_band_max(shape, band.word));
    PatchRun stripe = patch_find(shape, march.kept, stripes, patch_place(ray, march, along, texel[along]));
    bool right = ray.direction[along] > 0.0;
    for (uint i = 0u; i < stripes.count; ++i) {
        patch_count_step(march);
        bool is_last = right ? stripe.index + 1u == stripes.count : stripe.index == 0u;
        PatchExit way = PatchExit(is_last ? kNever : facade_break_t(ray, along, right ? stripe.high : stripe.low), across_t);
        float until = patch_leave_t(way, march.t, span);
        if (march.steps_left == 0u || !facade_passes(ray, march.t, until, patch_stripe_max(shape, stripe.word))) {
            uint content = patch_stripe_content(shape, stripe.word);
            if (content >= shape.labels) patch_march_cells(shape, ray, span, march, texel, band, stripe, way);
            else patch_meet(shape, ray, march, until, content);
            if (march.is_over) return;
        }
        if (until >= span.leave) {
            march.is_over = true;
            return;
        }
        if (!patch_leaves_along(shape, way)) return;
        patch_cross(march, until, along);
        patch_next(shape, march.kept, stripes, stripe, right);
    }
}

// Over the bands; what the march ends with is in it.
void patch_march_bands(PatchShape shape, FacadeRay ray, FacadeSpan span, INOUT(PatchMarch) march, vec2 texel) {
    int across = 1 - patch_along(shape);
    PatchRecords bands = patch_bands(shape);
    // By the texel alone.
    PatchRun band = patch_find(shape, march.kept, bands, patch_texel_place(texel[across]));
    bool up = ray.direction[across] > 0.0;
    for (uint i = 0u; i < bands.count; ++i) {
        patch_count_step(march);
        bool is_last = up ? band.index + 1u == bands.count : band.index == 0u;
        float across_t = is_last ? kNever : facade_break_t(ray, across, up ? band.high : band.low);
        float until = patch_leave_t(PatchExit(kNever, across_t), march.t, span);
        if (march.steps_left == 0u || !facade_passes(ray, march.t, until, patch_band_max(shape, band.word))) {
            patch_march_stripes(shape, ray, span, march, texel, band, across_t);
            if (march.is_over) return;
        }
        if (until >= span.leave || is_last) return;
        patch_cross(march, until, across);
        patch_next(shape, march.kept, bands, band, up);
    }
}

FacadeHit step_patch(FacadeMap map, FacadeRay ray, FacadeSpan span) {
    PatchShape shape = patch_shape(map);
    vec2 texel = vec2(float(facade_texel(ray, 0, span.enter, map_width(map))), float(facade_texel(ray, 1, span.enter, map_height(map))));
    uint most_steps = STEP_BOUND(3u * (map_width(map) + map_height(map)) + 3u);
    PatchMarch march =
        PatchMarch(span.enter, span.axis, false, facade_miss(), 0u, most_steps, false, false, patch_no_group(), patch_no_group());
    patch_march_bands(shape, ray, span, march, texel);
    if (!march.hit.hit) return facade_miss();
    march.hit.label = march.hit.label | patch_label_material(shape, march.labels, march.hit_label) << 16;
    return march.hit;
}

#endif
