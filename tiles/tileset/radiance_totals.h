// What the radiance layers of a finished archive come to: receivers, and bytes by step and by level of the quadtree.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "codec/radiance/radiance_transport.h"
#include "tiles/archive/archive.h"
#include "tiles/tileset/directory.h"

namespace citystream::tiles::tileset {

struct RadianceTotals {
    struct Level {
        uint64_t tiles = 0;  ///< that have the layer
        uint64_t receivers = 0;
        uint64_t wire_bytes = 0;
    };
    /// Of all tiles drawn with so many steps, or with all that they have.
    struct Prefix {
        uint64_t wire_bytes = 0;
        float error = 0;  ///< greatest of a tile, relative radiance
    };

    uint64_t tiles = 0, receivers = 0, wire_bytes = 0;
    /// Tiles by how their layer travels.
    std::array<uint64_t, codec::radiance::kRadianceTransportNames.size()> transport_tiles{};
    uint64_t leaf_receivers = 0;   ///< of tiles without tiles below them
    std::vector<Level> levels;     ///< by level, all of the tree's
    std::vector<Prefix> prefixes;  ///< prefix i is i + 1 steps; as many as the layer with the most steps has

    /// Wire bytes; 0 without receivers.
    double bytes_a_receiver() const {
        return receivers == 0 ? 0 : static_cast<double>(wire_bytes) / static_cast<double>(receivers);
    }
};

/// Wire bytes of all layers of all tiles; dictionaries and the directory are beside them.
uint64_t tile_bytes(const Manifest& manifest);

/// What part of tile_bytes radiance layers are.
double radiance_percent(const RadianceTotals& totals, const Manifest& manifest);

/// Reads the directory and the first step of every radiance layer; a city without has none. Error: a damaged directory
/// or layer, named.
Result<RadianceTotals> radiance_totals(const archive::ArchiveReader& reader, const Manifest& manifest);

}  // namespace citystream::tiles::tileset
