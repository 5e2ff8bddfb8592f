// A generated city with many textures, as two kinds of viewers take it: one that draws each building by its pictures,
// and tiles with their charts. Both show the same triangles in the same order, the same places (multiples of 1/512
// repeat) and the same pictures.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/select/camera.h"
#include "codec/atlas/atlas_layer.h"
#include "codec/mesh/mesh_layer.h"

namespace citystream::bench {

struct PlainVertex {
    float position[3];  ///< metres from the city's corner
    float normal[3];
    float texcoord[2];  ///< repeats
};
static_assert(sizeof(PlainVertex) == 32);

/// Triangles of one building that show one picture.
struct PictureRun {
    uint32_t picture = 0, first_index = 0, indices = 0;
};

struct CityTile {
    std::array<double, 3> origin{};  ///< metres from the city's corner
    codec::mesh::MeshTile mesh;      ///< charts count in `pictures`
    std::vector<uint32_t> pictures;  ///< its charts
};

struct TexturedCity {
    std::vector<PlainVertex> vertices;
    std::vector<uint32_t> indices;
    std::vector<PictureRun> runs;  ///< building by building
    std::vector<codec::atlas::ChartImage> pictures;
    std::vector<CityTile> tiles;
    std::array<double, 3> size{};  ///< metres
    uint32_t buildings = 0;

    uint64_t triangles() const { return indices.size() / 3; }
    /// From above one end, all of it in the picture.
    client::Camera overview(uint32_t width, uint32_t height) const;
};

struct TexturedCityOptions {
    uint32_t buildings = 3000, textures = 3000;
    uint64_t seed = 1;
    uint32_t longest_side = 60;  ///< of a picture, texels: longer ones are halved until they are not
    double tile_metres = 256;
};

/// Buildings of the generator; a flat colour is a picture of one texel. Deterministic.
TexturedCity make_textured_city(const TexturedCityOptions& options);

}  // namespace citystream::bench
