// References of layers (draw_layout.h) for compute passes that read or write them: of a layer in pieces a page table,
// in one mapped buffer. Nothing may be in flight when tables begin. Errors: VulkanError.
#pragma once

#include <span>

#include "client/render/slot_pool.h"

namespace citystream::client {

class LayerPages {
  public:
    LayerPages(const Device& device, const SlotPool& pool) : device_(device), pool_(pool) {}
    ~LayerPages() { destroy_buffer(device_, buffer_); }
    LayerPages(const LayerPages&) = delete;
    LayerPages& operator=(const LayerPages&) = delete;

    /// Room for the tables of these layers, which live and hold something; tables of before are gone.
    void begin(std::span<const LayerId> layers);
    /// Of one of them. It holds until its slots move or the next begin.
    VkDeviceAddress reference(LayerId layer);
    uint64_t bytes() const { return buffer_.bytes; }

  private:
    const Device& device_;
    const SlotPool& pool_;
    Buffer buffer_;
    uint64_t used_ = 0;
};

}  // namespace citystream::client
