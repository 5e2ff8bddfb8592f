// What a client learns about a city beyond its directory: steps that cannot be had, which facades a tile has, and which
// shared charts it shows.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "client/cache/directory_cache.h"
#include "client/select/chart_dictionary.h"
#include "client/select/facade_dictionary.h"
#include "codec/facade/facade_layer.h"
#include "codec/radiance/visibility_wire.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

/// Where a tile shows a chart of its own or of the dictionary.
struct ChartBox {
    uint32_t chart_in_tile = 0;
    tiles::tileset::Bounds bounds;  ///< of the triangles that show it; as those of the tile
};

/// Learnt of one tile.
struct TileKnowledge {
    static constexpr uint8_t kAllSteps = 255;
    /// Steps of each layer that can be had: less than the directory lists when a step is damaged or missing.
    std::array<uint8_t, tiles::tileset::kLayerCount> usable_steps = {kAllSteps, kAllSteps, kAllSteps, kAllSteps};
    bool facade_maps_known = false;
    std::vector<codec::facade::Placement> placements;  ///< where its facades stand
    std::vector<uint32_t> facade_maps;                 ///< that they show: sorted, distinct
    bool charts_known = false;                         ///< the first step of its atlas has been here; only of a city
                                                       ///< that names_charts()
    std::vector<codec::atlas::SharedChartUse> charts;  ///< shared ones that its atlas names
    /// The first step of its mesh has been here. Never of tiles with facades, which show charts beside their triangles.
    bool chart_boxes_known = false;
    /// Of each prefix of its light, what it takes in the store; 0: it has not been decoded yet.
    std::array<uint32_t, codec::radiance::kVisibilitySteps> light_bytes{};
    std::vector<ChartBox> chart_boxes;   ///< of every chart that a triangle shows, ascending
    std::vector<uint32_t> alpha_charts;  ///< of its own, those with alpha: ascending
};

struct CityKnowledge {
    std::vector<TileKnowledge> tiles;  ///< like the directory's nodes; grows with them
    uint64_t light_sizes_learnt = 0;   ///< store_bytes of light that came to be known
    FacadeDictionary dictionary;       ///< empty until the facade index has come
    bool facades_broken = false;       ///< the facade index cannot be had: facades are drawn flat
    ChartDictionary charts;            ///< empty until the chart index has come
    bool charts_broken = false;        ///< the chart index cannot be had: shared charts are drawn in one colour
};

/// Whether tiles may show shared charts, or charts with alpha.
inline bool names_charts(const tiles::tileset::Manifest& manifest) {
    return manifest.shared_chart_count > 0 || manifest.pages_or_alpha;
}

/// Whether what shows a chart of the tile can be seen through, as far as is known.
bool shows_alpha(const CityKnowledge& knowledge, const TileKnowledge& tile, uint32_t chart);
/// Of any of its charts.
bool shows_alpha(const CityKnowledge& knowledge, const TileKnowledge& tile);

/// Steps of a layer that can be had.
inline uint32_t usable_steps(const DirectoryNode& node, const TileKnowledge& known, tiles::tileset::Layer layer) {
    const auto listed = static_cast<uint32_t>(node.record->steps(layer).size());
    const uint32_t usable = known.usable_steps[static_cast<size_t>(layer)];
    return usable < listed ? usable : listed;
}

/// What the first steps of a layer take in the store: by the directory, which of light says the most that any form of
/// its matrix takes, or less once that is known.
uint64_t store_bytes(const DirectoryNode& node, const TileKnowledge& known, tiles::tileset::Layer layer,
                     uint32_t steps);

/// Whether a tile can be drawn in place of its parent: the first steps of its mesh and atlas can be had, and a mesh cut
/// short by damage is still no worse than the parent would be.
bool can_be_drawn(const DirectoryCache& directory, const CityKnowledge& knowledge, NodeIndex node);

/// Whether a tile's relief can be drawn: placements and some level of every map they name.
bool has_usable_relief(const DirectoryCache& directory, const CityKnowledge& knowledge, NodeIndex node);

}  // namespace citystream::client
