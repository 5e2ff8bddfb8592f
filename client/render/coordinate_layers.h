// The coordinates that the transports of chart_transport.h need beside the layers themselves: made from the words in
// GPU memory when a tile whose atlas is in pages is first drawn, kept until its mesh or its atlas goes. Memory of their
// own, in slots: at most `budget_bytes`, beside the budget of the layers.
#pragma once

#include <map>
#include <utility>

#include "client/render/chart_coordinates.h"
#include "client/render/frame.h"
#include "client/render/slot_pool.h"

namespace citystream::client {

/// One thread, and as a SlotPool nothing may be in flight. With kTable it makes and takes nothing.
class CoordinateLayers {
  public:
    CoordinateLayers() = default;
    CoordinateLayers(const Device& device, ChartTransport wanted, uint64_t budget_bytes)
        : wanted_(wanted), pool_(create_slot_pool(device, budget_bytes)) {}
    CoordinateLayers(const CoordinateLayers&) = delete;
    CoordinateLayers& operator=(const CoordinateLayers&) = delete;
    CoordinateLayers(CoordinateLayers&&) = default;
    CoordinateLayers& operator=(CoordinateLayers&&) = default;
    /// Before the device goes.
    void destroy();

    struct Coordinates {
        ChartTransport transport = ChartTransport::kTable;  ///< that the tile takes; another than `wanted`: it had to
        LayerId layer = kNoLayer;                           ///< of pool()
        std::vector<ChartRun> runs;                         ///< kUniform
    };
    /// Of a tile whose atlas is in pages. Where memory does not hold them the tile takes kTable. Valid
    /// until the next call that is not const.
    const Coordinates& of(const TileDraw& tile, const SlotPool& layers);
    /// The layer goes, or its number is given to another.
    void forget(LayerId layer);

    ChartTransport wanted() const { return wanted_; }
    const SlotPool& pool() const { return pool_; }

  private:
    Coordinates make(const TileDraw& tile, const SlotPool& layers);

    ChartTransport wanted_ = ChartTransport::kTable;
    SlotPool pool_;
    std::map<std::pair<LayerId, LayerId>, Coordinates> made_;  ///< by mesh and atlas
};

}  // namespace citystream::client
