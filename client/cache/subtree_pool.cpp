#include "client/cache/subtree_pool.h"

namespace citystream::client {

Result<SubtreePool::Shared> SubtreePool::parse(std::span<const std::byte> bytes, tiles::tileset::TileAddress root,
                                               const tiles::tileset::Manifest& manifest) {
    const auto key = std::make_pair(root, tiles::tileset::checksum_of(bytes.data(), bytes.size()));
    {
        const std::lock_guard lock(mutex_);
        const auto found = known_.find(key);
        if (found != known_.end()) {
            if (Shared shared = found->second.lock()) return shared;
        }
    }
    auto parsed = tiles::tileset::parse_subtree(bytes, root, manifest);
    if (!parsed) return parsed.error();
    auto shared = std::make_shared<const tiles::tileset::Subtree>(std::move(*parsed));
    const std::lock_guard lock(mutex_);
    known_[key] = shared;
    return Shared(shared);
}

uint64_t host_bytes_of(const tiles::tileset::Subtree& subtree) {
    uint64_t bytes = sizeof(subtree) + subtree.tiles.size() * sizeof(tiles::tileset::TileRecord) +
                     subtree.child_subtrees.size() * sizeof(tiles::tileset::TileAddress);
    for (const auto& tile : subtree.tiles) {
        for (const auto& steps : tile.layers) bytes += steps.size() * sizeof(tiles::tileset::StepRecord);
    }
    return bytes;
}

}  // namespace citystream::client
