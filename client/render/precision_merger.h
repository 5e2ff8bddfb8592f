// Changes the bit level of precision buffers on the GPU (Meyer 2012, section 3.6.2; P8): all buffers of a frame in one
// dispatch, only new planes are uploaded, nothing where bits are dropped, and no temporary memory.
#pragma once

#include <span>

#include "client/render/buffer.h"
#include "client/render/pipelines.h"
#include "client/render/precision_merge_layout.h"
#include "codec/mesh/adaptive_precision.h"

namespace citystream::client {

/// One buffer that changes. References are those of layers (draw_layout.h), in one piece or paged. The header behind
/// `source` has been checked by read_precision_header, source and target have as many words as it says, planes as many
/// as words_between says: the pass trusts them.
struct PrecisionChange {
    const codec::mesh::PrecisionShape* shape = nullptr;
    uint32_t from_level = 0, to_level = 0;
    VkDeviceAddress source = 0;
    VkDeviceAddress planes = 0;  ///< planes from_level..to_level - 1, one after the other; not read downwards
    VkDeviceAddress target = 0;  ///< words_before + shape->words_at(to_level) words, none of them the source's
    uint32_t words_before = 0;   ///< of the layer, before the buffer: copied
};

class PrecisionMerger {
  public:
    /// Throws VulkanError. The device outlives it.
    explicit PrecisionMerger(const Device& device);
    ~PrecisionMerger();
    PrecisionMerger(const PrecisionMerger&) = delete;
    PrecisionMerger& operator=(const PrecisionMerger&) = delete;

    /// Bytes of a job table for `changes` changes.
    static uint64_t table_bytes(size_t changes) { return changes * sizeof(PrecisionMergeJob); }

    /// Records the one dispatch. `table`: mapped, at least table_bytes, not touched until the dispatch has run. Before
    /// it sources and planes must be visible to compute shaders; a barrier from compute writes must follow. No changes:
    /// records nothing.
    void record(VkCommandBuffer commands, std::span<const PrecisionChange> changes, const Buffer& table) const;

  private:
    const Device& device_;
    Pass pass_;
};

}  // namespace citystream::client
