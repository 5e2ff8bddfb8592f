#include "client/render/draw_records.h"

#include <algorithm>
#include <cstring>

namespace citystream::client {

void DrawRecords::begin_frame(uint64_t draws) {
    used_ = 0;
    const uint64_t bytes = draws * sizeof(MeshDrawConstants);
    if (buffer_.bytes >= bytes) return;
    destroy_buffer(device_, buffer_);
    buffer_ = create_buffer(device_, std::max<uint64_t>(64 << 10, bytes + bytes / 2), BufferPlace::kUpload);
}

VkDeviceAddress DrawRecords::add(MeshDrawConstants draw, VkDeviceAddress corners) {
    draw.corners[0] = static_cast<uint32_t>(corners);
    draw.corners[1] = static_cast<uint32_t>(corners >> 32);
    std::memcpy(static_cast<std::byte*>(buffer_.mapped) + used_, &draw, sizeof draw);
    const VkDeviceAddress address = buffer_.address + used_;
    used_ += sizeof draw;
    return address;
}

}  // namespace citystream::client
