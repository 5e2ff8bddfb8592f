// The radiance layers of the archive that a build is to replace, by what they depend on: a tile that would come out the
// same is copied, which takes milliseconds instead of seconds.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "codec/radiance/radiance_transport.h"
#include "codec/result.h"
#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::layers {

class EarlierRadiance {
  public:
    struct Layer {
        std::span<const std::byte> bytes;  ///< valid as long as this object is
        std::vector<tileset::StepRecord> steps;
        codec::radiance::RadianceTransport transport = codec::radiance::RadianceTransport::kVisibility;
    };

    /// Reads the directory and the beginning of each radiance layer. Null: there is no file at `path`, or its city has
    /// no such layer. Error: the file is no archive of a city, or its directory is damaged.
    static Result<std::unique_ptr<EarlierRadiance>> open(const std::string& path);

    /// A layer whose first step says this hash (codec::radiance::read_bake_hash), of whichever tile, every byte of it
    /// checked. Nothing: there is none, or it is damaged. From any thread.
    std::optional<Layer> find(uint64_t bake_hash) const;

    /// Layers that were found damaged so far, or say no hash.
    uint64_t damaged() const { return damaged_; }

  private:
    struct Place {
        std::string entry;
        std::vector<tileset::StepRecord> steps;
        codec::radiance::RadianceTransport transport = codec::radiance::RadianceTransport::kVisibility;
    };
    Status read_directory();
    void note(const tileset::TileRecord& tile);

    std::shared_ptr<archive::ArchiveReader> reader_;
    std::map<uint64_t, Place> places_;
    mutable std::atomic<uint64_t> damaged_ = 0;
};

}  // namespace citystream::tiles::layers
