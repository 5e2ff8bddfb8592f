// The cities that benches measure: built in a temporary folder from the generator or from files, opened for reading.
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "codec/result.h"
#include "tests/temporary_folder.h"
#include "tiles/archive/archive.h"
#include "tiles/tileset/chart_index.h"
#include "tiles/tileset/directory.h"
#include "tiles/tileset/subtree.h"

namespace citystream::bench {

using tests::TemporaryFolder;

/// A subtree and its bytes in the archive.
struct SubtreeBytes {
    std::span<const std::byte> bytes;
    tiles::tileset::Subtree parsed;
};

/// An opened archive with its whole directory.
struct SampleCity {
    std::string path;
    std::shared_ptr<tiles::archive::ArchiveReader> archive;
    tiles::tileset::Manifest manifest;
    std::vector<SubtreeBytes> subtrees;  ///< parents before children
    std::vector<tiles::tileset::FacadeMapRecord> maps;
    std::vector<tiles::tileset::ChartRecord> charts;  ///< that tiles share

    /// Tiles without tiles below them, in the order of the directory.
    std::vector<const tiles::tileset::TileRecord*> leaves() const;
    std::span<const std::byte> layer_bytes(const tiles::tileset::TileRecord& tile, tiles::tileset::Layer layer) const;
};

using LayerSet = std::array<bool, tiles::tileset::kLayerCount>;
inline constexpr LayerSet kAllLayers = {true, true, true, false};

Status build_generated(uint32_t buildings, uint64_t seed, const LayerSet& layers, const std::string& archive);
/// One city of all files that read_city takes.
Status build_from_files(const std::vector<std::string>& files, const LayerSet& layers, const std::string& archive);
Result<SampleCity> open_city(const std::string& archive);

/// The FILE if it is an archive (.3tz), else the city built from it in `folder`.
Result<SampleCity> city_of_file(const std::string& file, const LayerSet& layers, const TemporaryFolder& folder);

}  // namespace citystream::bench
