#include "client/render/layer_pages.h"

#include <algorithm>
#include <cstring>

#include "client/render/draw_layout.h"

namespace citystream::client {

void LayerPages::begin(std::span<const LayerId> layers) {
    used_ = 0;
    uint64_t bytes = 0;
    for (const LayerId layer : layers) {
        if (!is_contiguous(pool_, pool_.layers[layer]))
            bytes += sizeof(VkDeviceAddress) * pool_.layers[layer].slots.size();
    }
    if (bytes <= buffer_.bytes) return;
    destroy_buffer(device_, buffer_);
    buffer_ = create_buffer(device_, std::max<uint64_t>(16 << 10, bytes + bytes / 2), BufferPlace::kUpload);
}

VkDeviceAddress LayerPages::reference(LayerId id) {
    const SlotLayer& layer = pool_.layers[id];
    if (is_contiguous(pool_, layer)) return slot_address(pool_, layer.slots[0]) | LAYER_REF_DIRECT;
    const VkDeviceAddress table = buffer_.address + used_;
    auto* to = static_cast<std::byte*>(buffer_.mapped) + used_;
    for (const uint32_t slot : layer.slots) {
        const VkDeviceAddress address = slot_address(pool_, slot);
        std::memcpy(to, &address, sizeof address);
        to += sizeof address;
    }
    used_ += sizeof(VkDeviceAddress) * layer.slots.size();
    return table;
}

}  // namespace citystream::client
