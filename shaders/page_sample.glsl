// Samples charts that share pages, straight from the pages' BC1 blocks: bilinear, trilinear between the levels that the pages keep. Twin of
// PageLayerView in codec/atlas/page_layer.h. Written in the common subset of GLSL and C++ (words.glsl).
//
// A place beyond a chart's ends is wrapped into it and filtered across its border (wrap_coordinate.glsl), so no texel of another chart is read at any
// level, and none needs a test of its own. Levels above the coarsest one mix charts and are never sampled.
#ifndef CITYSTREAM_PAGE_SAMPLE_GLSL
#define CITYSTREAM_PAGE_SAMPLE_GLSL

#include "codec/atlas/page_layout.h"
#include "shaders/bc_blocks.glsl"
#include "shaders/words.glsl"
#include "shaders/wrap_coordinate.glsl"

// Of the whole layer.
struct Pages {
    uvec2 layer;
    uint mips;
    uint border;
    uint charts;  // word of the chart table
};

Pages pages_of(uvec2 layer) {
    uint mips = layer_word(layer, uint(PAGES_WORD_MIPS));
    uint charts = uint(PAGES_HEADER_WORDS) + uint(PAGES_PAGE_WORDS) * layer_word(layer, uint(PAGES_WORD_PAGE_COUNT));
    return Pages(layer, mips & 255u, mips >> 8, charts);
}

struct PagedChart {
    uint flags;  // PAGES_CHART_*, page << 16
    uint u;      // packed coordinate at place 0; colour of a flat chart
    uint v;
};

PagedChart paged_chart(Pages pages, uint index) {
    uint entry = pages.charts + uint(PAGES_CHART_WORDS) * index;
    return PagedChart(layer_word(pages.layer, entry + uint(PAGES_CHART_FLAGS)), layer_word(pages.layer, entry + uint(PAGES_CHART_U)),
                      layer_word(pages.layer, entry + uint(PAGES_CHART_V)));
}

// The frame as any transport brings it: sizes of axes that do not repeat are negative, so that the sampler clamps them.
vec4 paged_frame(Pages pages, PagedChart chart) {
    vec4 frame = wrap_frame(uvec2(chart.u, chart.v), pages.border);
    if ((chart.flags & PAGES_CHART_REPEAT_U) == 0u) frame.z = -frame.z;
    if ((chart.flags & PAGES_CHART_REPEAT_V) == 0u) frame.w = -frame.w;
    return frame;
}

vec3 flat_chart_colour(PagedChart chart) {
    return vec3(float(chart.u & 255u), float(chart.u >> 8 & 255u), float(chart.u >> 16 & 255u)) * (1.0 / 255.0);
}

uvec2 page_block(uvec2 layer, uint blocks, int across, int x, int y) {
    uint word = blocks + uint((y >> 2) * across + (x >> 2)) * 2u;
    return uvec2(layer_word(layer, word), layer_word(layer, word + 1u));
}

vec3 page_texel(uvec2 layer, uint blocks, int across, int x, int y) {
    ivec3 texel = bc1_texel(page_block(layer, blocks, across, x, y), uint((y & 3) << 2 | (x & 3)));
    return vec3(float(texel.x), float(texel.y), float(texel.z));
}

// Bilinear at a place in texels of level 0 of the page.
vec3 sample_page_level(Pages pages, uint page, uint mip, vec2 at) {
    uint entry = uint(PAGES_HEADER_WORDS) + uint(PAGES_PAGE_WORDS) * page;
    uint size = layer_word(pages.layer, entry + uint(PAGES_PAGE_SIZE));
    uint blocks = layer_word(pages.layer, entry + uint(PAGES_PAGE_BLOCKS) + mip);
    int width = int((size & 0xffffu) >> mip);
    int height = int((size >> 16) >> mip);
    float scale = 1.0 / float(1u << mip);
    float x = at.x * scale - 0.5;
    float y = at.y * scale - 0.5;
    float left = floor(x);
    float low = floor(y);
    // Inside the page whatever the coordinates are.
    int x0 = int(clamp(left, 0.0, float(width - 1)));
    int y0 = int(clamp(low, 0.0, float(height - 1)));
    int x1 = x0 + 1 < width ? x0 + 1 : x0;
    int y1 = y0 + 1 < height ? y0 + 1 : y0;
    int across = width >> 2;
    vec3 below = mix(page_texel(pages.layer, blocks, across, x0, y0), page_texel(pages.layer, blocks, across, x1, y0), x - left);
    vec3 above = mix(page_texel(pages.layer, blocks, across, x0, y1), page_texel(pages.layer, blocks, across, x1, y1), x - left);
    return mix(below, above, y - low) * (1.0 / 255.0);
}

// place in repeats; dx, dy: its change from pixel to pixel; finest: the finest level that is resident.
vec3 sample_paged(Pages pages, uint page, vec4 frame, vec2 place, vec2 dx, vec2 dy, float finest) {
    float level = wrap_level(frame, dx, dy, finest, float(pages.mips));
    vec2 at = wrap_texel(frame, place, level);
    uint mip = uint(level);
    float fraction = level - float(mip);
    vec3 colour = sample_page_level(pages, page, mip, at);
    // Below one step of an 8-bit channel the second level cannot be seen.
    if (fraction > 1.0 / 256.0) colour = mix(colour, sample_page_level(pages, page, mip + 1u, at), fraction);
    return colour;
}

#endif
