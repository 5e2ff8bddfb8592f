// Times of a frame's stages on the device. Does nothing on devices without timestamps. Errors: VulkanError.
#pragma once

#include "client/render/device.h"
#include "client/render/frame.h"

namespace citystream::client {

// Stages between two timestamps each.
enum Timestamp : uint32_t { kBegin, kMeshDone, kFacadesDone, kEnd, kLightBegin, kLightDone, kTimestampCount };
/// Of frames without a light.
constexpr uint32_t kPlainTimestamps = kLightBegin;

class FrameTimestamps {
  public:
    explicit FrameTimestamps(const Device& device);
    ~FrameTimestamps() { vkDestroyQueryPool(device_.handle, queries_, nullptr); }
    FrameTimestamps(const FrameTimestamps&) = delete;
    FrameTimestamps& operator=(const FrameTimestamps&) = delete;

    /// Before the first mark of a frame.
    void reset(VkCommandBuffer commands) const;
    void mark(VkCommandBuffer commands, Timestamp stamp) const;
    /// Of a frame that ended; `lit`: it has the light's marks, too.
    void read(bool lit, FrameTimings& timings) const;

  private:
    const Device& device_;
    VkQueryPool queries_ = VK_NULL_HANDLE;
};

}  // namespace citystream::client
