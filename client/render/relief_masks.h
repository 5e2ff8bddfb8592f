// Relief masks of facade maps (codec/radiance/relief_mask.h), made from the maps' resident words: on the device by the
// ray caster that draws them, or by the host's rays. They lie in slots of the pool that holds the layers, so its budget
// holds for both, and are dropped where the layers need their room, as are the coordinates of coordinate_layers.h: a
// map without one is drawn as in a client without masks.
//
// Use: plan() with what a frame draws, record() before the draws, finish() once the commands have run. Not thread safe;
// nothing may be in flight on the queue but where record() says so. Errors: VulkanError, or Status where said.
#pragma once

#include <array>
#include <map>
#include <memory>
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

/// How masks and BTFs are made.
struct ReliefMaking {
    /// By rays on the host, on all cores, in place of compute passes.
    bool on_host = false;
    /// Of a frame, of masks and of BTFs each; 0: as many as what is planned takes. What is not done by then goes on in
    /// the next frames that plan it, and is not there until it is done.
    uint64_t most_rays = 0;
};

struct ReliefMaskCounts {
    uint64_t masks = 0, bytes = 0;   ///< that are there or begun
    uint64_t made = 0, refused = 0;  ///< of the frame planned last: finished; no room, or the layer is not a map
    uint64_t rays = 0;               ///< of the frame planned last
};

class ReliefMasks {
  public:
    /// `device` and `pool` outlive it; the pool must not be moved. Nothing is made yet.
    ReliefMasks(const Device& device, SlotPool& pool, const ReliefMaking& making = {});
    ~ReliefMasks();
    ReliefMasks(const ReliefMasks&) = delete;
    ReliefMasks& operator=(const ReliefMasks&) = delete;

    /// `maps`: each once, those that matter most first. Those that have no mask get one by record(), as far as there is
    /// room: that of masks which are not among them is taken, longest unused first. Error: a map that does not exist.
    Status plan(std::span<const ReliefMap> maps);
    /// Records what was planned, and a barrier: whatever is recorded after it may read the masks.
    void record(VkCommandBuffer commands);
    void finish();

    /// kNoLayer: it has none that is done. Valid from plan() on (its words from record()'s commands on) until it is
    /// planned again.
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
    /// What the host makes a mask of.
    struct HostMask {
        codec::facade::RunGrid grid;
        std::vector<uint32_t> words;
    };
    struct Mask {
        LayerId layer = kNoLayer;
        uint32_t caster = 0;
        uint64_t used = 0;                ///< number of the plan that named it last
        uint32_t first_word = 0;          ///< of its surfaces
        uint32_t surfaces = 0, done = 0;  ///< done: with the frame planned last
        std::unique_ptr<HostMask> host;   ///< until it is done
    };
    /// Surfaces that the device makes in this frame.
    struct Job {
        LayerId map;
        uint32_t first, count;
    };

    bool make(const ReliefMap& map);
    void go_on(LayerId map, Mask& mask);
    void finish_on_host(Mask& mask);
    bool drop_oldest();
    void drop(std::map<LayerId, Mask>::iterator at);

    const Device& device_;
    SlotPool& pool_;
    ReliefMaking making_;
    LayerPages pages_;
    std::array<Pass, FACADE_RENDERER_COUNT> passes_{};  ///< by caster, made when first needed
    std::map<LayerId, Mask> masks_;                     ///< by map
    std::vector<Job> todo_;
    uint64_t plans_ = 0, slots_used_ = 0, refused_ = 0, made_ = 0, rays_ = 0;
};

}  // namespace citystream::client
