// What a frame is drawn into: colour and depth images, the two render passes over them, and the way back to host
// memory.
#pragma once

#include "client/render/buffer.h"

namespace citystream::client {

struct Image {
    VkImage handle = VK_NULL_HANDLE;
    VkDeviceMemory memory = VK_NULL_HANDLE;
    VkImageView view = VK_NULL_HANDLE;
    uint64_t bytes = 0;
};

inline constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;

/// An image of one level with memory and a view of its own, device-local where such memory suffices. Throws
/// VulkanError.
Image create_image(const Device& device, VkFormat format, VkExtent2D extent, VkImageUsageFlags usage,
                   VkImageAspectFlags aspect);
void destroy_image(const Device& device, Image& image);
VkImageMemoryBarrier image_barrier(const Image& image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to,
                                   VkAccessFlags from_access, VkAccessFlags to_access);

struct FrameTarget {
    uint32_t width = 0, height = 0;            ///< of the frame that is read back
    uint32_t scale = 1;                        ///< samples a pixel in each direction
    Image colour;                              ///< RGBA8, width * scale x height * scale
    Image depth;                               ///< D32F, reversed: 0 is infinitely far
    VkRenderPass clear_pass = VK_NULL_HANDLE;  ///< clears both
    VkRenderPass load_pass = VK_NULL_HANDLE;   ///< goes on with both
    VkFramebuffer framebuffer = VK_NULL_HANDLE;
    Buffer samples;   ///< device memory; only when scale > 1
    Buffer readback;  ///< width * height RGBA8
};

FrameTarget create_frame_target(const Device& device, uint32_t width, uint32_t height, uint32_t scale);
void destroy_frame_target(const Device& device, FrameTarget& target);
uint64_t memory_bytes(const FrameTarget& target);

/// Makes both images ready to be drawn (their old content is dropped).
void begin_target(VkCommandBuffer commands, const FrameTarget& target);
void begin_pass(VkCommandBuffer commands, const FrameTarget& target, VkRenderPass pass, const float clear[4]);
/// The second pass waits for what the first one wrote.
void barrier_between_passes(VkCommandBuffer commands);
/// Copies the colour image to `to` (samples or readback), ready for compute or host reads after a barrier from the
/// transfer stage.
void copy_colour(VkCommandBuffer commands, const FrameTarget& target, const Buffer& to);

}  // namespace citystream::client
