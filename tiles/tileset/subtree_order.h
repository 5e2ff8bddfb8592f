// The order of tiles in a subtree: by level, then along the Morton curve (bit 2i of the code is bit i of x, bit 2i + 1
// that of y).
#pragma once

#include <cstddef>
#include <cstdint>

#include "tiles/tileset/directory.h"

namespace citystream::tiles::tileset {

/// Bits of the availability of tiles: (4^levels - 1) / 3. `levels` at most 8.
constexpr size_t subtree_tile_bits(uint32_t levels) {
    return ((size_t{1} << (2 * levels)) - 1) / 3;
}
/// Bits of the availability of child subtrees: 4^levels.
constexpr size_t child_subtree_bits(uint32_t levels) {
    return size_t{1} << (2 * levels);
}

constexpr uint32_t morton_code(uint32_t x, uint32_t y) {
    uint32_t code = 0;
    for (uint32_t bit = 0; bit < 16; ++bit) code |= ((x >> bit) & 1) << (2 * bit) | ((y >> bit) & 1) << (2 * bit + 1);
    return code;
}

/// Morton code of a tile among the tiles of its level below `root`.
constexpr uint32_t local_morton(TileAddress root, TileAddress tile) {
    const uint32_t depth = tile.level - root.level;
    return morton_code(tile.x - (root.x << depth), tile.y - (root.y << depth));
}

/// The tile `depth` levels below `root` with that Morton code.
constexpr TileAddress tile_at(TileAddress root, uint32_t depth, uint32_t morton) {
    TileAddress tile{root.level + depth, root.x << depth, root.y << depth};
    for (uint32_t bit = 0; bit < depth; ++bit) {
        tile.x += ((morton >> (2 * bit)) & 1) << bit;
        tile.y += ((morton >> (2 * bit + 1)) & 1) << bit;
    }
    return tile;
}

/// Position in the availability bits of tiles.
constexpr size_t tile_bit(TileAddress root, TileAddress tile) {
    return subtree_tile_bits(tile.level - root.level) + local_morton(root, tile);
}

}  // namespace citystream::tiles::tileset
