// The last pass of a build: directory, facade and chart dictionary, tiles and preview to one archive in its fixed
// order.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "tiles/layers/chart_dictionary.h"
#include "tiles/layers/facade_dictionary.h"
#include "tiles/layers/tile_pipeline.h"

namespace citystream::tiles::layers {

struct ArchiveContents {
    tileset::Manifest& manifest;  ///< totals, layers and dictionary fields are filled in
    const quadtree::TileTree& tree;
    const std::vector<BuiltTile>& tiles;  ///< by node of the tree
    quadtree::SpoolFile& layer_spool;
    const EncodedFacades& facades;
    quadtree::SpoolFile& facade_spool;
    ChartDictionary& charts;
    quadtree::SpoolFile& chart_spool;
    std::span<const std::byte> preview;  ///< PNG; may be empty
    const BuildOptions& options;
};

/// Order: tileset.json, subtrees, facades/index, facades/maps, charts/index, charts/levels, tiles depth first with the
/// layers of one tile side by side, preview.
Status write_city_archive(const ArchiveContents& contents);

}  // namespace citystream::tiles::layers
