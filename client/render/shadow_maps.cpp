#include "client/render/shadow_maps.h"

namespace citystream::client {
namespace {

constexpr VkImageLayout kDepthLayout = VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
constexpr VkPipelineStageFlags kDepthStages =
    VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
constexpr VkAccessFlags kDepthAccess =
    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;

VkRenderPass create_depth_pass(const Device& device, VkAttachmentLoadOp load) {
    VkAttachmentDescription depth{};
    depth.format = kDepthFormat;
    depth.samples = VK_SAMPLE_COUNT_1_BIT;
    depth.loadOp = load;
    depth.storeOp = VK_ATTACHMENT_STORE_OP_STORE;
    depth.stencilLoadOp = VK_ATTACHMENT_LOAD_OP_DONT_CARE;
    depth.stencilStoreOp = VK_ATTACHMENT_STORE_OP_DONT_CARE;
    depth.initialLayout = depth.finalLayout = kDepthLayout;
    const VkAttachmentReference reference{0, kDepthLayout};
    VkSubpassDescription subpass{};
    subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
    subpass.pDepthStencilAttachment = &reference;
    auto info = vk_struct<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
    info.attachmentCount = 1;
    info.pAttachments = &depth;
    info.subpassCount = 1;
    info.pSubpasses = &subpass;
    VkRenderPass pass = VK_NULL_HANDLE;
    vk_check(vkCreateRenderPass(device.handle, &info, nullptr, &pass), "vkCreateRenderPass");
    return pass;
}

}  // namespace

ShadowMaps::ShadowMaps(const Device& device, uint32_t side) : device_(device), side_(side) {
    try {
        image_ = create_image(device, kDepthFormat, {side, side},
                              VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
                              VK_IMAGE_ASPECT_DEPTH_BIT);
        clear_pass_ = create_depth_pass(device, VK_ATTACHMENT_LOAD_OP_CLEAR);
        load_pass_ = create_depth_pass(device, VK_ATTACHMENT_LOAD_OP_LOAD);
        auto info = vk_struct<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
        info.renderPass = clear_pass_;
        info.attachmentCount = 1;
        info.pAttachments = &image_.view;
        info.width = info.height = side;
        info.layers = 1;
        vk_check(vkCreateFramebuffer(device.handle, &info, nullptr, &framebuffer_), "vkCreateFramebuffer");
        depths_ = create_buffer(device, SHADOW_CASCADES * cascade_bytes(), BufferPlace::kDevice);
    } catch (const VulkanError&) {
        destroy();
        throw;
    }
}

ShadowMaps::~ShadowMaps() {
    destroy();
}

void ShadowMaps::destroy() {
    destroy_buffer(device_, depths_);
    vkDestroyFramebuffer(device_.handle, framebuffer_, nullptr);
    vkDestroyRenderPass(device_.handle, clear_pass_, nullptr);
    vkDestroyRenderPass(device_.handle, load_pass_, nullptr);
    destroy_image(device_, image_);
}

void ShadowMaps::begin_pass(VkCommandBuffer commands, bool begins) const {
    const VkImageMemoryBarrier barrier =
        image_barrier(image_, VK_IMAGE_ASPECT_DEPTH_BIT, begins ? VK_IMAGE_LAYOUT_UNDEFINED : kDepthLayout,
                      kDepthLayout, begins ? 0 : kDepthAccess, kDepthAccess);
    vkCmdPipelineBarrier(commands, kDepthStages | VK_PIPELINE_STAGE_TRANSFER_BIT, kDepthStages, 0, 0, nullptr, 0,
                         nullptr, 1, &barrier);
    VkClearValue clear{};  // farthest from the sun
    auto begin = vk_struct<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
    begin.renderPass = begins ? clear_pass_ : load_pass_;
    begin.framebuffer = framebuffer_;
    begin.renderArea = {{0, 0}, {side_, side_}};
    begin.clearValueCount = 1;
    begin.pClearValues = &clear;
    vkCmdBeginRenderPass(commands, &begin, VK_SUBPASS_CONTENTS_INLINE);
    const VkViewport viewport{0, 0, static_cast<float>(side_), static_cast<float>(side_), 0, 1};
    vkCmdSetViewport(commands, 0, 1, &viewport);
    vkCmdSetScissor(commands, 0, 1, &begin.renderArea);
}

void ShadowMaps::keep(VkCommandBuffer commands, uint32_t cascade) const {
    const VkImageMemoryBarrier barrier =
        image_barrier(image_, VK_IMAGE_ASPECT_DEPTH_BIT, kDepthLayout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                      VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT, VK_ACCESS_TRANSFER_READ_BIT);
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0,
                         nullptr, 0, nullptr, 1, &barrier);
    VkBufferImageCopy copy{};
    copy.bufferOffset = cascade * cascade_bytes();
    copy.imageSubresource = {VK_IMAGE_ASPECT_DEPTH_BIT, 0, 0, 1};
    copy.imageExtent = {side_, side_, 1};
    vkCmdCopyImageToBuffer(commands, image_.handle, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, depths_.handle, 1, &copy);
    memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                   VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
}

}  // namespace citystream::client
