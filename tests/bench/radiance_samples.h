// What benches of the radiance layer measure: receivers and what they see, of meshes, cities and made-up scenes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "codec/radiance/receiver_table.h"
#include "codec/radiance/visibility_bits.h"
#include "codec/result.h"
#include "tests/bench/mesh_files.h"
#include "tiles/radiance/height_grid.h"
#include "tiles/radiance/surface_triangle.h"

namespace citystream::bench {

inline constexpr int64_t kTileMetres = 128;

/// What a tile is made of and what is around it.
struct TileSurroundings {
    GridPoint base;  ///< south-west corner and base height; places count from there
    std::vector<tiles::radiance::SurfaceTriangle> own, around;
    std::shared_ptr<const tiles::radiance::HeightGrid> heights;  ///< null: nothing is beyond
};

/// A tile's visibility, or a mesh's.
struct RadianceSample {
    codec::radiance::VisibilityTile visibility;
    std::vector<std::array<double, 3>> normals;  ///< of the receivers, as their rays took them
    double bake_seconds = 0;                     ///< receivers and rays, all cores
    /// Of a tile: its receivers as its layer has them (codec/radiance/radiance_layer.h). None of a mesh.
    uint32_t spacing_log2 = 0;
    std::vector<codec::radiance::ReceiverPlace> places = {};
    TileSurroundings surroundings = {};
};

struct RadianceSet {
    std::string name;
    std::vector<RadianceSample> samples;

    uint64_t receivers() const;
    double bake_seconds() const;
};

struct SampleOptions {
    double lattice_metres = 4;       ///< of cities: a power of two, 1/16..64
    uint32_t texels_across = 32;     ///< of the source
    uint32_t most_receivers = 4000;  ///< of a mesh
    uint32_t tiles = 4;              ///< of a city
};

/// Receivers at the mesh's vertices with the means of their triangles' normals, weighted by area, as the paper has them
/// (Sun et al. 2011, section 4.1). The mesh hides from itself; its longest side becomes 64 m, on the global grid. Of
/// more vertices than options.most_receivers as many, spread evenly along a curve through space (Morton order), which
/// is the receivers' order. Error: Embree's; no vertex with a normal.
Result<RadianceSample> bake_vertices(const SourceMesh& mesh, const SampleOptions& options);

/// Tiles of 128 m of a city, as the builder bakes them: triangles cut at the tiles' borders, those of the eight
/// neighbours and the city's heights in the way; a city without ground gets a flat one under all of it. Of the tiles
/// with at least the middle number of triangles, options.tiles, spread evenly from the south-west to the north-east.
/// Error: Embree's.
Result<std::vector<RadianceSample>> bake_city_tiles(const SourceMesh& city, const SampleOptions& options);

/// A tile of the box city (tests/tiles/radiance/box_city.h), its towers along the axes or each turned.
Result<RadianceSample> bake_box_city(bool turned, const SampleOptions& options,
                                     const std::array<int64_t, 2>& tile = {0, 0});

/// What is seen from points of a tile's surface with these unit normals, one receiver each. Error: Embree's.
Result<RadianceSample> bake_places(std::span<const GridPoint> points, std::span<const std::array<double, 3>> normals,
                                   const RadianceSample& tile);

/// Vertices of a sphere that see all that is above their planes, on a spiral from pole to pole.
RadianceSample open_sphere(uint32_t vertices, uint32_t texels_across);

/// A sphere with bumps, which hides from itself as the paper's bunny does: a cube's grid drawn on it, 6 n^2 + 2
/// vertices, the largest such number that is not above `vertices` (at least 8).
SourceMesh bumpy_sphere(uint32_t vertices);

}  // namespace citystream::bench
