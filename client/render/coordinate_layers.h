// The coordinates that the transports of chart_transport.h need beside the layers themselves: made from the words in
// GPU memory when a tile whose atlas is in pages is first drawn, kept until its mesh or its atlas goes or the layers
// need their room. They lie in slots of the pool that holds the layers, so its budget holds for both; what the
// streamer wants comes first, as a tile without coordinates is drawn by its chart table all the same.
#pragma once

#include <map>
#include <utility>

#include "client/render/chart_coordinates.h"
#include "client/render/frame.h"
#include "client/render/slot_pool.h"

namespace citystream::client {

/// One thread, and as a SlotPool nothing may be in flight. Every call is given the same pool. With kTable it makes and
/// takes nothing.
class CoordinateLayers {
  public:
    CoordinateLayers() = default;
    explicit CoordinateLayers(ChartTransport wanted) : wanted_(wanted) {}

    struct Coordinates {
        ChartTransport transport = ChartTransport::kTable;  ///< that the tile takes; another than `wanted`: it had to
        LayerId layer = kNoLayer;                           ///< of the pool
        std::vector<ChartRun> runs;                         ///< kUniform
        uint64_t refused_slots = 0;                         ///< kTable because so many were not free
    };
    /// Of a tile whose atlas is in pages. Where free slots do not hold them the tile takes kTable until they do. Valid
    /// until the next call that is not const.
    const Coordinates& of(const TileDraw& tile, SlotPool& pool);
    /// The layer goes, or its number is given to another.
    void forget(LayerId layer, SlotPool& pool);
    /// Gives slots back until `slots` are free, or none are left here.
    void make_room(uint64_t slots, SlotPool& pool);

    ChartTransport wanted() const { return wanted_; }
    uint64_t slots_used() const { return slots_used_; }

  private:
    Coordinates make(const TileDraw& tile, SlotPool& pool);
    void give_back(const Coordinates& coordinates, SlotPool& pool);

    ChartTransport wanted_ = ChartTransport::kTable;
    uint64_t slots_used_ = 0;
    std::map<std::pair<LayerId, LayerId>, Coordinates> made_;  ///< by mesh and atlas
};

}  // namespace citystream::client
