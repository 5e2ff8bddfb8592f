// The entry facades/index: one zstd frame listing where each facade map's frame lies in facades/maps.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "codec/result.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::tileset {

/// The frame; sets manifest.facade_map_count and facade_index_*.
std::vector<std::byte> write_facade_index(std::span<const FacadeMapRecord> maps, Manifest& manifest);
Result<std::vector<FacadeMapRecord>> parse_facade_index(std::span<const std::byte> frame, const Manifest& manifest);

}  // namespace citystream::tiles::tileset
