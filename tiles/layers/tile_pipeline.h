// Passes 2 to 4 of a build, on many threads: what inner tiles hold is coarsened, deepest level first; what several
// tiles show goes to the chart dictionary; every tile is encoded, its layers going to a spool file.
#pragma once

#include <vector>

#include "tiles/layers/build_city.h"
#include "tiles/layers/chart_dictionary.h"
#include "tiles/layers/preview.h"
#include "tiles/layers/tile_encoder.h"
#include "tiles/quadtree/tile_tree.h"

namespace citystream::tiles::layers {

struct BuiltTile {
    tileset::TileRecord record;
    std::array<quadtree::SpoolRange, tileset::kLayerCount> layers;  ///< in the layer spool
    quadtree::SpoolRange content;                                   ///< of inner tiles, in the content spool
    uint64_t triangles = 0;
    uint64_t hidden_facades = 0;  ///< of a leaf: made plain walls because neighbours hide them
    bool pages_or_alpha = false;  ///< as tileset::Manifest
    bool kept_in_charts = false;  ///< as EncodedTile
};

class RadianceStage;

struct PipelineInput {
    const BuildOptions& options;
    const quadtree::TileTree& tree;
    quadtree::ObjectSpool& objects;
    quadtree::SpoolFile& layer_spool;
    quadtree::SpoolFile& content_spool;
    const TileWorkshop& workshop;  ///< without charts
    ChartDictionary& charts;       ///< is made; stays empty where options.shared_charts is not set
    quadtree::SpoolFile& chart_spool;
    Preview& preview;
    StageClock& clock;
    uint64_t work_bytes = 0;  ///< that threads may hold while they make tiles and charts
    bool made_up_ground = false;
    RadianceStage* radiance = nullptr;  ///< null: no radiance layer
};

/// Builds all tiles; result[i] belongs to tree.nodes[i]. Bounds and errors hold for everything below a tile.
Result<std::vector<BuiltTile>> build_tiles(const PipelineInput& input);

/// Error of the level above leaves and further up: metres.
double level_error(double side_metres);

}  // namespace citystream::tiles::layers
