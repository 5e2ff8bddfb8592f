// The adaptive quadtree over the sorted spool: which tiles exist and which run of objects each leaf holds.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "tiles/quadtree/object_spool.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::quadtree {

struct TileNode {
    tileset::TileAddress address;
    size_t begin = 0, end = 0;                           ///< objects of the sorted index below this tile
    std::array<int32_t, 4> children = {-1, -1, -1, -1};  ///< indices of nodes
    bool leaf = true;
    uint64_t weight = 0;  ///< triangles below it
};

struct TreeOptions {
    uint64_t leaf_triangles = 8192;                   ///< a tile with more is split, down to 64 m
    bool cover_extent = false;                        ///< make tiles without objects too, so that the ground is whole
    uint64_t widest_leaf_metres = uint64_t{1} << 32;  ///< a wider tile with objects is split, down to 64 m
};

struct TileTree {
    GridPoint origin;             ///< minimum corner of the root square, multiple of 128 m
    uint32_t root_side_log2 = 7;  ///< metres
    std::vector<TileNode> nodes;  ///< depth first, children in Morton order; nodes[0] is the root

    GridPoint corner(tileset::TileAddress address) const;  ///< minimum corner, absolute; z = 0
    int64_t side(uint32_t level) const { return int64_t{1} << (root_side_log2 + kGridBits - level); }  ///< grid units
    uint32_t levels() const;
};

/// Origin and root from the extent, then sorts the spool and splits. Fails when the extent is beyond 2^20 m.
Result<TileTree> make_tile_tree(ObjectSpool& spool, const TreeOptions& options);

}  // namespace citystream::tiles::quadtree
