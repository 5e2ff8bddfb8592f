// Looking into the facade dictionary of a finished archive.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::layers {

/// Whether the index is whole, every payload has its checksum and expands to a map of the size, depths and material
/// slots that its record promises, and coarser levels are no further from the exact one than they say. Damages go to
/// `say`: entry and what.
void check_facade_dictionary(const archive::ArchiveReader& reader, const tileset::Manifest& manifest,
                             const std::function<void(const std::string&, const std::string&)>& say);

/// {"maps", "made_up", "index_bytes", "wire_bytes", "resident_bytes", "levels": {"16 cm": {"maps", "wire_bytes",
/// "resident_bytes", "greatest_error_metres"}, ...}, "forms": {"patch": {"levels", "wire_bytes", "resident_bytes"},
/// ...}}: forms are of the levels that can be expanded. Error: the index is damaged.
Result<nlohmann::json> facade_dictionary_json(const archive::ArchiveReader& reader, const tileset::Manifest& manifest);

}  // namespace citystream::tiles::layers
