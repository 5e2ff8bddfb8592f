#include "client/cache/directory_pool.h"

#include "tiles/tileset/chart_index.h"
#include "tiles/tileset/facade_index.h"

namespace citystream::client {
namespace {

/// What `known` holds under `key`, else what `parse` makes, which it holds from now on. Parsing happens outside the
/// lock.
template <typename Key, typename Value, typename Parse>
Result<std::shared_ptr<const Value>> shared(std::mutex& mutex, std::map<Key, std::weak_ptr<const Value>>& known,
                                            const Key& key, const Parse& parse) {
    {
        const std::lock_guard lock(mutex);
        const auto found = known.find(key);
        if (found != known.end()) {
            if (std::shared_ptr<const Value> value = found->second.lock()) return value;
        }
    }
    auto parsed = parse();
    if (!parsed) return parsed.error();
    auto value = std::make_shared<const Value>(std::move(*parsed));
    const std::lock_guard lock(mutex);
    known[key] = value;
    return value;
}

}  // namespace

Result<DirectoryPool::SharedSubtree> DirectoryPool::subtree(std::span<const std::byte> bytes,
                                                            tiles::tileset::TileAddress root,
                                                            const tiles::tileset::Manifest& manifest) {
    const auto key = std::make_pair(root, tiles::tileset::checksum_of(bytes.data(), bytes.size()));
    return shared(mutex_, subtrees_, key, [&] { return tiles::tileset::parse_subtree(bytes, root, manifest); });
}

Result<DirectoryPool::SharedMaps> DirectoryPool::facade_maps(std::span<const std::byte> index,
                                                             const tiles::tileset::Manifest& manifest) {
    const uint64_t key = tiles::tileset::checksum_of(index.data(), index.size());
    return shared(mutex_, maps_, key, [&] { return tiles::tileset::parse_facade_index(index, manifest); });
}

Result<DirectoryPool::SharedCharts> DirectoryPool::shared_charts(std::span<const std::byte> index,
                                                                 const tiles::tileset::Manifest& manifest) {
    const uint64_t key = tiles::tileset::checksum_of(index.data(), index.size());
    return shared(mutex_, charts_, key, [&] { return tiles::tileset::parse_chart_index(index, manifest); });
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
