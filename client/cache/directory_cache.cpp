#include "client/cache/directory_cache.h"

namespace citystream::client {

using tiles::tileset::Subtree;
using tiles::tileset::TileAddress;
using tiles::tileset::TileRecord;

namespace {

uint32_t child_number(TileAddress address) {
    return (address.x & 1) | (address.y & 1) << 1;
}

}  // namespace

DirectoryCache::DirectoryCache(tiles::tileset::Manifest manifest, std::shared_ptr<DirectoryPool> pool)
    : manifest_(std::move(manifest)),
      pool_(pool ? std::move(pool) : std::make_shared<DirectoryPool>()),
      origin_{to_metres(manifest_.origin.x), to_metres(manifest_.origin.y)} {}

DirectoryCache::Place DirectoryCache::place_of(TileAddress subtree_root) const {
    const auto found = awaited_.find(subtree_root);
    if (found == awaited_.end()) return {};
    return {found->second, static_cast<uint8_t>(1u << child_number(subtree_root))};
}

void DirectoryCache::mark_broken(TileAddress root) {
    const Place place = place_of(root);
    if (place.parent == kNoNode) return;
    nodes_[place.parent].unloaded_children &= static_cast<uint8_t>(~place.bit);
    nodes_[place.parent].broken_children |= place.bit;
}

void DirectoryCache::mend(TileAddress root) {
    const Place place = place_of(root);
    if (place.parent == kNoNode) return;
    nodes_[place.parent].broken_children &= static_cast<uint8_t>(~place.bit);
    nodes_[place.parent].unloaded_children |= place.bit;
}

Status DirectoryCache::add_subtree(std::span<const std::byte> bytes, TileAddress root) {
    const Place place = place_of(root);
    const bool is_first = nodes_.empty() && root == TileAddress{};
    if (place.parent == kNoNode && !is_first) return Error{"a subtree that no tile asked for"};
    auto parsed = pool_->subtree(bytes, root, manifest_);
    if (!parsed) return parsed.error();
    const std::shared_ptr<const Subtree> subtree = *parsed;
    if (subtree->tiles.empty() || subtree->tiles.front().address != root) {
        return Error{"the subtree does not hold its own root tile"};
    }
    // Tiles come by level, so a parent has its index before its children ask for it; a tile without one cannot be
    // reached.
    std::map<TileAddress, NodeIndex> index_of;
    for (const TileRecord& tile : subtree->tiles) {
        NodeIndex parent = place.parent;
        if (tile.address != root) {
            const auto found = index_of.find(tile.address.parent());
            if (found == index_of.end()) continue;
            parent = found->second;
        }
        const auto index = static_cast<NodeIndex>(nodes_.size());
        nodes_.push_back({&tile, parent, {kNoNode, kNoNode, kNoNode, kNoNode}, 0, 0});
        if (parent != kNoNode) nodes_[parent].children[child_number(tile.address)] = index;
        index_of.emplace(tile.address, index);
    }
    for (const TileAddress& child : subtree->child_subtrees) {
        const auto found = index_of.find(child.parent());
        if (found == index_of.end()) continue;
        nodes_[found->second].unloaded_children |= static_cast<uint8_t>(1u << child_number(child));
        awaited_.emplace(child, found->second);
    }
    if (place.parent != kNoNode) {
        nodes_[place.parent].unloaded_children &= static_cast<uint8_t>(~place.bit);
        awaited_.erase(root);
    }
    host_bytes_ += host_bytes_of(*subtree) + subtree->tiles.size() * sizeof(DirectoryNode);
    subtrees_.push_back(subtree);
    return Done{};
}

}  // namespace citystream::client
