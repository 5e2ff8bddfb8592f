// Relief masks of facade maps (codec/radiance/relief_mask.h), made on the device from the maps' resident words by the
// ray caster that draws them. They lie in slots of the pool that holds the layers, so its budget holds for both, and
// are dropped where the layers need their room, as are the coordinates of coordinate_layers.h: a map without one is
// drawn as in a client without masks.
//
// Use: plan() with what a frame draws, record() before the draws, finish() once the commands have run. Not thread safe;
// nothing may be in flight on the queue but where record() says so. Errors: VulkanError, or Status where said.
#pragma once

#include <array>
#include <map>
#include <span>
#include <vector>

#include "client/render/facade_renderer_layout.h"
#include "client/render/layer_pages.h"
#include "client/render/pipelines.h"
#include "client/render/slot_pool.h"
#include "codec/radiance/relief_mask.h"

namespace citystream::client {

/// A facade map that is to have a mask or a BTF.
struct ReliefMap {
    LayerId map = kNoLayer;
    uint32_t caster = 0;     ///< number of facade_renderer_layout.h that draws its form (caster_for)
    uint32_t slots = 0;      ///< palette_slots of codec/radiance/btf.h
    bool is_opaque = false;  ///< it has no open texels
    codec::radiance::FacadeScales scales = codec::radiance::kCentimetreTexels;
};

struct ReliefMaskCounts {
    uint64_t masks = 0, bytes = 0;   ///< that are there
    uint64_t made = 0, refused = 0;  ///< of the frame planned last; refused: no room, or the layer is not a map
};

class ReliefMasks {
  public:
    /// Both outlive it; the pool must not be moved. Nothing is made yet.
    ReliefMasks(const Device& device, SlotPool& pool);
    ~ReliefMasks();
    ReliefMasks(const ReliefMasks&) = delete;
    ReliefMasks& operator=(const ReliefMasks&) = delete;

    /// `maps`: each once. Those that have no mask get one by record(), as far as there is room: that of masks which are
    /// not among them is taken, longest unused first. Error: a map that does not exist.
    Status plan(std::span<const ReliefMap> maps);
    /// Records what was planned, and a barrier: whatever is recorded after it may read the masks.
    void record(VkCommandBuffer commands);
    void finish();

    /// kNoLayer: it has none. Valid from plan() on (its words from record()'s commands on) until it is planned again.
    LayerId mask_of(LayerId map) const;
    /// Before a map's layer is destroyed or its words are replaced.
    void forget(LayerId map);
    /// Gives slots back until `slots` are free, or none are left here.
    void make_room(uint64_t slots);
    uint64_t slots_used() const { return slots_used_; }

    ReliefMaskCounts counts() const;
    bool has_pipeline() const;
    /// Memory besides the pool's.
    uint64_t buffer_bytes() const { return pages_.bytes(); }

  private:
    struct Mask {
        LayerId layer = kNoLayer;
        codec::radiance::ReliefMaskShape shape;
        uint64_t used = 0;  ///< number of the plan that named it last
    };
    struct Job {
        ReliefMap map;
        LayerId mask;
        uint32_t texels;
    };

    bool make(const ReliefMap& map);
    bool drop_oldest();
    void drop(std::map<LayerId, Mask>::iterator at);

    const Device& device_;
    SlotPool& pool_;
    LayerPages pages_;
    std::array<Pass, FACADE_RENDERER_COUNT> passes_{};  ///< by caster, made when first needed
    std::map<LayerId, Mask> masks_;                     ///< by map
    std::vector<Job> todo_;
    uint64_t plans_ = 0, slots_used_ = 0, refused_ = 0, made_ = 0;
};

}  // namespace citystream::client
