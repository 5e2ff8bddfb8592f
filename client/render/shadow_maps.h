// The sun's shadow maps in GPU memory: one depth image that the cascades are drawn into one after the other, and a
// buffer that keeps what was drawn, for shaders read by address. Errors: VulkanError.
#pragma once

#include "client/render/frame_target.h"
#include "client/render/light_layout.h"

namespace citystream::client {

class ShadowMaps {
  public:
    /// `side`: texels. The device outlives it. 20 bytes a texel.
    ShadowMaps(const Device& device, uint32_t side);
    ~ShadowMaps();
    ShadowMaps(const ShadowMaps&) = delete;
    ShadowMaps& operator=(const ShadowMaps&) = delete;

    uint32_t side() const { return side_; }
    /// What passes that draw into it are made for: depth alone.
    VkRenderPass render_pass() const { return clear_pass_; }
    /// A render pass over the image; `begins`: cleared, else on with what is there.
    void begin_pass(VkCommandBuffer commands, bool begins) const;
    /// After the last pass of a cascade: keeps it. Fragment shaders may read it after this.
    void keep(VkCommandBuffer commands, uint32_t cascade) const;
    VkDeviceAddress depths(uint32_t cascade) const { return depths_.address + cascade * cascade_bytes(); }
    uint64_t bytes() const { return image_.bytes + depths_.bytes; }

  private:
    uint64_t cascade_bytes() const { return uint64_t{4} * side_ * side_; }
    void destroy();

    const Device& device_;
    uint32_t side_;
    Image image_;
    VkRenderPass clear_pass_ = VK_NULL_HANDLE, load_pass_ = VK_NULL_HANDLE;
    VkFramebuffer framebuffer_ = VK_NULL_HANDLE;
    Buffer depths_;
};

}  // namespace citystream::client
