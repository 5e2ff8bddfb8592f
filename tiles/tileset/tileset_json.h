// tileset.json: the manifest as a 3D Tiles 1.1 tileset with an implicit quadtree, a metadata schema for the step
// tables, and the tileset extension CITYSTREAM_layers that announces the native layers.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "codec/result.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::tileset {

std::string write_tileset_json(const Manifest& manifest);
/// Checks versions, ranges (levels <= 24, subtree_levels 1..8, finite bounds) and says what is wrong.
Result<Manifest> parse_tileset_json(std::span<const std::byte> bytes);

}  // namespace citystream::tiles::tileset
