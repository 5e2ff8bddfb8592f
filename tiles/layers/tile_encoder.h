// One tile's objects to its layers: mesh, facade and atlas bytes, each step a zstd frame, and the tile's record for the
// directory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "codec/atlas/page_layer.h"
#include "tiles/layers/chart_wishes.h"
#include "tiles/layers/facade_numbers.h"
#include "tiles/layers/facade_painter.h"
#include "tiles/layers/mesh_form.h"
#include "tiles/quadtree/build_object.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::layers {

/// What is shared by all tiles of a build.
struct TileWorkshop {
    const city::CityCatalog& catalog;
    ImageCache& images;
    FacadePainter& facades;
    const FacadeNumbers& numbers;  ///< of the maps in the dictionary
    std::array<bool, tileset::kLayerCount> layers = {true, true, true, false};
    GridPoint city_origin;
    codec::atlas::AtlasOptions atlas = {};
    ChartShelf* charts = nullptr;  ///< the chart dictionary; nothing: every tile has charts of its own only
    MeshForm mesh = {};
};

struct TileSpec {
    tileset::TileAddress address;
    GridPoint corner;           ///< absolute minimum corner of its square
    int64_t side = 0;           ///< grid units
    double texel = 0.05;        ///< metres a texel of the finest mip
    double facade_texel = 0.1;  ///< least metres a texel of facades seen flat: finer than an inner tile's error is
                                ///< never fetched
    float geometric_error = 0;  ///< of the objects
    bool inner = false;         ///< what its pictures are blurred by counts as error: tiles below it are sharper
    double parent_error = std::numeric_limits<double>::infinity();  ///< metres: about what the tile above states
    double skirt_metres = 1;                              ///< how far the ground hangs down at the tile's border
    std::optional<codec::atlas::PageOptions> pages = {};  ///< nothing: the form of its atlas is charts
};

struct TileContent {
    std::vector<quadtree::BuildObject> objects;
    std::vector<ChartImage> ground_pictures;
};

struct EncodedTile {
    tileset::TileRecord record;
    std::array<std::vector<std::byte>, tileset::kLayerCount> bytes;
    uint64_t triangles = 0;       ///< of the mesh layer
    bool pages_or_alpha = false;  ///< as tileset::Manifest
    bool kept_in_charts = false;  ///< the atlas, although pages were asked for: they hold no alpha
};

/// What a tile would take from the chart dictionary: its layers need nothing of `workshop.charts`.
TileWishes wishes_of(const TileSpec& spec, const TileContent& content, const TileWorkshop& workshop);

/// Texels of the finest mips of the charts that encode_tile holds: what the dictionary does not have, ground pictures.
uint64_t own_texels_of(const TileSpec& spec, const TileContent& content, const TileWorkshop& workshop);

/// Encodes. Deterministic; may run on many threads with one workshop.
EncodedTile encode_tile(const TileSpec& spec, const TileContent& content, const TileWorkshop& workshop);

}  // namespace citystream::tiles::layers
