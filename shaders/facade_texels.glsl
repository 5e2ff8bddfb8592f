// What boxes and relief mapping read of a map, texel by texel: raw, or by the factors that FACADE_RENDERER is for. No include guard: the
// functions are of one renderer.
#include "shaders/facade_lookup_raw.glsl"
#if FACADE_RENDERER == FACADE_RENDERER_CRM || FACADE_RENDERER == FACADE_RENDERER_CFDM
#include "shaders/facade_lookup_svd.glsl"
#elif FACADE_RENDERER == FACADE_RENDERER_BCRM || FACADE_RENDERER == FACADE_RENDERER_BCFDM
#include "shaders/facade_lookup_binary.glsl"
#endif

#if FACADE_RENDERER == FACADE_RENDERER_CRM || FACADE_RENDERER == FACADE_RENDERER_CFDM

// Factors that a whole ray needs.
struct FacadeTexels {
    uvec4 box_index;  // factors of A, where boxes are asked for
    uint boxes;       // first word of the boxes
    uint last_box;
};

bool texels_are_factors(FacadeMap map) { return map_form(map) == uint(FACADE_FORM_SVD); }

FacadeTexels facade_texels(FacadeMap map, bool with_boxes) {
    if (!texels_are_factors(map) || !with_boxes) return FacadeTexels(uvec4(0u), map.own.w, 0u);
    return FacadeTexels(svd_factors(map, uint(FACADE_SVD_WORD_BOX_INDEX)), map.head.w,
                        layer_word(map.layer, uint(FACADE_SVD_WORD_BOX_COUNT)) - 1u);
}

uint texel_displacement(FacadeMap map, FacadeTexels texels, uint x, uint y) {
    if (!texels_are_factors(map)) return raw_displacement(map, x, y);
    return svd_entry(map, map.own, x, y) & 0xffffu;
}
uint texel_material(FacadeMap map, uint x, uint y) {
    if (!texels_are_factors(map)) return raw_material(map, x, y);
    return svd_material(map, x, y);
}
uint texel_box_index(FacadeMap map, FacadeTexels texels, uint x, uint y) {
    if (!texels_are_factors(map)) return raw_box_index(map, x, y);
    return min(svd_entry(map, texels.box_index, x, y), texels.last_box);
}

#elif FACADE_RENDERER == FACADE_RENDERER_BCRM || FACADE_RENDERER == FACADE_RENDERER_BCFDM

struct FacadeTexels {
    BinaryFactors displacement;
    BinaryFactors box_index;  // where boxes are asked for
    uint boxes;
    uint last_box;
};

bool texels_are_factors(FacadeMap map) { return map_form(map) == uint(FACADE_FORM_BINARY); }

FacadeTexels facade_texels(FacadeMap map, bool with_boxes) {
    BinaryFactors none = BinaryFactors(uvec4(0u), uvec4(0u));
    if (!texels_are_factors(map)) return FacadeTexels(none, none, map.own.w, 0u);
    BinaryFactors displacement = binary_displacement_factors(map);
    if (!with_boxes) return FacadeTexels(displacement, none, 0u, 0u);
    uvec4 boxes = layer_words4(map.layer, uint(FACADE_BINARY_WORD_BOXES >> 2));
    return FacadeTexels(displacement, binary_factors(map, uint(FACADE_BINARY_WORD_BOX_INDEX)), boxes.x, boxes.y - 1u);
}

uint texel_displacement(FacadeMap map, FacadeTexels texels, uint x, uint y) {
    if (!texels_are_factors(map)) return raw_displacement(map, x, y);
    return binary_entry(map, texels.displacement, x, y) & 0xffffu;
}
uint texel_material(FacadeMap map, uint x, uint y) {
    if (!texels_are_factors(map)) return raw_material(map, x, y);
    return binary_material(map, x, y);
}
uint texel_box_index(FacadeMap map, FacadeTexels texels, uint x, uint y) {
    if (!texels_are_factors(map)) return raw_box_index(map, x, y);
    return min(binary_entry(map, texels.box_index, x, y), texels.last_box);
}

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
