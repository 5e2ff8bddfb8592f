// Answers to requests: each is checked against what was asked for, counted, and given to what it is for.
#pragma once

#include <cstddef>
#include <span>

#include "client/stream/fetcher.h"
#include "client/stream/requests_under_way.h"
#include "client/stream/setbacks.h"
#include "client/stream/tile_residency.h"
#include "client/stream/view_choice.h"

namespace citystream::client {

/// One thread.
class Arrivals {
  public:
    /// All must outlive it.
    Arrivals(RequestsUnderWay& requests, DirectoryCache& directory, CityKnowledge& knowledge, LayerCache& cache,
             HostMemory& host, MapResidency& maps, ChartResidency& charts, TileResidency& tiles, ViewChoice& view,
             Setbacks& setbacks)
        : requests_(requests),
          directory_(directory),
          knowledge_(knowledge),
          cache_(cache),
          host_(host),
          maps_(maps),
          charts_(charts),
          tiles_(tiles),
          view_(view),
          setbacks_(setbacks) {}

    /// Adds its bytes to the frame's.
    void take(const FetchResult& result, StreamerFrame& frame);
    /// A piece of the directory, and room for what is kept of its tiles.
    Status add_subtree(std::span<const std::byte> bytes, tiles::tileset::TileAddress root);

  private:
    void take_subtree(const PlannedRequest& request, std::span<const std::byte> bytes);
    void take_facade_index(const PlannedRequest& request, std::span<const std::byte> bytes);
    void take_chart_index(const PlannedRequest& request, std::span<const std::byte> bytes);
    void take_layers(const PlannedRequest& request, std::span<const std::byte> bytes);

    RequestsUnderWay& requests_;
    DirectoryCache& directory_;
    CityKnowledge& knowledge_;
    LayerCache& cache_;
    HostMemory& host_;
    MapResidency& maps_;
    ChartResidency& charts_;
    TileResidency& tiles_;
    ViewChoice& view_;
    Setbacks& setbacks_;
};

}  // namespace citystream::client
