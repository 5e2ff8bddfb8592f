#include "tiles/layers/inspect_radiance.h"

#include "tiles/tileset/radiance_totals.h"

namespace citystream::tiles::layers {

Result<nlohmann::json> radiance_json(const archive::ArchiveReader& reader, const tileset::Manifest& manifest) {
    const auto totals = tileset::radiance_totals(reader, manifest);
    if (!totals) return totals.error();
    nlohmann::json levels = nlohmann::json::array(), prefixes = nlohmann::json::array();
    for (size_t i = 0; i < totals->levels.size(); ++i) {
        const auto& level = totals->levels[i];
        if (level.tiles == 0) continue;
        levels.push_back(
            {{"level", i}, {"tiles", level.tiles}, {"receivers", level.receivers}, {"wire_bytes", level.wire_bytes}});
    }
    for (size_t i = 0; i < totals->prefixes.size(); ++i) {
        const auto& prefix = totals->prefixes[i];
        prefixes.push_back({{"steps", i + 1}, {"wire_bytes", prefix.wire_bytes}, {"error", prefix.error}});
    }
    nlohmann::json transports = nlohmann::json::object();
    for (size_t i = 0; i < totals->transport_tiles.size(); ++i) {
        if (totals->transport_tiles[i] > 0)
            transports[std::string(codec::radiance::kRadianceTransportNames[i])] = totals->transport_tiles[i];
    }
    return nlohmann::json{{"receivers", totals->receivers},
                          {"transports", std::move(transports)},
                          {"leaf_receivers", totals->leaf_receivers},
                          {"bytes_a_receiver", totals->bytes_a_receiver()},
                          {"percent_of_tile_bytes", tileset::radiance_percent(*totals, manifest)},
                          {"tiles", totals->tiles},
                          {"levels", std::move(levels)},
                          {"prefixes", std::move(prefixes)}};
}

}  // namespace citystream::tiles::layers
