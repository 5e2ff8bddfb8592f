// What one client has drawn so far: the wire bytes that were worth receiving, and which tiles have just become visible.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <unordered_map>
#include <vector>

#include "client/cache/host_layer_store.h"
#include "client/load/city_index.h"
#include "client/render/frame.h"

namespace citystream::client {

/// One thread. Both references outlive it.
class DrawnPrefixes {
  public:
    DrawnPrefixes(const CityIndex& index, const HostLayerStore& store) : index_(index), store_(store) {}

    /// Takes in the draws of one update. `on_tile` hears of each tile that could be named: `appeared` tells whether it
    /// is drawn for the first time since it was brought to the store.
    void note(const std::vector<TileDraw>& draws,
              const std::function<void(tiles::tileset::TileAddress, bool appeared)>& on_tile);

    /// Sum over all layers and shared charts of the longest prefix ever drawn, and of all levels of facade maps ever
    /// drawn.
    uint64_t bytes() const { return bytes_; }

  private:
    struct Shown {
        const tiles::tileset::TileRecord* record = nullptr;
        size_t mesh_steps = 0;
        uint64_t atlas_bytes = 0;
        LayerId facade = kNoLayer;
        uint64_t light_bytes = 0;
        std::vector<LayerId> maps;        ///< as bound last
        std::vector<ChartPrefix> charts;  ///< in the order of the draw's
    };
    void credit(const tiles::tileset::TileRecord& record, tiles::tileset::Layer layer, uint64_t decoded_bytes);
    void credit_charts(const TileDraw& draw, Shown& shown);
    void credit_draw(const TileDraw& draw, Shown& shown);
    uint64_t light_bytes(const TileDraw& draw) const {
        return draw.radiance == kNoLayer ? 0 : store_.bytes_of(draw.radiance);
    }
    bool has_grown(const TileDraw& draw, const Shown& shown) const;

    const CityIndex& index_;
    const HostLayerStore& store_;
    std::unordered_map<LayerId, Shown> shown_;  ///< by mesh
    std::map<tiles::tileset::TileAddress, std::array<uint64_t, tiles::tileset::kLayerCount>> credited_;
    std::set<MapPiece> pieces_;
    std::unordered_map<uint32_t, uint64_t> chart_bytes_;  ///< by number: of the longest prefix drawn
    uint64_t bytes_ = 0;
};

}  // namespace citystream::client
