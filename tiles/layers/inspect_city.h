// Looking into a finished archive: what it holds, and whether every byte of it is whole.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "codec/result.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::layers {

/// The fields of `info`: extent ([xmin,ymin,zmin,xmax,ymax,zmax] in the CRS), epsg, buildings, triangles, tiles,
/// levels, layers.NAME.wire_bytes and .decoded_bytes, ...
nlohmann::json manifest_json(const tileset::Manifest& manifest);

/// manifest_json of an archive, with its size, entries and, where it has them, the dictionaries, what its pages hold
/// and its receivers (inspect_facades.h, inspect_charts.h, inspect_pages.h, inspect_radiance.h).
Result<nlohmann::json> read_city_info(const std::string& path);

/// Checks structure and CRC of the archive, directory, every step's checksum and frame, every layer's decoded form, the
/// facade dictionary. One line for each damage, naming tile and layer; empty when all is well. Error: the file cannot
/// be opened or is no archive.
Result<std::vector<std::string>> verify_city(const std::string& path,
                                             const std::function<void(uint64_t done, uint64_t total)>& progress = {});

}  // namespace citystream::tiles::layers
