// Relief mapping (Policarpo et al. 2005, the paper's "RM"): 20 linear samples of the displacement along the ray, then 6 steps of bisection.
// Not exact: what is thinner than a sample's distance is missed, sides are taken for fronts. No include guard: reads texels by the
// functions of one renderer (facade_texels.glsl).

const uint kReliefLinear = 20u;
const uint kReliefBinary = 6u;

FacadeHit step_relief(FacadeMap map, FacadeRay ray, FacadeSpan span) {
    FacadeTexels texels = facade_texels(map, false);
    uint width = map_width(map);
    uint height = map_height(map);
    if (span.leave >= kNever) return facade_miss();
    float above = span.enter;
    float stride = (span.leave - span.enter) / float(kReliefLinear);
    for (uint i = span.axis == 2 ? 1u : 0u; i <= kReliefLinear; ++i) {
        COUNT_STEP();
        float t = min(span.enter + float(i) * stride, span.leave);
        uint x = facade_texel(ray, 0, t, width);
        uint y = facade_texel(ray, 1, t, height);
        uint label = texel_displacement(map, texels, x, y);
        bool below = !label_is_open(label) && ray.origin.z + t * ray.direction.z <= label_depth(label);
        // The bottom of the volume is solid wherever it is not open.
        below = below || (i == kReliefLinear && ray.direction.z < 0.0 && !label_is_open(label) &&
                          facade_plane_t(ray, 2, map_depth_min(map)) <= t);
        if (!below) {
            above = t;
            continue;
        }
        float under = t;
        for (uint j = 0u; j < kReliefBinary; ++j) {
            COUNT_STEP();
            float middle = 0.5 * (above + under);
            uint middle_x = facade_texel(ray, 0, middle, width);
            uint middle_y = facade_texel(ray, 1, middle, height);
            uint middle_label = texel_displacement(map, texels, middle_x, middle_y);
            if (!label_is_open(middle_label) && ray.origin.z + middle * ray.direction.z <= label_depth(middle_label)) {
                under = middle;
                x = middle_x;
                y = middle_y;
                label = middle_label;
            } else {
                above = middle;
            }
        }
        FacadeHit hit = facade_hit(under, label | texel_material(map, x, y) << 16, 2, -1.0);
        return hit;
    }
    return facade_miss();
}
