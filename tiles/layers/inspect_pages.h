// Looking into the atlases of a finished archive that are in pages: how many pages, how much of them shows charts, and
// what borders take.
#pragma once

#include <nlohmann/json.hpp>

#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::layers {

/// {"tiles", "tiles_of_charts" (whose atlas is in the other form), "mips": {"M": tiles, ...}, "pages", "texels" (of
/// level 0 of all pages), "charts", "flat_charts", "chart_texels" (inside borders), "border_texels", "fill_percent"
/// (charts and borders, of all texels), "border_percent"}. Reads the first step of every atlas. Error: the directory or
/// an atlas is damaged.
Result<nlohmann::json> page_json(const archive::ArchiveReader& reader, const tileset::Manifest& manifest);

}  // namespace citystream::tiles::layers
