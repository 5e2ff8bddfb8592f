// The chart that a surface of the tile shows: of the tile's own atlas, or of the city's dictionary.
#ifndef CITYSTREAM_TILE_CHART_GLSL
#define CITYSTREAM_TILE_CHART_GLSL

#include "codec/chart_word_layout.h"
#include "shaders/atlas_sample.glsl"
#include "shaders/draw_constants.glsl"

layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer SharedChartTable { SharedChartEntry entry[]; };

// By its chart word. Of one colour where the tile has no atlas.
AtlasChart tile_chart(uint chart_word) {
    if ((chart_word & CHART_WORD_COLOUR) != 0u) return flat_chart(chart_word & CHART_WORD_COLOUR_MASK);
    if (!has_atlas()) return flat_chart(CHART_WORD_UNTEXTURED & CHART_WORD_COLOUR_MASK);
    uint index = chart_word;
    AtlasChart chart = atlas_chart(layer_reference(constants.tile.atlas), index, constants.tile.atlas_finest_mip);
    if ((chart.flags & ATLAS_CHART_SHARED) == 0u) return chart;
    SharedChartEntry entry = SharedChartTable(layer_reference(constants.tile.shared_charts)).entry[index];
    uvec2 layer = layer_reference(entry.layer);
    if (layer == uvec2(0u)) return flat_chart(entry.colour);
    return atlas_chart(layer, 0u, entry.finest_mip);
}

#endif
