// The entry facades/index: one zstd frame listing the maps of the city's facade dictionary and where each level of each
// lies in facades/maps.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "codec/result.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::tileset {

inline constexpr uint32_t kMaxFacadeMaps = uint32_t{1} << 24;
/// Of one level, expanded: more than the largest map that any form holds.
inline constexpr uint32_t kMaxFacadeResidentBytes = uint32_t{1} << 29;

/// What a reader refuses in the records, or that all is well: sizes out of range, depths the wrong way round, no levels
/// or more than kMostFacadeLevels, ends that do not rise or pass 4 GiB - 1, resident bytes that are zero, no multiple
/// of 4 or above the limit, texels that do not become finer down to 1 cm, errors that are no whole millimetres, grow or
/// are not 0 at last.
Status check_facade_maps(std::span<const FacadeMapRecord> maps);

/// The frame; sets manifest.facade_map_count and facade_index_*. Records that check_facade_maps refuses give a frame
/// that no reader takes. About 9 bytes a level and 3 a map.
std::vector<std::byte> write_facade_index(std::span<const FacadeMapRecord> maps, Manifest& manifest);

/// For untrusted bytes: checks size, checksum and every record; allocates about 130 bytes for each map that the
/// decompressed bytes hold.
Result<std::vector<FacadeMapRecord>> parse_facade_index(std::span<const std::byte> frame, const Manifest& manifest);

}  // namespace citystream::tiles::tileset
