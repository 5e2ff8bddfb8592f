// The records of a frame's mesh draws (mesh_draw_layout.h) in one mapped buffer. Nothing may be in flight when a frame
// begins. Errors: VulkanError.
#pragma once

#include <cstdint>

#include "client/render/buffer.h"
#include "client/render/mesh_draw_layout.h"

namespace citystream::client {

class DrawRecords {
  public:
    explicit DrawRecords(const Device& device) : device_(device) {}
    DrawRecords(const DrawRecords&) = delete;
    DrawRecords& operator=(const DrawRecords&) = delete;
    ~DrawRecords() { destroy_buffer(device_, buffer_); }

    /// Of at most so many draws; `lit`: in a frame with a light.
    void begin_frame(uint64_t draws, bool lit);
    /// Where the record is; `corners`: of a range of strip code. `radiance`: of its tile; left out without a light.
    VkDeviceAddress add(MeshDrawConstants draw, VkDeviceAddress corners, const RadianceDraw& radiance);
    uint64_t bytes() const { return buffer_.bytes; }

  private:
    const Device& device_;
    Buffer buffer_;
    uint64_t used_ = 0;
    uint64_t record_bytes_ = sizeof(MeshDrawConstants);
};

}  // namespace citystream::client
