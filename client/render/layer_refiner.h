// Layers of a slot pool whose precision buffers take more bits (LayerStore::refine): a changed layer moves to new slots
// at once, and its words are written there, from the old slots and the new planes, by one dispatch for all layers that
// changed since the last one. Its old slots stay taken until then.
//
// Errors: of requests: Result; Vulkan's: VulkanError. Not thread safe; nothing may be in flight on the queue but where
// `record` says so.
#pragma once

#include <optional>

#include "client/render/precision_merger.h"
#include "client/render/slot_pool.h"

namespace citystream::client {

/// A change that is possible.
struct LayerRefinement {
    LayerId layer = kNoLayer;
    uint32_t begin = 0;  ///< words before the buffer
    codec::mesh::PrecisionShape shape;
    uint32_t from_level = 0, to_level = 0;
    uint64_t words = 0;  ///< of the whole layer after it

    uint64_t slots() const { return (4 * words + kSlotBytes - 1) / kSlotBytes; }
};

class LayerRefiner {
  public:
    /// Both outlive it; the pool must not be moved.
    LayerRefiner(const Device& device, SlotPool& pool) : device_(device), pool_(pool) {}
    ~LayerRefiner();
    LayerRefiner(const LayerRefiner&) = delete;
    LayerRefiner& operator=(const LayerRefiner&) = delete;

    /// Checks a request against the header in the layer's words. Runs what waits when it concerns this layer.
    Result<LayerRefinement> plan(LayerId layer, uint64_t begin, uint64_t plane_words, uint32_t to_level);
    /// Makes the change one of those that wait. Fails, and changes nothing, when its slots are not free. `planes`: as
    /// many words as were planned.
    Status add(const LayerRefinement& refinement, std::span<const uint32_t> planes);

    /// Before anything else is done with the layer's words: they are there after it.
    void settle(LayerId layer);
    /// Frees `slots` slots if changes that wait hold them.
    void make_room(uint64_t slots);
    /// Before a layer is destroyed: what waits for it is dropped.
    void forget(LayerId layer);

    bool is_waiting() const { return !waiting_.empty(); }
    /// Slots that only hold words to be read by what waits.
    uint64_t held_slots() const { return held_slots_; }
    /// Memory for jobs, page tables and planes, besides the pool's.
    uint64_t buffer_bytes() const { return upload_.bytes; }

    /// Records the dispatch of all changes that wait, whose words whatever is recorded after it may read. Once the
    /// commands have run, `finish`.
    void record(VkCommandBuffer commands);
    void finish();
    /// Both, in a submission of its own.
    void run();

  private:
    struct Waiting {
        LayerRefinement change;
        SlotLayer old;
        uint64_t planes_at = 0;  ///< words of planes_
    };
    bool is_waiting(LayerId layer) const;
    uint64_t page_bytes(const SlotLayer& layer) const;

    const Device& device_;
    SlotPool& pool_;
    std::optional<PrecisionMerger> merger_;  ///< made when first needed
    std::vector<Waiting> waiting_;
    std::vector<uint32_t> planes_;
    uint64_t target_words_ = 0, held_slots_ = 0;
    Buffer upload_;
};

}  // namespace citystream::client
