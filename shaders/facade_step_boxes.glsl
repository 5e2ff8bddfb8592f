// Steps from free box to free box (the paper's section 4.2): each step intersects the six planes of the box over the texel under the ray
// (four sides, its bottom at the texel's displacement, the volume's top or the ray's end) and goes to the least of them. Exact: sides are
// crossed by whole texel numbers, never by rounded places. No include guard: reads texels by the functions of one renderer
// (facade_texels.glsl).

FacadeHit boxes_hit(FacadeMap map, FacadeHit hit, uint x, uint y) {
    hit.label = hit.label | texel_material(map, x, y) << 16;
    return hit;
}

FacadeHit step_boxes(FacadeMap map, FacadeRay ray, FacadeSpan span) {
    FacadeTexels texels = facade_texels(map, true);
    uint width = map_width(map);
    uint height = map_height(map);
    uint x = facade_texel(ray, 0, span.enter, width);
    uint y = facade_texel(ray, 1, span.enter, height);
    float t = span.enter;
    uint label = texel_displacement(map, texels, x, y);
    FacadeHit hit = facade_arrive(ray, t, span.axis, label);
    // Every step leaves a texel for good.
    uint most_steps = STEP_BOUND(width + height + 2u);
    for (uint i = 0u; i < most_steps; ++i) {
        if (hit.hit) return boxes_hit(map, hit, x, y);
        COUNT_STEP();
        uvec4 box = texel_box(map, texels, x, y);
        bool right = ray.direction.x > 0.0;
        bool up = ray.direction.y > 0.0;
        // The facade's own edges are not crossed: the ray ends there.
        float across_t = (right ? box.y == width : box.x == 0u) ? kNever : facade_break_t(ray, 0, float(right ? box.y : box.x));
        float up_t = (up ? box.w == height : box.z == 0u) ? kNever : facade_break_t(ray, 1, float(up ? box.w : box.z));
        float until = max(t, min(min(across_t, up_t), span.leave));
        bool falls = ray.direction.z < 0.0 && !label_is_open(label);
        float bottom = falls ? max(t, facade_plane_t(ray, 2, label_depth(label))) : kNever;
        int axis = -1;
        if (bottom <= until) {
            t = bottom;
            uint low_x = x;
            uint low_y = y;
            x = clamp(facade_texel(ray, 0, t, width), box.x, box.y - 1u);
            y = clamp(facade_texel(ray, 1, t, height), box.z, box.w - 1u);
            axis = 2;
            if (x == low_x && y == low_y) return boxes_hit(map, facade_hit(t, label, 2, ray.direction.z), x, y);
        } else {
            if (until >= span.leave) return facade_miss();
            t = until;
            axis = up_t < across_t ? 1 : 0;
            if (axis == 0) {
                x = right ? box.y : box.x - 1u;
                y = clamp(facade_texel(ray, 1, t, height), box.z, box.w - 1u);
            } else {
                y = up ? box.w : box.z - 1u;
                x = clamp(facade_texel(ray, 0, t, width), box.x, box.y - 1u);
            }
        }
        uint bottom_label = label;
        label = texel_displacement(map, texels, x, y);
        if (axis == 2 && label == bottom_label) return boxes_hit(map, facade_hit(t, label, 2, ray.direction.z), x, y);
        hit = facade_arrive(ray, t, axis, label);
    }
    return boxes_hit(map, facade_stuck(t, label), x, y);
}
