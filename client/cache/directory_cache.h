// The part of the directory that has been fetched, as a tree that the selection walks.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "client/cache/directory_pool.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

using NodeIndex = uint32_t;
inline constexpr NodeIndex kNoNode = ~NodeIndex{0};

/// A tile of the directory. Children whose records lie in a subtree not fetched yet are bits of `unloaded_children`;
/// bits of `broken_children` name subtrees that could not be had: such a tile is never refined.
struct DirectoryNode {
    const tiles::tileset::TileRecord* record = nullptr;
    NodeIndex parent = kNoNode;
    std::array<NodeIndex, 4> children = {kNoNode, kNoNode, kNoNode, kNoNode};
    uint8_t unloaded_children = 0;
    uint8_t broken_children = 0;

    bool is_leaf() const {
        return unloaded_children == 0 && broken_children == 0 && children[0] == kNoNode && children[1] == kNoNode &&
               children[2] == kNoNode && children[3] == kNoNode;
    }
};

/// Grows, never shrinks. Node 0 is the root once the root subtree has been added; indices stay valid.
class DirectoryCache {
  public:
    DirectoryCache(tiles::tileset::Manifest manifest, std::shared_ptr<DirectoryPool> pool);

    /// Parses and links a subtree. Error: bytes are no subtree, it has no root tile, or its parent is unknown.
    Status add_subtree(std::span<const std::byte> bytes, tiles::tileset::TileAddress root);
    /// Gives a child subtree up: its parent tile is not refined from now on, until mend().
    void mark_broken(tiles::tileset::TileAddress root);
    /// Makes a broken subtree one that has not been fetched yet.
    void mend(tiles::tileset::TileAddress root);

    DirectoryPool& pool() { return *pool_; }
    const tiles::tileset::Manifest& manifest() const { return manifest_; }
    const std::vector<DirectoryNode>& nodes() const { return nodes_; }
    const DirectoryNode& node(NodeIndex index) const { return nodes_[index]; }
    /// The manifest's origin in metres: what bounds are relative to.
    std::array<double, 2> origin() const { return origin_; }
    uint64_t host_bytes() const { return host_bytes_; }

  private:
    struct Place {
        NodeIndex parent = kNoNode;
        uint8_t bit = 0;
    };
    Place place_of(tiles::tileset::TileAddress subtree_root) const;

    tiles::tileset::Manifest manifest_;
    std::shared_ptr<DirectoryPool> pool_;
    std::array<double, 2> origin_{};
    std::vector<std::shared_ptr<const tiles::tileset::Subtree>> subtrees_;
    std::vector<DirectoryNode> nodes_;
    std::map<tiles::tileset::TileAddress, NodeIndex> awaited_;  ///< roots of unloaded subtrees -> parent node
    uint64_t host_bytes_ = 0;
};

}  // namespace citystream::client
