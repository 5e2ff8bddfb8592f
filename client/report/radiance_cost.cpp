#include "client/report/radiance_cost.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>

#include "client/stream/fetcher.h"
#include "tiles/archive/archive.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::client {

using tiles::tileset::Manifest;

namespace {

constexpr uint64_t kManifestLimit = 4U << 20;

Result<Manifest> read_manifest(const std::string& place) {
    auto fetcher = Fetcher::open(place, FetcherOptions{});
    if (!fetcher) return fetcher.error();
    const auto bytes = fetch_now(**fetcher, tiles::tileset::kTilesetPath, kManifestLimit);
    if (!bytes) return bytes.error();
    return tiles::tileset::parse_tileset_json(*bytes);
}

}  // namespace

uint64_t RadianceCost::tile_bytes() const {
    return std::accumulate(layer_bytes.begin(), layer_bytes.end(), uint64_t{0});
}

double RadianceCost::percent_with(uint64_t bytes) const {
    const uint64_t all = tile_bytes() - radiance_bytes() + bytes;
    return all == 0 ? 0 : 100 * static_cast<double>(bytes) / static_cast<double>(all);
}

Result<std::optional<RadianceCost>> read_radiance_cost(const std::string& place) {
    const auto manifest = read_manifest(place);
    if (!manifest) return manifest.error();
    if (!manifest->has_layer[static_cast<size_t>(tiles::tileset::Layer::kRadiance)])
        return std::optional<RadianceCost>();
    RadianceCost cost;
    cost.buildings = manifest->buildings;
    cost.layer_bytes = manifest->wire_bytes;
    cost.lattice_metres = manifest->radiance_lattice_metres;
    cost.texels_across = manifest->radiance_texels_across;
    cost.local_across = manifest->radiance_local_across;
    std::error_code ignored;
    if (std::filesystem::is_regular_file(place, ignored)) {
        const auto reader = tiles::archive::ArchiveReader::open(place);
        if (!reader) return reader.error();
        auto totals = tiles::tileset::radiance_totals(**reader, *manifest);
        if (!totals) return totals.error();
        cost.totals = std::move(totals).value();
    }
    return std::optional(std::move(cost));
}

nlohmann::ordered_json radiance_cost_json(const RadianceCost& cost) {
    nlohmann::ordered_json out = {{"percent_of_tile_bytes", cost.percent()}, {"wire_bytes", cost.radiance_bytes()},
                                  {"tile_bytes", cost.tile_bytes()},         {"lattice_metres", cost.lattice_metres},
                                  {"texels_across", cost.texels_across},     {"local_across", cost.local_across}};
    if (cost.totals) {
        out["receivers"] = cost.totals->receivers;
        out["leaf_receivers"] = cost.totals->leaf_receivers;
        out["bytes_a_receiver"] = cost.totals->bytes_a_receiver();
    }
    return out;
}

}  // namespace citystream::client
