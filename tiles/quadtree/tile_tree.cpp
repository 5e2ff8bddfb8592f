#include "tiles/quadtree/tile_tree.h"

#include <algorithm>
#include <cmath>

namespace citystream::tiles::quadtree {
namespace {

constexpr int kOriginGridBits = 7 + kGridBits;  // the origin is a multiple of 128 m
constexpr uint32_t kGreatestRootLog2 = 20;

class Splitter {
  public:
    Splitter(const ObjectSpool& spool, const TreeOptions& options, TileTree& tree)
        : spool_(spool), options_(options), tree_(tree) {
        weight_before_.reserve(spool.index().size() + 1);
        weight_before_.push_back(0);
        for (const SpooledObject& object : spool.index())
            weight_before_.push_back(weight_before_.back() + object.weight);
    }

    int32_t split(tileset::TileAddress address, size_t begin, size_t end) {
        const auto at = static_cast<int32_t>(tree_.nodes.size());
        TileNode node;
        node.address = address;
        node.begin = begin;
        node.end = end;
        node.weight = weight_before_[end] - weight_before_[begin];
        const int64_t side = tree_.side(address.level);
        const bool wide = begin != end && static_cast<uint64_t>(side >> kGridBits) > options_.widest_leaf_metres;
        node.leaf = (node.weight <= options_.leaf_triangles && !wide) || side <= (int64_t{1} << kCellGridBits);
        tree_.nodes.push_back(node);
        if (!node.leaf) split_children(at);
        return at;
    }

  private:
    void split_children(int32_t at) {
        const TileNode node = tree_.nodes[static_cast<size_t>(at)];
        size_t begin = node.begin;
        for (uint32_t i = 0; i < 4; ++i) {
            const tileset::TileAddress child = node.address.child(i);
            const size_t end = end_of(child, begin, node.end);
            if (begin != end || (options_.cover_extent && touches_extent(child))) {
                const int32_t index = split(child, begin, end);
                tree_.nodes[static_cast<size_t>(at)].children[i] = index;
            }
            begin = end;
        }
    }

    /// First object at or after `begin` that lies behind the tile in Morton order.
    size_t end_of(tileset::TileAddress tile, size_t begin, size_t end) const {
        const uint32_t shift = tree_.root_side_log2 - tile.level - kCellLog2Metres;
        const uint64_t limit = (morton(tile.x, tile.y) + 1) << (2 * shift);
        const auto& index = spool_.index();
        const auto found = std::partition_point(index.begin() + static_cast<ptrdiff_t>(begin),
                                                index.begin() + static_cast<ptrdiff_t>(end),
                                                [&](const SpooledObject& object) { return cell_key(object) < limit; });
        return static_cast<size_t>(found - index.begin());
    }

    uint64_t cell_key(const SpooledObject& object) const {
        return morton(static_cast<uint32_t>(object.cell_x - (tree_.origin.x >> kCellGridBits)),
                      static_cast<uint32_t>(object.cell_y - (tree_.origin.y >> kCellGridBits)));
    }

    bool touches_extent(tileset::TileAddress tile) const {
        const GridPoint corner = tree_.corner(tile);
        return corner.x < spool_.extent().hi.x && corner.y < spool_.extent().hi.y;
    }

    const ObjectSpool& spool_;
    const TreeOptions& options_;
    TileTree& tree_;
    std::vector<uint64_t> weight_before_;
};

}  // namespace

GridPoint TileTree::corner(tileset::TileAddress address) const {
    return {origin.x + static_cast<int64_t>(address.x) * side(address.level),
            origin.y + static_cast<int64_t>(address.y) * side(address.level), 0};
}

uint32_t TileTree::levels() const {
    uint32_t levels = 1;
    for (const TileNode& node : nodes) levels = std::max(levels, node.address.level + 1);
    return levels;
}

Result<TileTree> make_tile_tree(ObjectSpool& spool, const TreeOptions& options) {
    TileTree tree;
    const GridBox& extent = spool.extent();
    if (extent.empty()) return Error{"the city is empty: there is nothing to build"};
    tree.origin = {(extent.lo.x >> kOriginGridBits) << kOriginGridBits,
                   (extent.lo.y >> kOriginGridBits) << kOriginGridBits, 0};
    const int64_t reach = std::max(extent.hi.x - tree.origin.x, extent.hi.y - tree.origin.y);
    while (tree.side(0) < reach) {
        if (++tree.root_side_log2 > kGreatestRootLog2) {
            return Error{
                "the city is " + std::to_string(std::llround(to_metres(reach) / 1000)) +
                " km wide, more than the 1048 km that a quadtree can hold; look for stray coordinates or build parts"};
        }
    }
    spool.sort(tree.origin, tree.side(0) >> kCellGridBits);
    Splitter(spool, options, tree).split({0, 0, 0}, 0, spool.index().size());
    return tree;
}

}  // namespace citystream::tiles::quadtree
