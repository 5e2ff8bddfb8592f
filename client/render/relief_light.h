// Light on the relief of facades, for frames with a light in which tiles have local light (radiance_passes.h): which
// maps get a mask or a BTF (relief_masks.h, btf_store.h), and what each tile's draws name of them. Nothing is made
// before such a frame, and nothing where it is left out.
//
// Walls that stretch one map differently share its mask and its BTF: those of the wall that covers the most pixels in
// the frame that first wants them.
//
// Errors: VulkanError, or Status where said. Not thread safe; nothing may be in flight on the queue but where record()
// says so.
#pragma once

#include <map>
#include <set>
#include <span>
#include <vector>

#include "client/render/btf_store.h"
#include "client/render/facade_map_facts.h"
#include "client/render/frame.h"
#include "client/render/frame_constants.h"
#include "client/render/frame_lighting.h"

namespace citystream::client {

/// A facade's place, metres from its tile's origin.
struct ReliefWall {
    std::array<double, 3> corner{};  ///< lower left seen from outside
    std::array<double, 2> along{};   ///< to the lower right
    double height = 0;
};

/// Of a tile's facade layer, by placement; none of words that are no such layer or do not hold all of it.
std::vector<ReliefWall> relief_walls(std::span<const uint32_t> words);

/// How many pixels of a picture a wall covers along its longer side, seen from as far away as its nearest and its
/// farthest point are: what decides how it is drawn (relief_draw_layout.h).
struct WallPixels {
    double most = 0, least = 0;
};
/// `height`: of the picture, in samples. Of a wall that is behind the camera or seen from behind both are 0.
WallPixels wall_pixels(const ReliefWall& wall, const std::array<double, 3>& origin, const Camera& camera,
                       uint32_t height);

class ReliefLight {
  public:
    /// `device` and `pool` outlive it. `btf_budget_bytes`: of the BTFs' buffer. `btf_texels`: of a BTF across
    /// (BtfOptions::patch). `most_rays`: as ReliefMaking has it; software drivers leave the making to the host.
    ReliefLight(const Device& device, SlotPool& pool, FacadeRenderer renderer, uint64_t btf_budget_bytes,
                uint32_t btf_texels, uint64_t most_rays);

    /// The words that begin a layer, of any kind; once more replaces what was known.
    void learn(LayerId layer, std::span<const uint32_t> words);
    /// A facade layer of which too few words were learnt.
    bool is_partial(LayerId layer) const { return partial_.contains(layer); }
    /// The mask and the BTF of a map that gets more words.
    void forget_light(LayerId layer);
    /// Before a layer is destroyed.
    void forget(LayerId layer);

    /// A frame, after `lighting` planned it. `facts`: of the facade maps, by layer; `height`: of the picture, in
    /// samples. Error: what the masks and BTFs report.
    Status plan(const Camera& camera, std::span<const TileDraw> tiles, std::span<const FacadeMapFacts> facts,
                const FrameLighting& lighting, uint32_t height);
    /// Of a tile of that frame.
    TileRelief of(const TileDraw& tile, const FrameLighting& lighting) const;
    /// Before the draws: what was planned, and a barrier.
    void record(VkCommandBuffer commands);
    void finish();

    /// Gives slots back until `slots` are free, or none are left here.
    void make_room(uint64_t slots) { masks_.make_room(slots); }
    uint64_t slots_used() const { return masks_.slots_used(); }
    /// Of the frame planned last.
    void count(FrameCounts& counts) const;
    /// Memory besides the pool's.
    uint64_t buffer_bytes() const { return masks_.buffer_bytes() + btfs_.buffer_bytes(); }

  private:
    struct Wanted {
        ReliefMap map;
        bool mask = false, btf = false;
        double pixels = 0;  ///< of the largest wall that shows it
    };
    void want(const Camera& camera, const TileDraw& tile, std::span<const FacadeMapFacts> facts, uint32_t height);
    std::vector<Wanted> wanted_with_room() const;

    FacadeRenderer renderer_;
    codec::radiance::BtfOptions btf_options_;
    ReliefMasks masks_;
    BtfStore btfs_;
    std::map<LayerId, std::vector<ReliefWall>> walls_;  ///< by facade layer
    std::set<LayerId> partial_;
    std::map<LayerId, Wanted> wanted_;                         ///< by map
    std::map<LayerId, codec::radiance::FacadeScales> scales_;  ///< by map, from when it is first wanted
    uint64_t cast_ = 0, by_btf_ = 0, by_mean_ = 0;             ///< facades of the frame
};

}  // namespace citystream::client
