// What boxes and relief mapping read of a map, texel by texel: raw, or by the factors that FACADE_RENDERER is for. No include guard: the
// functions are of one renderer.
#include "shaders/facade_lookup_raw.glsl"
#if FACADE_RENDERER == FACADE_RENDERER_CRM || FACADE_RENDERER == FACADE_RENDERER_CFDM
#include "shaders/facade_lookup_svd.glsl"
#elif FACADE_RENDERER == FACADE_RENDERER_BCRM || FACADE_RENDERER == FACADE_RENDERER_BCFDM
#include "shaders/facade_lookup_binary.glsl"
#endif

#if FACADE_RENDERER == FACADE_RENDERER_CRM || FACADE_RENDERER == FACADE_RENDERER_CFDM

#define TEXEL_FACTORS uvec4
uint factor_form() { return uint(FACADE_FORM_SVD); }
uvec4 no_factors() { return uvec4(0u); }
uvec4 displacement_factors(FacadeMap map) { return map.own; }
uvec4 box_index_factors(FacadeMap map) { return svd_factors(map, uint(FACADE_SVD_WORD_BOX_INDEX)); }
// First word of the boxes, and how many there are.
uvec2 factored_boxes(FacadeMap map) { return uvec2(map.head.w, layer_word(map.layer, uint(FACADE_SVD_WORD_BOX_COUNT))); }
uint factored_entry(FacadeMap map, uvec4 factors, uint x, uint y) { return svd_entry(map, factors, x, y); }
uint factored_material(FacadeMap map, uint x, uint y) { return svd_material(map, x, y); }

#elif FACADE_RENDERER == FACADE_RENDERER_BCRM || FACADE_RENDERER == FACADE_RENDERER_BCFDM

#define TEXEL_FACTORS BinaryFactors
uint factor_form() { return uint(FACADE_FORM_BINARY); }
BinaryFactors no_factors() { return BinaryFactors(uvec4(0u), uvec4(0u)); }
BinaryFactors displacement_factors(FacadeMap map) { return binary_displacement_factors(map); }
BinaryFactors box_index_factors(FacadeMap map) { return binary_factors(map, uint(FACADE_BINARY_WORD_BOX_INDEX)); }
uvec2 factored_boxes(FacadeMap map) {
    uvec4 boxes = layer_words4(map.layer, uint(FACADE_BINARY_WORD_BOXES >> 2));
    return uvec2(boxes.x, boxes.y);
}
uint factored_entry(FacadeMap map, BinaryFactors factors, uint x, uint y) { return binary_entry(map, factors, x, y); }
uint factored_material(FacadeMap map, uint x, uint y) { return binary_material(map, x, y); }

#endif

#ifdef TEXEL_FACTORS

// What a whole ray needs.
struct FacadeTexels {
    TEXEL_FACTORS displacement;
    TEXEL_FACTORS box_index;  // where boxes are asked for
    uint boxes;               // first word
    uint last_box;
};

bool texels_are_factors(FacadeMap map) { return map_form(map) == factor_form(); }

FacadeTexels facade_texels(FacadeMap map, bool with_boxes) {
    if (!texels_are_factors(map)) return FacadeTexels(no_factors(), no_factors(), map.own.w, 0u);
    if (!with_boxes) return FacadeTexels(displacement_factors(map), no_factors(), 0u, 0u);
    uvec2 boxes = factored_boxes(map);
    return FacadeTexels(displacement_factors(map), box_index_factors(map), boxes.x, boxes.y - 1u);
}

uint texel_displacement(FacadeMap map, FacadeTexels texels, uint x, uint y) {
    if (!texels_are_factors(map)) return raw_displacement(map, x, y);
    return factored_entry(map, texels.displacement, x, y) & 0xffffu;
}
uint texel_material(FacadeMap map, uint x, uint y) {
    if (!texels_are_factors(map)) return raw_material(map, x, y);
    return factored_material(map, x, y);
}
uint texel_box_index(FacadeMap map, FacadeTexels texels, uint x, uint y) {
    if (!texels_are_factors(map)) return raw_box_index(map, x, y);
    return min(factored_entry(map, texels.box_index, x, y), texels.last_box);
}

#undef TEXEL_FACTORS

#else

struct FacadeTexels {
    uint boxes;
};

bool texels_are_factors(FacadeMap map) { return false; }
FacadeTexels facade_texels(FacadeMap map, bool with_boxes) { return FacadeTexels(map.own.w); }
uint texel_displacement(FacadeMap map, FacadeTexels texels, uint x, uint y) { return raw_displacement(map, x, y); }
uint texel_material(FacadeMap map, uint x, uint y) { return raw_material(map, x, y); }
uint texel_box_index(FacadeMap map, FacadeTexels texels, uint x, uint y) { return raw_box_index(map, x, y); }

#endif

// Sides of the free box over a texel: x0, x1, y0, y1. A raw map without boxes has one a texel.
uvec4 texel_box(FacadeMap map, FacadeTexels texels, uint x, uint y) {
    if (!texels_are_factors(map) && !raw_has_boxes(map)) return uvec4(x, x + 1u, y, y + 1u);
    uint box = texel_box_index(map, texels, x, y);
    uvec4 pair = layer_words4(map.layer, (texels.boxes >> 2) + (box >> 1));
    uint across = (box & 1u) == 0u ? pair.x : pair.z;
    uint up = (box & 1u) == 0u ? pair.y : pair.w;
    return uvec4(across & 0xffffu, across >> 16, up & 0xffffu, up >> 16);
}
