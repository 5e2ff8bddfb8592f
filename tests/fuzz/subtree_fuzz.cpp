// Parses arbitrary bytes as a subtree; whatever is accepted must survive being written and parsed again. The first byte
// chooses root and levels.
#include <cstdint>
#include <cstdlib>

#include "tiles/tileset/subtree.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::tiles::tileset;
    if (size == 0) return 0;
    Manifest manifest;
    manifest.root_side_log2 = 10;
    manifest.subtree_levels = 1 + (data[0] & 7);
    manifest.levels = 1 + (data[0] >> 3 & 15);
    manifest.has_layer = {true, true, true, (data[0] & 0x80) != 0};
    const TileAddress root{(data[0] & 0x80) != 0 ? manifest.subtree_levels : 0, 0, 0};
    const auto subtree = parse_subtree({reinterpret_cast<const std::byte*>(data) + 1, size - 1}, root, manifest);
    if (!subtree) return 0;
    // Bounds may come back rounded to the grid, everything else must not change.
    const auto again = parse_subtree(write_subtree(*subtree, manifest), root, manifest);
    if (!again || again->tiles.size() != subtree->tiles.size() || again->child_subtrees != subtree->child_subtrees)
        std::abort();
    for (size_t i = 0; i < again->tiles.size(); ++i) {
        if (again->tiles[i].layers != subtree->tiles[i].layers) std::abort();
    }
    return 0;
}
