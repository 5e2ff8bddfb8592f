// .subtree files: availability bits and the property table with step tables of subtree_levels levels of tiles (3D
// Tiles 1.1 binary form).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "codec/result.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::tileset {

struct Subtree {
    TileAddress root;
    std::vector<TileRecord> tiles;            ///< available tiles, by level, then Morton order
    std::vector<TileAddress> child_subtrees;  ///< roots of available subtrees below, Morton order
    friend bool operator==(const Subtree&, const Subtree&) = default;
};

std::vector<std::byte> write_subtree(const Subtree& subtree, const Manifest& manifest);
/// `root`: the address the file was asked for. Everything is bounded by the bytes; the step tables are checked
/// (ends grow, errors do not grow, decoded bytes are multiples of 4 and at most 1 GiB a layer, at most 16 steps a
/// layer).
Result<Subtree> parse_subtree(std::span<const std::byte> bytes, TileAddress root, const Manifest& manifest);

}  // namespace citystream::tiles::tileset
