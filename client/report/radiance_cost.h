// What the radiance layers of an archive cost, and of what.
#pragma once

#include <array>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "codec/result.h"
#include "tiles/tileset/directory.h"
#include "tiles/tileset/radiance_totals.h"

namespace citystream::client {

/// More of the tiles' bytes is worth an explanation, percent.
inline constexpr double kMostRadiancePercent = 15;

struct RadianceCost {
    uint64_t buildings = 0;
    std::array<uint64_t, tiles::tileset::kLayerCount> layer_bytes{};  ///< wire bytes of tiles' layers
    uint32_t lattice_metres = 0, texels_across = 0, local_across = 0;
    std::optional<tiles::tileset::RadianceTotals> totals;  ///< of archives on this machine

    uint64_t radiance_bytes() const { return layer_bytes[static_cast<size_t>(tiles::tileset::Layer::kRadiance)]; }
    uint64_t tile_bytes() const;
    /// Radiance of all tiles' bytes. 0 of nothing.
    double percent() const { return percent_with(radiance_bytes()); }
    /// The same if radiance took other bytes.
    double percent_with(uint64_t bytes) const;
};

/// Nothing for a city without the layer. `place`: as Fetcher::open takes it. Error: its directory, or a radiance layer,
/// cannot be read.
Result<std::optional<RadianceCost>> read_radiance_cost(const std::string& place);

/// {"percent_of_tile_bytes", "wire_bytes", "tile_bytes", "lattice_metres", "texels_across", "local_across"} and with
/// totals {"receivers", "leaf_receivers", "bytes_a_receiver"}.
nlohmann::ordered_json radiance_cost_json(const RadianceCost& cost);

}  // namespace citystream::client
