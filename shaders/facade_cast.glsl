// Casts a ray against a facade map: FACADE_RENDERER (a number of facade_renderer_layout.h) says how, the map's form by which lookup. No include
// guard: a program on the CPU includes it once for each renderer. Parts and rules: facade_ray.glsl.
#include "client/render/facade_renderer_layout.h"
#include "shaders/facade_ray.glsl"

#if FACADE_RENDERER == FACADE_RENDERER_PATCH

#include "shaders/facade_step_patch.glsl"

bool facade_form_is_known(FacadeMap map) { return map_form(map) == uint(FACADE_FORM_PATCH); }
uint facade_label(FacadeMap map, uint x, uint y) { return lookup_patch(map, x, y); }
FacadeHit step_ray(FacadeMap map, FacadeRay ray, FacadeSpan span) { return step_patch(map, ray, span); }

#elif FACADE_RENDERER == FACADE_RENDERER_QUOTIENT

#include "shaders/facade_step_tiled.glsl"

bool facade_form_is_known(FacadeMap map) {
    return map_form(map) == uint(FACADE_FORM_QUOTIENT) || map_form(map) == uint(FACADE_FORM_TILED);
}

uint facade_label(FacadeMap map, uint x, uint y) {
    if (map_form(map) == uint(FACADE_FORM_TILED)) return lookup_tiled(map, x, y);
    return lookup_quotient(map, x, y);
}

FacadeHit step_ray(FacadeMap map, FacadeRay ray, FacadeSpan span) { return step_quotient(map, ray, span); }

#elif FACADE_RENDERER == FACADE_RENDERER_MAX_MIP

#include "shaders/facade_step_max_mip.glsl"

bool facade_form_is_known(FacadeMap map) { return map_form(map) == uint(FACADE_FORM_MAX_MIP); }
uint facade_label(FacadeMap map, uint x, uint y) { return lookup_max_mip(map, x, y); }
FacadeHit step_ray(FacadeMap map, FacadeRay ray, FacadeSpan span) { return step_max_mip(map, ray, span); }

#else

#include "shaders/facade_texels.glsl"
#include "shaders/facade_step_boxes.glsl"
#include "shaders/facade_step_relief.glsl"

// A map that the factors refused comes raw.
bool facade_form_is_known(FacadeMap map) { return map_form(map) == uint(FACADE_FORM_RAW) || texels_are_factors(map); }

uint facade_label(FacadeMap map, uint x, uint y) {
    FacadeTexels texels = facade_texels(map, false);
    return texel_displacement(map, texels, x, y) | texel_material(map, x, y) << 16;
}

FacadeHit step_ray(FacadeMap map, FacadeRay ray, FacadeSpan span) {
#if FACADE_RENDERER == FACADE_RENDERER_RM || FACADE_RENDERER == FACADE_RENDERER_CRM || FACADE_RENDERER == FACADE_RENDERER_BCRM
    return step_relief(map, ray, span);
#else
    return step_boxes(map, ray, span);
#endif
}

#endif

// First hit at origin + t * direction with t >= begin. `margin` (texels) widens the facade's edges. Precondition: facade_form_is_known.
FacadeHit cast_facade_ray(FacadeMap map, vec3 origin, vec3 direction, float begin, float margin) {
    FacadeRay ray = facade_ray(origin, direction);
    FacadeSpan span = facade_clip(map, ray, begin, margin);
    if (span.enter > span.leave) return facade_miss();
    if (span.axis == 2 && ray.direction.z > 0.0) ray.back = span.enter;
    FacadeHit hit = step_ray(map, ray, span);
    hit.at_edge = hit.hit && hit.axis != 2 && hit.axis == span.axis && hit.t <= span.enter;
    return hit;
}
