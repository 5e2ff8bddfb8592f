// BTFs of facade maps (codec/radiance/btf.h), made from the maps' words and their relief masks: on the device by the
// ray caster that draws them, or by the host's rays. They lie in one buffer with a budget of its own, taken when the
// first is made; a map for which there is no room has none.
//
// Use as ReliefMasks: plan(), record(), finish(). Not thread safe; nothing may be in flight on the queue but where
// record() says so. Errors: VulkanError, or Status where said.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "client/render/relief_masks.h"
#include "codec/radiance/btf.h"

namespace citystream::client {

struct BtfCounts {
    uint64_t btfs = 0, bytes = 0;    ///< that are there or begun
    uint64_t made = 0, refused = 0;  ///< of the frame planned last: finished; no room, no mask, or not a map
    uint64_t rays = 0;               ///< of the frame planned last
};

class BtfStore {
  public:
    /// `device`, `pool` and `masks` outlive it. Nothing is made yet. `options`: as btf_shape takes them.
    BtfStore(const Device& device, SlotPool& pool, const ReliefMasks& masks, uint64_t budget_bytes,
             const codec::radiance::BtfOptions& options = {}, const ReliefMaking& making = {});
    ~BtfStore();
    BtfStore(const BtfStore&) = delete;
    BtfStore& operator=(const BtfStore&) = delete;

    /// `maps`: each once, those that matter most first, of those planned for `masks` in this frame; those without a BTF
    /// get one by record() where they have a mask and there is room: that of BTFs which are not among them is taken,
    /// longest unused first. Error: a map that does not exist.
    Status plan(std::span<const ReliefMap> maps);
    /// Whether plan() would make one or go on with it: such maps need a mask in this frame.
    bool is_missing(LayerId map) const;
    /// After the masks' own record. Records what was planned, and a barrier: whatever is recorded after it may read the
    /// BTFs.
    void record(VkCommandBuffer commands);
    void finish();

    /// Reference of its words, which lie in one piece (draw_layout.h); 0: the map has none that is done. Valid from
    /// plan() on (its words from record()'s commands on) until it is planned again.
    VkDeviceAddress reference(LayerId map) const;
    /// Before a map's layer is destroyed or its words are replaced.
    void forget(LayerId map);

    /// What the map's BTF takes of the budget; 0: it cannot have one.
    uint64_t bytes_of(const ReliefMap& map) const;
    uint64_t budget_bytes() const { return budget_bytes_; }

    BtfCounts counts() const;
    /// That holds the BTFs; nothing before there is one.
    const Buffer& buffer() const { return buffer_; }
    bool has_pipeline() const { return mip_pass_.handle != VK_NULL_HANDLE; }
    /// All memory that it takes: the budget once there is a BTF, and page tables.
    uint64_t buffer_bytes() const { return buffer_.bytes + pages_.bytes(); }

  private:
    /// What the host makes a BTF of.
    struct HostBtf {
        codec::facade::RunGrid grid;
        std::vector<uint32_t> mask, words;
    };
    struct Place {
        uint64_t begin = 0, bytes = 0;  ///< in the buffer
        uint64_t used = 0;              ///< number of the plan that named it last
        codec::radiance::BtfShape shape;
        uint32_t done = 0;              ///< views, with the frame planned last
        std::unique_ptr<HostBtf> host;  ///< until it is done
    };
    /// Views that the device makes in this frame.
    struct Job {
        ReliefMap map;
        uint32_t first = 0, count = 0;
    };

    bool make(const ReliefMap& map);
    void go_on(const ReliefMap& map, Place& place);
    std::unique_ptr<HostBtf> begin_on_host(const ReliefMap& map, const codec::radiance::BtfShape& shape) const;
    void make_on_host(Place& place, uint32_t count);
    std::optional<uint64_t> gap_for(uint64_t bytes) const;
    bool drop_oldest();
    void record_head(VkCommandBuffer commands, const Job& job);
    void record_job(VkCommandBuffer commands, const Job& job);

    const Device& device_;
    SlotPool& pool_;
    const ReliefMasks& masks_;
    uint64_t budget_bytes_;
    codec::radiance::BtfOptions options_;
    ReliefMaking making_;
    LayerPages pages_;
    Buffer buffer_;
    std::array<Pass, FACADE_RENDERER_COUNT> passes_{};  ///< by caster, made when first needed
    Pass mip_pass_;
    std::map<LayerId, Place> btfs_;  ///< by map
    std::vector<Job> todo_;
    uint64_t plans_ = 0, made_ = 0, refused_ = 0, rays_ = 0;
};

}  // namespace citystream::client
