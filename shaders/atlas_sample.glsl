// Samples a chart of an atlas layer straight from its BC1 or BC3 blocks: wrapped or clamped inside the chart, bilinear, trilinear between its own mips.
// Twin of AtlasLayerView in codec/atlas/atlas_layer.h and of codec/atlas/bc1.h: same texels, integer by integer.
#ifndef CITYSTREAM_ATLAS_SAMPLE_GLSL
#define CITYSTREAM_ATLAS_SAMPLE_GLSL

#include "codec/atlas/atlas_layout.h"
#include "shaders/bc_blocks.glsl"
#include "shaders/bits.glsl"

// Of the pipeline: charts may have alpha.
layout(constant_id = ALPHA_TEST_CONSTANT) const bool kAlphaTest = false;

struct AtlasChart {
    uvec2 atlas;      // the layer that holds it; 0: there is none, `size` is the one colour to show (r | g << 8 | b << 16)
    float finest_mip;  // that may be shown
    uint index;       // in that layer
    uint size;        // width | height << 16, of mip 0
    uint flags;
    uint mip_table;  // word
};

AtlasChart atlas_chart(uvec2 atlas, uint index, float finest_mip) {
    uint entry = ATLAS_HEADER_WORDS + index * ATLAS_CHART_WORDS;
    return AtlasChart(atlas, finest_mip, index, layer_word(atlas, entry + ATLAS_CHART_SIZE),
                      layer_word(atlas, entry + ATLAS_CHART_FLAGS), layer_word(atlas, ATLAS_WORD_MIP_TABLE));
}

AtlasChart flat_chart(uint colour) { return AtlasChart(uvec2(0u), 0.0, 0u, colour, 0u, 0u); }

uint chart_mip_count(AtlasChart chart) { return chart.flags >> 8 & 0xffu; }

ivec2 chart_mip_size(AtlasChart chart, uint mip) {
    return ivec2(max(1u, (chart.size & 0xffffu) >> mip), max(1u, (chart.size >> 16) >> mip));
}

// Word of the chart's first block in a mip.
uint chart_blocks(AtlasChart chart, uint mip) {
    uint part = layer_word(chart.atlas, chart.mip_table + mip);
    return part + layer_word(chart.atlas, part + chart.index);
}

bool has_alpha(AtlasChart chart) { return (chart.flags & (ATLAS_CHART_ALPHA | ATLAS_CHART_SHARED)) == ATLAS_CHART_ALPHA; }

// How blocks of one kind, colours or alpha, lie in a mip.
struct BlockRows {
    uvec2 atlas;
    uint first;   // word of the first one
    uint stride;  // words from one to the next
    int across;
};

// Precondition: a pipeline without kAlphaTest has only charts without alpha.
BlockRows colour_rows(AtlasChart chart, uint mip, int across) {
    uint blocks = chart_blocks(chart, mip);
    if (kAlphaTest && has_alpha(chart)) return BlockRows(chart.atlas, blocks + 2u, 4u, across);
    return BlockRows(chart.atlas, blocks, 2u, across);
}

uvec2 load_block(BlockRows rows, ivec2 block) {
    uint word = rows.first + uint(block.y * rows.across + block.x) * rows.stride;
    return uvec2(layer_word(rows.atlas, word), layer_word(rows.atlas, word + 1u));
}

ivec3 block_texel(uvec2 block, ivec2 texel) { return bc1_texel(block, uint((texel.y & 3) << 2 | texel.x & 3)); }

// One texel and its alpha, in any pipeline (tests).
ivec4 chart_texel(AtlasChart chart, uint mip, ivec2 texel) {
    int across = (chart_mip_size(chart, mip).x + 3) >> 2;
    uint blocks = chart_blocks(chart, mip);
    if (!has_alpha(chart)) return ivec4(block_texel(load_block(BlockRows(chart.atlas, blocks, 2u, across), texel >> 2), texel), 255);
    uvec2 alpha = load_block(BlockRows(chart.atlas, blocks, 4u, across), texel >> 2);
    uvec2 colour = load_block(BlockRows(chart.atlas, blocks + 2u, 4u, across), texel >> 2);
    return bc3_texel(uvec4(alpha, colour), uint((texel.y & 3) << 2 | texel.x & 3));
}

// The two texel columns (or rows) that a coordinate lies between, wrapped or clamped, and the weight of the second.
ivec2 neighbours(float coordinate, int size, bool repeat, out float weight) {
    float x = (repeat ? coordinate - floor(coordinate) : clamp(coordinate, -1.0, 2.0)) * float(size) - 0.5;
    float low = floor(x);
    weight = x - low;
    ivec2 pair = ivec2(int(low), int(low) + 1);
    if (repeat) return ivec2(pair.x < 0 ? size - 1 : pair.x, pair.y >= size ? 0 : pair.y);
    return clamp(pair, 0, size - 1);
}

vec3 sample_mip(AtlasChart chart, uint mip, vec2 uv) {
    ivec2 size = chart_mip_size(chart, mip);
    BlockRows rows = colour_rows(chart, mip, (size.x + 3) >> 2);
    if (size.x * size.y == 1) return vec3(bc1_texel(load_block(rows, ivec2(0)), 0u)) * (1.0 / 255.0);
    vec2 weight;
    ivec2 xs = neighbours(uv.x, size.x, (chart.flags & ATLAS_CHART_REPEAT_U) != 0u, weight.x);
    ivec2 ys = neighbours(uv.y, size.y, (chart.flags & ATLAS_CHART_REPEAT_V) != 0u, weight.y);
    bool other_column = xs.x >> 2 != xs.y >> 2;
    bool other_row = ys.x >> 2 != ys.y >> 2;
    // Texels that share a block share its load.
    uvec2 b00 = load_block(rows, ivec2(xs.x, ys.x) >> 2);
    uvec2 b10 = b00;
    uvec2 b01 = b00;
    if (other_column) b10 = load_block(rows, ivec2(xs.y, ys.x) >> 2);
    if (other_row) b01 = load_block(rows, ivec2(xs.x, ys.y) >> 2);
    uvec2 b11 = other_row ? b01 : b10;
    if (other_column && other_row) b11 = load_block(rows, ivec2(xs.y, ys.y) >> 2);
    vec3 low = mix(vec3(block_texel(b00, ivec2(xs.x, ys.x))), vec3(block_texel(b10, ivec2(xs.y, ys.x))), weight.x);
    vec3 high = mix(vec3(block_texel(b01, ivec2(xs.x, ys.y))), vec3(block_texel(b11, ivec2(xs.y, ys.y))), weight.x);
    return mix(low, high, weight.y) * (1.0 / 255.0);
}

// OpenGL's isotropic level of detail, clamped to the mips that are resident.
float chart_lod(AtlasChart chart, vec2 dx, vec2 dy) {
    vec2 size = vec2(chart_mip_size(chart, 0u));
    vec2 across = dx * size;
    vec2 up = dy * size;
    float rho_squared = max(dot(across, across), dot(up, up));
    float last = float(chart_mip_count(chart)) - 1.0;
    return clamp(0.5 * log2(max(rho_squared, 1e-12)), min(chart.finest_mip, last), last);
}

// uv in repeats; dx, dy: its change from pixel to pixel.
vec3 sample_chart(AtlasChart chart, vec2 uv, vec2 dx, vec2 dy) {
    if (chart.atlas == uvec2(0u)) return unpackUnorm4x8(chart.size).rgb;
    float lod = chart_lod(chart, dx, dy);
    uint mip = uint(lod);
    float fraction = lod - float(mip);
    vec3 colour = sample_mip(chart, mip, uv);
    // Below one step of an 8-bit channel the second mip cannot be seen.
    if (fraction > 1.0 / 256.0) colour = mix(colour, sample_mip(chart, mip + 1u, uv), fraction);
    return colour;
}

float alpha_texel(BlockRows rows, int x, int y) {
    return float(bc4_texel(load_block(rows, ivec2(x, y) >> 2), uint((y & 3) << 2 | x & 3)));
}

float sample_alpha_mip(AtlasChart chart, uint mip, vec2 uv) {
    ivec2 size = chart_mip_size(chart, mip);
    BlockRows rows = BlockRows(chart.atlas, chart_blocks(chart, mip), 4u, (size.x + 3) >> 2);
    vec2 weight;
    ivec2 xs = neighbours(uv.x, size.x, (chart.flags & ATLAS_CHART_REPEAT_U) != 0u, weight.x);
    ivec2 ys = neighbours(uv.y, size.y, (chart.flags & ATLAS_CHART_REPEAT_V) != 0u, weight.y);
    float low = mix(alpha_texel(rows, xs.x, ys.x), alpha_texel(rows, xs.y, ys.x), weight.x);
    float high = mix(alpha_texel(rows, xs.x, ys.y), alpha_texel(rows, xs.y, ys.y), weight.x);
    return mix(low, high, weight.y) * (1.0 / 255.0);
}

// Alpha at the same place, 0..1. Precondition: has_alpha(chart).
float sample_alpha(AtlasChart chart, vec2 uv, vec2 dx, vec2 dy) {
    float lod = chart_lod(chart, dx, dy);
    uint mip = uint(lod);
    float fraction = lod - float(mip);
    float alpha = sample_alpha_mip(chart, mip, uv);
    if (fraction > 1.0 / 256.0) alpha = mix(alpha, sample_alpha_mip(chart, mip + 1u, uv), fraction);
    return alpha;
}

#endif
