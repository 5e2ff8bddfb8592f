#include "client/render/draw_records.h"

#include <algorithm>
#include <cstring>

namespace citystream::client {

void DrawRecords::begin_frame(uint64_t draws, bool lit) {
    used_ = 0;
    record_bytes_ = lit ? sizeof(LitMeshDraw) : sizeof(MeshDrawConstants);
    const uint64_t bytes = draws * record_bytes_;
    if (buffer_.bytes >= bytes) return;
    destroy_buffer(device_, buffer_);
    buffer_ = create_buffer(device_, std::max<uint64_t>(64 << 10, bytes + bytes / 2), BufferPlace::kUpload);
}

VkDeviceAddress DrawRecords::add(MeshDrawConstants draw, VkDeviceAddress corners, const RadianceDraw& radiance) {
    LitMeshDraw record{draw, radiance};
    record.draw.corners[0] = static_cast<uint32_t>(corners);
    record.draw.corners[1] = static_cast<uint32_t>(corners >> 32);
    std::memcpy(static_cast<std::byte*>(buffer_.mapped) + used_, &record, record_bytes_);
    const VkDeviceAddress address = buffer_.address + used_;
    used_ += record_bytes_;
    return address;
}

}  // namespace citystream::client
