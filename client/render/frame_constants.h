// What the CPU tells the GPU about one frame: the camera's and each tile's push constants, and the page tables and
// facade tables that they refer to, which lie in one mapped buffer.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "client/render/draw_layout.h"
#include "client/render/facade_map_facts.h"
#include "client/render/frame.h"
#include "client/render/light_layout.h"
#include "client/render/relief_draw_layout.h"
#include "client/render/slot_pool.h"
#include "client/select/camera.h"
#include "codec/atlas/facade_tint.h"

namespace citystream::client {

FrameConstants make_frame_constants(const Camera& camera, const CameraCell& cell,
                                    const codec::atlas::FacadeTint& tint = {});

/// What lights the relief of a tile's facades (relief_draw_layout.h).
struct TileRelief {
    struct Map {
        LayerId mask = kNoLayer;
        VkDeviceAddress btf = 0;
    };
    LayerId local = kNoLayer;  ///< words of local light; kNoLayer: the tile has none
    uint32_t receivers = 0;    ///< that have such words
    std::vector<Map> maps;     ///< of the tile's
};

/// Makes the constants of tiles and, as words to be copied to device address `base`, the tables they refer to.
class FrameTables {
  public:
    /// `facts`: by layer. `head`: begins every tile's facade table.
    FrameTables(const SlotPool& pool, VkDeviceAddress base, std::span<const FacadeMapFacts> facts,
                const FacadeTableHead& head)
        : pool_(pool), base_(base), facts_(facts), head_(head) {}

    /// Fails when a layer that the tile names does not live, a placement shows none of its maps, a shared chart is none
    /// of the tile's, or when the tile is too far away for 32-bit grid units (1,000 km).
    Result<TileConstants> add_tile(const TileDraw& tile, const CameraCell& camera);
    /// Names a coordinate layer in the constants of the tile added last.
    Status add_coordinates(LayerId layer, TileConstants& constants) { return refer(layer, constants.shared_charts); }
    /// In a frame with a light, whose LightConstants are at `light`: what lights `tile`, the one added last, also as a
    /// table that its constants refer to. `relief`: with that of its facades.
    Result<RadianceDraw> add_radiance(const TileDraw& tile, VkDeviceAddress light, const TileRelief& relief,
                                      TileConstants& constants);
    /// Whether every layer that the tile added last names lies in one piece.
    bool is_direct() const { return is_direct_; }
    std::span<const uint32_t> words() const { return words_; }

    /// Upper bound of the words that `tiles` take. `lit`: with what lights them.
    static uint64_t bound(const SlotPool& pool, std::span<const TileDraw> tiles, bool lit);

  private:
    VkDeviceAddress append(const void* table, size_t bytes);
    Status refer(LayerId layer, uint out[2]);
    Status add_shared_charts(const TileDraw& tile, TileConstants& constants);
    Status add_facades(const TileDraw& tile, TileConstants& constants);

    const SlotPool& pool_;
    VkDeviceAddress base_;
    std::span<const FacadeMapFacts> facts_;
    FacadeTableHead head_;
    std::vector<uint32_t> words_;
    bool is_direct_ = true;
    std::map<LayerId, VkDeviceAddress> references_;
};

}  // namespace citystream::client
