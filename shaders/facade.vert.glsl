#version 460
// Facade pass: one box a placement, around all its relief can reach. Finds the placement's map by its dictionary index.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference : require
#extension GL_EXT_buffer_reference_uvec2 : require

#include "shaders/draw_constants.glsl"
#include "shaders/facade_cast.glsl"
#include "shaders/facade_margin.glsl"

layout(location = 0) out vec3 place;                 // facade space
layout(location = 1) flat out vec3 camera;           // facade space
layout(location = 2) flat out uvec2 map_layer;
layout(location = 3) flat out uvec4 map_words;       // cells, size, labels, offsets
layout(location = 4) flat out uvec2 data_words;      // cell data of the map; palette of the facade layer
layout(location = 5) flat out vec2 depths;
layout(location = 6) flat out vec2 along_direction;

uvec2 find_map(uint map) {
    FacadeMapTable table = FacadeMapTable(layer_reference(constants.tile.facade_maps));
    uint low = 0u;
    uint high = constants.tile.facade_map_count;
    while (low < high) {
        uint middle = (low + high) >> 1;
        if (table.entry[middle].map < map) low = middle + 1u;
        else high = middle;
    }
    if (low == constants.tile.facade_map_count || table.entry[low].map != map) return uvec2(0u);
    return layer_reference(table.entry[low].layer);
}

void hide() {
    gl_Position = vec4(0.0, 0.0, -1.0, 1.0);
    place = camera = vec3(0.0);
    map_layer = data_words = uvec2(0u);
    map_words = uvec4(0u);
    depths = along_direction = vec2(0.0);
}

void main() {
    uvec2 facade = layer_reference(constants.tile.facade);
    uint at = layer_word(facade, FACADE_LAYER_WORD_PLACEMENTS) + uint(gl_InstanceIndex) * FACADE_PLACEMENT_WORDS;
    ivec2 along = ivec2(layer_word(facade, at + FACADE_PLACEMENT_ALONG_X), layer_word(facade, at + FACADE_PLACEMENT_ALONG_Y));
    float height = float(layer_word(facade, at + FACADE_PLACEMENT_HEIGHT)) * kMetresPerGridUnit;
    uvec2 layer = find_map(layer_word(facade, at + FACADE_PLACEMENT_MAP));
    if (layer == uvec2(0u) || along == ivec2(0) || height == 0.0) {
        hide();
        return;
    }
    FacadeMap map = facade_map(layer);
    map_layer = layer;
    map_words = uvec4(map.cells, map.size, map.labels, map.offsets);
    data_words = uvec2(map.cell_data, layer_word(facade, FACADE_LAYER_WORD_PALETTES) +
                                          layer_word(facade, at + FACADE_PLACEMENT_PALETTE) * FACADE_PALETTE_WORDS);
    depths = map.depths;

    vec2 along_metres = vec2(along) * kMetresPerGridUnit;
    float width = length(along_metres);
    along_direction = along_metres / width;
    vec2 outwards = vec2(along_direction.y, -along_direction.x);
    vec2 size = vec2(map.size & 0xffffu, map.size >> 16);
    ivec3 origin = tile_origin() +
                   ivec3(layer_word(facade, at + FACADE_PLACEMENT_ORIGIN_X), layer_word(facade, at + FACADE_PLACEMENT_ORIGIN_Y),
                         layer_word(facade, at + FACADE_PLACEMENT_ORIGIN_Z));
    vec3 corner = camera_relative_metres(origin);
    camera = vec3(-dot(corner.xy, along_direction) / width * size.x, -corner.z / height * size.y, -dot(corner.xy, outwards) * 1000.0);

    vec3 low = vec3(vec2(-kEdgeMargin), map.depths.x - kDepthMargin);
    vec3 high = vec3(size + kEdgeMargin, map.depths.y + kDepthMargin);
    place = vec3((gl_VertexIndex & 1) != 0 ? high.x : low.x, (gl_VertexIndex & 2) != 0 ? high.y : low.y,
                 (gl_VertexIndex & 4) != 0 ? high.z : low.z);
    vec3 metres = corner + vec3(along_metres * (place.x / size.x) + outwards * (place.z * 0.001), height * (place.y / size.y));
    gl_Position = project(metres);
}
