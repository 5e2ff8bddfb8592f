// The passes of a frame as Vulkan pipelines. No descriptor sets: every pass reaches its data by buffer addresses in its
// push constants.
#pragma once

#include <span>

#include "client/render/frame_target.h"

namespace citystream::client {

struct Pass {
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline handle = VK_NULL_HANDLE;
};

/// Triangles pulled from packed mesh layers; both sides are drawn. Push constants: DrawConstants.
Pass create_mesh_pass(const Device& device, VkRenderPass pass);
/// Boxes of facade placements, back faces, ray cast in the fragment shader, which writes depth. Push constants:
/// DrawConstants.
Pass create_facade_pass(const Device& device, VkRenderPass pass);
/// A compute pipeline with `constant_bytes` of push constants.
Pass create_compute_pass(const Device& device, std::span<const uint32_t> code, uint32_t constant_bytes);
void destroy_pass(const Device& device, Pass& pass);

/// Index list of the 36 corners of a facade box's 12 triangles over its 8 vertices (bit 0: along, bit 1: up, bit 2:
/// outwards).
std::span<const uint16_t> box_indices();

}  // namespace citystream::client
