// A chart of the tile's pages as it goes from what shows it to the colour: what mesh triangles and facade materials share.
#ifndef CITYSTREAM_PAGE_CHART_GLSL
#define CITYSTREAM_PAGE_CHART_GLSL

#include "codec/chart_word_layout.h"
#include "shaders/draw_constants.glsl"
#include "shaders/page_sample.glsl"

const uint kFlatPage = ~0u;

struct PageSurface {
    uvec3 place;  // page (kFlatPage: one colour, the first word of the frame); coarsest level of the pages; unused
    uvec4 frame;  // bits of the chart's frame (wrap_coordinate.glsl)
};

PageSurface flat_surface(uint colour) { return PageSurface(uvec3(kFlatPage, 0u, 0u), uvec4(colour, 0u, 0u, 0u)); }
PageSurface page_surface(Pages pages, uint page, vec4 frame) {
    return PageSurface(uvec3(page, pages.mips, 0u), floatBitsToUint(frame));
}
PageSurface surface_of(Pages pages, PagedChart chart) {
    if ((chart.flags & PAGES_CHART_FLAT) != 0u) return flat_surface(chart.u & 0xffffffu);
    return page_surface(pages, chart.flags >> 16, paged_frame(pages, chart));
}

// Precondition: the tile's atlas is in `pages`.
PageSurface surface_of_word(Pages pages, uint chart_word) {
    if ((chart_word & CHART_WORD_COLOUR) != 0u) return flat_surface(chart_word & CHART_WORD_COLOUR_MASK);
    return surface_of(pages, paged_chart(pages, chart_word));
}

// place in repeats; dx, dy: its change from pixel to pixel.
vec3 sample_surface(PageSurface surface, vec2 place, vec2 dx, vec2 dy) {
    if (surface.place.x == kFlatPage) return unpackUnorm4x8(surface.frame.x).rgb;
    Pages pages = Pages(layer_reference(constants.tile.atlas), surface.place.y, 0u, 0u);
    float finest = min(constants.tile.atlas_finest_mip, float(pages.mips));
    return sample_paged(pages, surface.place.x, uintBitsToFloat(surface.frame), place, dx, dy, finest);
}

#endif
