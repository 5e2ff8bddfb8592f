// The pass of a build that bakes the radiance layer, after all tiles have their content: for each tile its own surface,
// that of the tiles beside it as far as rays go, and the city's heights beyond.
//
// A leaf stands among leaves, so that receivers which two leaves have in common see the same whatever their levels; an
// inner tile among the tiles of its level and the leaves above it, which are what is drawn beside it.
//
// Which tiles are beside a tile depends on the surfaces alone, and every tile is baked by itself: the bytes do not
// depend on threads or on memory.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tiles/layers/tile_pipeline.h"
#include "tiles/quadtree/build_object.h"
#include "tiles/quadtree/tile_tree.h"

namespace citystream::tiles::layers {

struct RadianceInput {
    const BuildOptions& options;
    const quadtree::TileTree& tree;
    int64_t lowest = 0;  ///< grid units: no leaf's surface is below it
    std::string folder;  ///< of temporary files
    quadtree::SpoolFile& layer_spool;
    uint64_t work_bytes = 0;  ///< that threads may hold while they bake
};

class RadianceStage {
  public:
    /// Error: the disk; this build has no Embree.
    static Result<std::unique_ptr<RadianceStage>> create(const RadianceInput& input);
    virtual ~RadianceStage() = default;

    /// What a tile holds: once for each node of the tree, from any thread. Error: the disk.
    virtual Status add(size_t node, std::span<const quadtree::BuildObject> objects) = 0;

    /// Gives the tiles their layer: tiles[i] belongs to tree.nodes[i] and has its base height. A tile with too many
    /// receivers gets a lattice twice as wide, or in the end none. Error: the disk, "interrupted".
    virtual Status run(std::span<BuiltTile> tiles) = 0;

    virtual const RadianceReport& report() const = 0;
    /// Tiles that were left out, and an earlier archive that could not be used.
    virtual std::vector<city::Defect> take_defects() = 0;
};

}  // namespace citystream::tiles::layers
