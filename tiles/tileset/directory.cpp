#include "tiles/tileset/directory.h"

#include <fmt/format.h>
#include <xxhash.h>

namespace citystream::tiles::tileset {

GridPoint Manifest::tile_origin(const TileRecord& record) const {
    const auto side = static_cast<int64_t>(side_metres(record.address.level) * kGridUnitsPerMetre);
    return {origin.x + static_cast<int64_t>(record.address.x) * side,
            origin.y + static_cast<int64_t>(record.address.y) * side, record.base_height};
}

std::string layer_path(Layer layer, TileAddress address) {
    return fmt::format("tiles/{}/{}/{}.{}", address.level, address.x, address.y,
                       kLayerNames[static_cast<size_t>(layer)]);
}

std::string subtree_path(TileAddress subtree_root) {
    return fmt::format("subtrees/{}/{}/{}.subtree", subtree_root.level, subtree_root.x, subtree_root.y);
}

uint64_t checksum_of(const void* bytes, size_t size) {
    return XXH3_64bits(bytes, size);
}

}  // namespace citystream::tiles::tileset
