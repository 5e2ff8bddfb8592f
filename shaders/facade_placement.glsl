// A placement of the tile's facade layer, the map that it shows, and its place in space.
#ifndef CITYSTREAM_FACADE_PLACEMENT_GLSL
#define CITYSTREAM_FACADE_PLACEMENT_GLSL

#include "codec/facade/facade_layout.h"
#include "shaders/draw_constants.glsl"
#include "shaders/facade_ray.glsl"

struct FacadePlacement {
    bool visible;    // its map is there and it has a size
    bool is_opaque;  // its map has no open cells
    uint map_number;  // of the tile's maps
    uvec2 layer;   // of the map
    vec2 finest;   // texels: the map's finest runs
    uint palette;  // word in the facade layer
    ivec3 origin;  // grid units from the camera's cell: lower left corner seen from outside
    ivec2 along;   // to the lower right corner
    uint height;
};

// Facade space (facade_ray.glsl) in space.
struct WallFrame {
    vec3 corner;     // metres from the camera
    vec2 along;      // unit vectors
    vec2 outwards;
    vec2 size;       // texels
    vec3 per_metre;  // texels, texels, millimetres
};


FacadePlacement facade_placement(uint index) {
    uvec2 facade = layer_reference(constants.tile.facade);
    uint first = layer_word(facade, FACADE_LAYER_WORD_PLACEMENTS) + index * FACADE_PLACEMENT_WORDS;
    FacadePlacement placement;
    placement.origin = tile_origin() + ivec3(layer_word(facade, first + FACADE_PLACEMENT_ORIGIN_X),
                                             layer_word(facade, first + FACADE_PLACEMENT_ORIGIN_Y),
                                             layer_word(facade, first + FACADE_PLACEMENT_ORIGIN_Z));
    placement.along = ivec2(layer_word(facade, first + FACADE_PLACEMENT_ALONG_X), layer_word(facade, first + FACADE_PLACEMENT_ALONG_Y));
    placement.height = layer_word(facade, first + FACADE_PLACEMENT_HEIGHT);
    placement.palette = layer_word(facade, FACADE_LAYER_WORD_PALETTES) +
                        layer_word(facade, first + FACADE_PLACEMENT_PALETTE) * FACADE_PALETTE_WORDS;
    // The level of the map that the client chose.
    FacadeMapTable table = FacadeMapTable(layer_reference(constants.tile.facade_maps));
    placement.map_number = PlacementMaps(layer_reference(table.head.map_of_placement)).entry[index];
    FacadeMapEntry map = table.entry[placement.map_number];
    placement.layer = layer_reference(map.layer);
    placement.is_opaque = map.is_opaque != 0u;
    placement.finest = vec2(map.finest[0], map.finest[1]);
    placement.visible = placement.layer != uvec2(0u) && placement.along != ivec2(0) && placement.height != 0u;
    return placement;
}

// Precondition: visible.
WallFrame wall_frame(FacadePlacement placement, FacadeMap map) {
    vec2 along = vec2(placement.along) * kMetresPerGridUnit;
    float width = length(along);
    vec2 direction = along / width;
    vec2 size = vec2(map_width(map), map_height(map));
    return WallFrame(camera_relative_metres(placement.origin), direction, vec2(direction.y, -direction.x), size,
                     vec3(size.x / width, size.y / (float(placement.height) * kMetresPerGridUnit), 1000.0));
}

// How far from the camera the near plane reaches, metres.
float near_reach() {
    vec3 x = vec3_of(constants.frame.clip_x);
    vec3 y = vec3_of(constants.frame.clip_y);
    return constants.frame.near_plane * sqrt(1.0 + 1.0 / dot(x, x) + 1.0 / dot(y, y));
}

// From metres to facade space.
vec3 wall_direction(WallFrame wall, vec3 metres) {
    return vec3(dot(metres.xy, wall.along), metres.z, dot(metres.xy, wall.outwards)) * wall.per_metre;
}
vec3 wall_metres(WallFrame wall, vec3 place) {
    vec3 metres = place / wall.per_metre;
    return wall.corner + vec3(wall.along * metres.x + wall.outwards * metres.z, metres.y);
}

#endif
