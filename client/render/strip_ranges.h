// What frames draw from strip code: which ranges of the tiles that is, the heads of their streams, and where their
// corners are (strip_arena.h) when the draws are recorded.
//
// Errors: of plans: Status; Vulkan's: VulkanError. Not thread safe.
#pragma once

#include <map>
#include <span>
#include <utility>
#include <vector>

#include "client/render/frame.h"
#include "client/render/strip_arena.h"

namespace citystream::client {

/// Where the corners of a range are when its round is drawn.
struct StripPlace {
    uint32_t round = 0;
    VkDeviceAddress corners = 0;  ///< three 32-bit vertex numbers a triangle
};

class StripRanges {
  public:
    /// The device outlives it.
    StripRanges(const Device& device, uint64_t arena_bytes) : arena_(device, arena_bytes, choose_scan_tuning(device)) {}

    /// The words that begin a layer; of a mesh layer (checked, codec/mesh/mesh_resident.h) the heads of its streams are
    /// remembered.
    void learn(LayerId layer, std::span<const uint32_t> words);
    /// Before a layer is destroyed.
    void forget(LayerId layer);

    /// A frame: of each tile its mesh layer's reference (draw_layout.h), then once plan(), after which places are
    /// known, then recording, then finish_frame().
    void begin_frame() { ranges_.clear(); }
    /// The number of the tile's first range of strip code; the others of the tile follow, without dressed ones if those
    /// are not drawn. Fails for a range whose stream was never learnt.
    Result<size_t> add(const TileDraw& tile, VkDeviceAddress mesh, bool draws_dressed);
    Status plan();
    const StripPlace& place(size_t range) const { return places_[range]; }
    /// At least one, which also draws all that is no strip code.
    uint32_t round_count() const { return std::max(arena_.round_count(), 1u); }
    /// Outside of render passes, before the round's draws.
    void record_round(VkCommandBuffer commands, uint32_t round) const {
        if (!ranges_.empty()) arena_.record_round(commands, round);
    }
    void finish_frame() { arena_.finish_frame(); }

    const StripArenaCounts& counts() const { return arena_.counts(); }
    uint64_t bytes_allocated() const { return arena_.bytes_allocated(); }

  private:
    StripArena arena_;
    std::map<std::pair<LayerId, uint32_t>, codec::mesh::StripHeader> headers_;  ///< by layer and first word
    std::vector<StripRange> ranges_;                                            ///< of the frame
    std::vector<StripPlace> places_;
};

}  // namespace citystream::client
