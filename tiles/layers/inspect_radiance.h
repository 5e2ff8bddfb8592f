// Looking into the radiance layers of a finished archive: how many receivers, and what they cost.
#pragma once

#include <nlohmann/json.hpp>

#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::layers {

/// {"receivers", "leaf_receivers" (of tiles without tiles below them), "bytes_a_receiver" (on the wire),
/// "percent_of_tile_bytes" (of all layers of all tiles), "transports": {name: tiles} (that there are), "tiles",
/// "levels": [{"level", "tiles", "receivers", "wire_bytes"}] (that have any), "prefixes": [{"steps", "wire_bytes",
/// "error" (greatest of a tile)}]}. Reads the first step of every radiance layer. Error: the directory or a layer is
/// damaged.
Result<nlohmann::json> radiance_json(const archive::ArchiveReader& reader, const tileset::Manifest& manifest);

}  // namespace citystream::tiles::layers
