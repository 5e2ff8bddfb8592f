#include "client/render/frame_target.h"

#include <array>

namespace citystream::client {
namespace {

constexpr VkFormat kColourFormat = VK_FORMAT_R8G8B8A8_UNORM;

VkRenderPass create_render_pass(const Device& device, VkAttachmentLoadOp load) {
    constexpr VkImageLayout kColour = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
    constexpr VkImageLayout kDepth = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
    std::array<VkAttachmentDescription, 2> attachments{};
    attachments[0] = {0,
                      kColourFormat,
                      VK_SAMPLE_COUNT_1_BIT,
                      load,
                      VK_ATTACHMENT_STORE_OP_STORE,
                      VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                      VK_ATTACHMENT_STORE_OP_DONT_CARE,
                      kColour,
                      kColour};
    attachments[1] = attachments[0];
    attachments[1].format = kDepthFormat;
    attachments[1].initialLayout = attachments[1].finalLayout = kDepth;
    const VkAttachmentReference colour{0, kColour};
    const VkAttachmentReference depth{1, kDepth};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.colorAttachmentCount = 1;
    subpass.pColorAttachments = &colour;
    subpass.pDepthStencilAttachment = &depth;
    auto info = vk_struct<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
    info.attachmentCount = static_cast<uint32_t>(attachments.size());
    info.pAttachments = attachments.data();
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    VkRenderPass pass = VK_NULL_HANDLE;
    vk_check(vkCreateRenderPass(device.handle, &info, nullptr, &pass), "vkCreateRenderPass");
    return pass;
}

constexpr VkPipelineStageFlags kAttachmentStages = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                                   VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                                   VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
constexpr VkAccessFlags kColourAccess = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
constexpr VkAccessFlags kDepthAccess =
    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;

}  // namespace

Image create_image(const Device& device, VkFormat format, VkExtent2D extent, VkImageUsageFlags usage,
                   VkImageAspectFlags aspect) {
    Image image;
    auto info = vk_struct<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
    info.imageType = VK_IMAGE_TYPE_2D;
    info.format = format;
    info.extent = {extent.width, extent.height, 1};
    info.mipLevels = 1;
    info.arrayLayers = 1;
    info.samples = VK_SAMPLE_COUNT_1_BIT;
    info.usage = usage;
    vk_check(vkCreateImage(device.handle, &info, nullptr, &image.handle), "vkCreateImage");
    VkMemoryRequirements needs{};
    vkGetImageMemoryRequirements(device.handle, image.handle, &needs);
    image.bytes = needs.size;
    uint32_t type = find_memory_type(device, needs.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
    if (type == kNoMemoryType) type = find_memory_type(device, needs.memoryTypeBits, 0);
    VkMemoryAllocateInfo allocate{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size, type};
    vk_check(vkAllocateMemory(device.handle, &allocate, nullptr, &image.memory), "allocation of image memory");
    vk_check(vkBindImageMemory(device.handle, image.handle, image.memory, 0), "vkBindImageMemory");
    auto view = vk_struct<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
    view.image = image.handle;
    view.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view.format = format;
    view.subresourceRange = {aspect, 0, 1, 0, 1};
    vk_check(vkCreateImageView(device.handle, &view, nullptr, &image.view), "vkCreateImageView");
    return image;
}

void destroy_image(const Device& device, Image& image) {
    vkDestroyImageView(device.handle, image.view, nullptr);
    vkDestroyImage(device.handle, image.handle, nullptr);
    vkFreeMemory(device.handle, image.memory, nullptr);
    image = {};
}

VkImageMemoryBarrier image_barrier(const Image& image, VkImageAspectFlags aspect, VkImageLayout from, VkImageLayout to,
                                   VkAccessFlags from_access, VkAccessFlags to_access) {
    auto barrier = vk_struct<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
    barrier.srcAccessMask = from_access;
    barrier.dstAccessMask = to_access;
    barrier.oldLayout = from;
    barrier.newLayout = to;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image.handle;
    barrier.subresourceRange = {aspect, 0, 1, 0, 1};
    return barrier;
}

FrameTarget create_frame_target(const Device& device, uint32_t width, uint32_t height, uint32_t scale) {
    FrameTarget target;
    target.width = width;
    target.height = height;
    target.scale = scale;
    try {
        const VkExtent2D extent{width * scale, height * scale};
        target.colour = create_image(device, kColourFormat, extent,
                                     VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                                     VK_IMAGE_ASPECT_COLOR_BIT);
        target.depth = create_image(device, kDepthFormat, extent, VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT,
                                    VK_IMAGE_ASPECT_DEPTH_BIT);
        target.clear_pass = create_render_pass(device, VK_ATTACHMENT_LOAD_OP_CLEAR);
        target.load_pass = create_render_pass(device, VK_ATTACHMENT_LOAD_OP_LOAD);
        const VkImageView views[2] = {target.colour.view, target.depth.view};
        auto info = vk_struct<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
        info.renderPass = target.clear_pass;
        info.attachmentCount = 2;
        info.pAttachments = views;
        info.width = extent.width;
        info.height = extent.height;
        info.layers = 1;
        vk_check(vkCreateFramebuffer(device.handle, &info, nullptr, &target.framebuffer), "vkCreateFramebuffer");
        const uint64_t bytes = uint64_t{4} * width * height;
        target.readback = create_buffer(device, bytes, BufferPlace::kReadback);
        if (scale > 1) target.samples = create_buffer(device, bytes * scale * scale, BufferPlace::kDevice);
    } catch (const VulkanError&) {
        destroy_frame_target(device, target);
        throw;
    }
    return target;
}

void destroy_frame_target(const Device& device, FrameTarget& target) {
    destroy_buffer(device, target.readback);
    destroy_buffer(device, target.samples);
    vkDestroyFramebuffer(device.handle, target.framebuffer, nullptr);
    vkDestroyRenderPass(device.handle, target.clear_pass, nullptr);
    vkDestroyRenderPass(device.handle, target.load_pass, nullptr);
    destroy_image(device, target.colour);
    destroy_image(device, target.depth);
    target = {};
}

uint64_t memory_bytes(const FrameTarget& target) {
    return target.colour.bytes + target.depth.bytes + target.samples.bytes + target.readback.bytes;
}

void begin_target(VkCommandBuffer commands, const FrameTarget& target) {
    const VkImageMemoryBarrier barriers[2] = {
        image_barrier(target.colour, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                      VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL, 0, kColourAccess),
        image_barrier(target.depth, VK_IMAGE_ASPECT_DEPTH_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                      VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL, 0, kDepthAccess)};
    vkCmdPipelineBarrier(commands, kAttachmentStages | VK_PIPELINE_STAGE_TRANSFER_BIT, kAttachmentStages, 0, 0, nullptr,
                         0, nullptr, 2, barriers);
}

void begin_pass(VkCommandBuffer commands, const FrameTarget& target, VkRenderPass pass, const float clear[4]) {
    std::array<VkClearValue, 2> values{};
    for (int i = 0; i < 4; ++i) values[0].color.float32[i] = clear[i];
    values[1].depthStencil = {0.0f, 0};
    const VkExtent2D extent{target.width * target.scale, target.height * target.scale};
    auto begin = vk_struct<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
    begin.renderPass = pass;
    begin.framebuffer = target.framebuffer;
    begin.renderArea = {{0, 0}, extent};
    begin.clearValueCount = static_cast<uint32_t>(values.size());
    begin.pClearValues = values.data();
    vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    const VkViewport viewport{0, 0, static_cast<float>(extent.width), static_cast<float>(extent.height), 0, 1};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &begin.renderArea);
}

void barrier_between_passes(VkCommandBuffer commands) {
    memory_barrier(commands, kAttachmentStages, kColourAccess | kDepthAccess, kAttachmentStages,
                   kColourAccess | kDepthAccess);
}

void copy_colour(VkCommandBuffer commands, const FrameTarget& target, const Buffer& to) {
    const VkImageMemoryBarrier barrier = image_barrier(
        target.colour, VK_IMAGE_ASPECT_COLOR_BIT, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
        VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT);
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                         nullptr, 0, nullptr, 1, &barrier);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {target.width * target.scale, target.height * target.scale, 1};
    vkCmdCopyImageToBuffer(commands, target.colour.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to.handle, 1, &copy);
}

}  // namespace citystream::client
