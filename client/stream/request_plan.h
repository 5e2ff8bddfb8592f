// Which requests a selection still needs, in the order of what they bring to the screen for each byte.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/cache/layer_cache.h"
#include "client/select/selection.h"

namespace citystream::client {

enum class RequestKind : uint8_t { kSubtree, kFacadeIndex, kLayer, kMaps };

/// One range request: the bytes between the resident and the wanted prefix of a layer, neighbouring levels of facade
/// maps, or a piece of the directory.
struct PlannedRequest {
    RequestKind kind = RequestKind::kLayer;
    tiles::tileset::TileAddress subtree;
    NodeIndex node = kNoNode;
    tiles::tileset::Layer layer = tiles::tileset::Layer::kMesh;
    uint32_t from = 0, to = 0;  ///< steps [from, to), or pieces of the dictionary (MapPiece)
    uint64_t offset = 0, length = 0;
    double priority = 0;
};

/// What may be asked for now.
struct PlanOptions {
    /// Ask for what the choice itself depends on first (subtrees, then placements), and for nothing else until it is
    /// here: no byte is fetched for a choice that changes. Else ask for all at once.
    bool directory_first = true;
    /// Of a layer that is not here at all ask for the first step alone: a coarse picture soon, the rest once it is
    /// here.
    bool coarse_first = false;
    bool facade_index_requested = false;
    /// Levels of maps that few bytes part are one range; what lies between comes along.
    bool bridge_gaps = true;
};

/// Bytes between two wanted levels of maps that cost less than the heads of one more request and its answer.
inline constexpr uint64_t kBridgedGap = 256;

/// Priority of directory pieces: before any layer but the first tile's.
inline constexpr double kDirectoryPriority = 1e250;

/// Requests for what `tiles` lack and that is not under way, best first; equal gains in the order of the key. `cache`
/// entries say what is here. `first_tile`: this tile comes before all others (the root, which every view can fall back
/// to); kNoNode for none.
std::vector<PlannedRequest> plan_requests(const DirectoryCache& directory, const CityKnowledge& knowledge,
                                          LayerCache& cache, const Selection& selection,
                                          const std::vector<SelectedTile>& tiles, NodeIndex first_tile,
                                          const Camera& camera, const PlanOptions& options);

/// Pixels that a tile's bounds cover at most.
double screen_area(const tiles::tileset::Bounds& bounds, double pixels_per_metre, const Camera& camera);

}  // namespace citystream::client
