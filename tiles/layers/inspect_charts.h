// Looking into the chart dictionary of a finished archive.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::layers {

/// Whether the index is whole and the levels of every chart have their checksums and expand to a chart of the size and
/// flags that its record promises. Damages go to `say`: entry and what. Nothing to check where no chart is shared.
void check_chart_dictionary(const archive::ArchiveReader& reader, const tileset::Manifest& manifest,
                            const std::function<void(const std::string&, const std::string&)>& say);

/// {"charts", "index_bytes", "wire_bytes", "resident_bytes", "texels", "levels": [{"charts", "wire_bytes",
/// "resident_bytes"}, ...]}, levels coarse to fine. Error: the index is damaged.
Result<nlohmann::json> chart_dictionary_json(const archive::ArchiveReader& reader, const tileset::Manifest& manifest);

}  // namespace citystream::tiles::layers
