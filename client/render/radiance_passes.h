// Brings the light of a frame to the receivers of its tiles (Sun et al. 2011, algorithm 2), when the light changed or a
// tile's words are new: sums of each cluster, sums of each row, irradiance of each receiver, which goes into the words
// of the layer (codec/radiance/radiance_layer_layout.h), wherever their slots are. All tiles of a frame go together, in
// as few batches as a bounded buffer of sums allows. Everything is whole numbers: codec/radiance/irradiance.h gives the
// same words.
//
// What a layer's content says is bounded by its header, which is checked: nothing outside its words is read or written,
// whatever they are. Errors: VulkanError, or Status where said. Not thread safe; nothing may be in flight on the queue
// but where `record` says so.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "client/render/frame_light.h"
#include "client/render/layer_pages.h"
#include "client/render/pipelines.h"
#include "client/render/radiance_passes_layout.h"
#include "client/render/slot_pool.h"
#include "codec/radiance/radiance_layer.h"

namespace citystream::client {

/// What the passes did for a frame; all 0 where neither light nor tiles changed.
struct RadianceCounts {
    uint64_t tiles = 0, receivers = 0, clusters = 0, rows = 0;
    uint64_t batches = 0;
    uint64_t local_receivers = 0;  ///< of which local light was made
    uint64_t unlit = 0;  ///< tiles of the frame whose words are not a layer, or not for light of this many texels
};

class RadiancePasses {
  public:
    /// Both outlive it; the pool must not be moved. Nothing is made yet. `sum_bytes`: of the buffer of sums, but that a
    /// tile which needs more has it alone.
    RadiancePasses(const Device& device, SlotPool& pool, uint64_t sum_bytes = 32 << 20);
    ~RadiancePasses();
    RadiancePasses(const RadiancePasses&) = delete;
    RadiancePasses& operator=(const RadiancePasses&) = delete;

    /// For frames from here on. Of a light with the number of the one before nothing is looked at.
    void set_light(const FrameLight& light);
    /// Irradiance of the set light that 1.0 in the layers' words stands for; 0 before there is one.
    std::array<float, 3> irradiance_unit() const { return unit_; }

    /// `layers`: of the frame, each once. Those that have not seen the light are lit by `record`; the header of one
    /// that is new is read from its slots. `with_local`: of them, those that are to have local light, too
    /// (codec/radiance/local_light.h), as far as there is room; what others have is kept until the layers need it.
    /// Error: a layer that does not exist.
    Status plan(std::span<const LayerId> layers, std::span<const LayerId> with_local = {});
    /// Words of the layer's local light, in the pool; kNoLayer: it has none. Valid from plan() on (its words from
    /// record()'s commands on) until the next.
    LayerId local_light(LayerId layer) const;
    uint32_t local_receivers(LayerId layer) const;  ///< that have such words
    /// Gives slots of local light back until `slots` are free, or none are left here.
    void make_room(uint64_t slots);
    uint64_t local_slots() const { return local_slots_; }  ///< of local light
    /// Records what was planned, and a barrier: whatever is recorded after it may read the words. Once the commands
    /// have run, `finish`.
    void record(VkCommandBuffer commands);
    void finish();
    /// Before a layer is destroyed, or its words are replaced.
    void forget(LayerId layer);

    /// Of the frame planned last.
    const RadianceCounts& counts() const { return counts_; }
    bool has_pipeline() const { return passes_[0].handle != VK_NULL_HANDLE; }
    /// Memory for light, jobs, page tables and sums, besides the pool's.
    uint64_t buffer_bytes() const;

  private:
    /// What is known of a layer: its job but for what is of a batch.
    struct Known {
        uint64_t words = 0;  ///< of the layer when its header was read
        bool usable = false;
        std::optional<uint64_t> lit;  ///< number of the light it has seen
        uint32_t walls = 0;           ///< receivers that may have local light
        LayerId local = kNoLayer;     ///< words of local light
        bool local_is_lit = false;    ///< by the same light
        RadianceJob job{};
        uint64_t sums() const { return uint64_t{job.clusters} + job.rows; }
    };
    struct Batch {
        size_t first = 0, end = 0;  ///< of todo_
        std::array<uint32_t, RADIANCE_PASSES> groups{};
    };

    Known read_header(LayerId layer) const;
    bool is_for_light(const Known& known) const;
    void ensure_local(Known& known);
    void drop_local(Known& known);
    std::vector<Batch> batches() const;
    void make_buffers(const std::vector<Batch>& batches);
    void write_jobs(const std::vector<Batch>& batches);
    void record_batch(VkCommandBuffer commands, const Batch& batch) const;

    const Device& device_;
    SlotPool& pool_;
    uint64_t sum_bytes_;
    LayerPages pages_;
    std::array<Pass, RADIANCE_PASSES> passes_{};  ///< these and the buffers are made when first needed
    Buffer light_buffer_, job_buffer_, sum_buffer_;

    std::optional<uint64_t> number_;
    bool light_is_uploaded_ = false;
    std::vector<uint32_t> light_;                    ///< RADIANCE_SUM_WORDS a texel
    std::vector<std::array<double, 3>> directions_;  ///< of the light's texels
    std::array<float, 3> unit_{};
    std::map<LayerId, Known> known_;
    std::vector<LayerId> todo_;
    uint64_t local_slots_ = 0;
    RadianceCounts counts_;
};

}  // namespace citystream::client
