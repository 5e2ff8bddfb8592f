// Which requests a selection still needs, in the order of what they bring to the screen for each byte.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/cache/layer_cache.h"
#include "client/select/selection.h"

namespace citystream::client {

enum class RequestKind : uint8_t { kSubtree, kFacadeIndex, kChartIndex, kLayer, kMaps, kCharts };

/// One range request: the bytes between the resident and the wanted prefix of a layer, neighbouring levels of facade
/// maps or of shared charts, or a piece of the directory.
struct PlannedRequest {
    RequestKind kind = RequestKind::kLayer;
    tiles::tileset::TileAddress subtree;
    NodeIndex node = kNoNode;
    tiles::tileset::Layer layer = tiles::tileset::Layer::kMesh;
    uint32_t from = 0, to = 0;  ///< steps [from, to), or pieces of a dictionary (MapPiece, ChartPiece)
    uint64_t offset = 0, length = 0;
    double priority = 0;
};

/// What may be asked for now.
struct PlanOptions {
    /// Ask for what the choice itself depends on first (subtrees, then placements, atlases that may name shared charts
    /// and the indices), and for nothing else until it is here: no byte is fetched for a choice that changes. Else ask
    /// for all at once.
    bool directory_first = true;
    /// A coarse picture soon: of tiles that are not here at all first their *openings*, the fewest steps that make a
    /// picture of them (shared charts with their first level); then the facade index and the rest. And while nothing
    /// covers the view, nothing but the directory and then openings, for all connections share one link.
    bool coarse_first = false;
    bool facade_index_requested = false;
    bool chart_index_requested = false;
    /// Host memory has room beside what the view needs: levels of maps or of charts that few bytes part are one range,
    /// whose bytes between come along, and the stand-in may go before the view.
    bool host_room = true;
    /// Ask for light, too, of tiles that have begun to show, and first of the stand-in's. With coarse_first its gain is
    /// weighed with that of other layers: a tile's first step of light, and when that is in the store what follows it.
    /// Else it comes below all other priorities.
    bool light = false;
};

/// Bytes between two wanted levels of a dictionary that cost less than the heads of one more request and its answer.
inline constexpr uint64_t kBridgedGap = 256;

/// Priority of directory pieces: before any layer.
inline constexpr double kDirectoryPriority = 1e250;

/// A mesh whose error covers no more than this share of the picture's height is worth showing.
inline constexpr double kRecognisableShare = 1.0 / 8;

/// How many times fewer bytes the stand-in's opening must have than those of the view to go before them.
inline constexpr uint64_t kStandInWorth = 3;

/// Requests for what `tiles` lack and that is not under way, best first; equal gains in the order of the key. `cache`
/// entries say what is here. `stand_in`: the tile among them that every view can fall back to (the root), which is not
/// of the view unless it is alone; kNoNode for none.
std::vector<PlannedRequest> plan_requests(const DirectoryCache& directory, const CityKnowledge& knowledge,
                                          LayerCache& cache, const Selection& selection,
                                          const std::vector<SelectedTile>& tiles, NodeIndex stand_in,
                                          const Camera& camera, const PlanOptions& options);

/// The same for the light of all tiles, and nothing else. Best first is what takes away the greatest part of the
/// light's error, over the most pixels, for a byte.
std::vector<PlannedRequest> plan_light(const DirectoryCache& directory, const CityKnowledge& knowledge,
                                       LayerCache& cache, const std::vector<SelectedTile>& tiles, const Camera& camera);

/// The same for the meshes of tiles that only cast shadows: below light.
std::vector<PlannedRequest> plan_casters(const DirectoryCache& directory, const CityKnowledge& knowledge,
                                         LayerCache& cache, const std::vector<SelectedTile>& casters,
                                         const std::vector<tiles::tileset::TileAddress>& subtrees,
                                         const Camera& camera);

inline bool is_light(const PlannedRequest& request) {
    return request.kind == RequestKind::kLayer && request.layer == tiles::tileset::Layer::kRadiance;
}

/// Pixels that a tile's bounds cover at most.
double screen_area(const tiles::tileset::Bounds& bounds, double pixels_per_metre, const Camera& camera);

}  // namespace citystream::client
