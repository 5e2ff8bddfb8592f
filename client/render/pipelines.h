// The passes of a frame as Vulkan pipelines. No descriptor sets: every pass reaches its data by buffer addresses in its
// push constants.
#pragma once

#include <compare>
#include <span>

#include "client/render/chart_transport.h"
#include "client/render/frame_target.h"
#include "codec/atlas/atlas_form.h"
#include "codec/atlas/facade_tint.h"

namespace citystream::client {

struct Pass {
    VkPipelineLayout layout = VK_NULL_HANDLE;
    VkPipeline handle = VK_NULL_HANDLE;
};

/// How a pipeline's shaders read layers: any, each by a branch, or without one such as lie in one piece (all layers
/// that a draw names must; same results).
enum class LayerReading { kPaged, kDirect };

/// What a pipeline's shaders are specialized for; the tiles that it draws must be of that kind.
struct PassVariant {
    LayerReading reading = LayerReading::kPaged;
    codec::atlas::AtlasForm form = codec::atlas::AtlasForm::kCharts;
    ChartTransport transport = ChartTransport::kTable;  ///< of the mesh pass where the form is kPages
    bool alpha_test = false;                            ///< of the mesh pass
    codec::atlas::FacadeTint tint = {};
    uint32_t mesh_form = MESH_FORM_ANY;  ///< of the ranges: RESIDENT_KIND_* | RESIDENT_FLAG_* << 8
    bool lit = false;                    ///< by the frame's light: of the mesh and the facade pass
    bool sun = false;                    ///< where lit: the light has one
    bool receivers = false;              ///< where lit: the tile has a radiance layer
    bool relief = false;                 ///< of the facade pass, where lit: walls have local light (relief_light.h)
    auto operator<=>(const PassVariant&) const = default;
};

/// Triangles pulled from packed mesh layers; both sides are drawn. Push constants: DrawConstants.
Pass create_mesh_pass(const Device& device, VkRenderPass pass, const PassVariant& variant);
/// Quads of facade placements (indices: facade_indices), ray cast in the fragment shader by a caster of
/// facade_renderer_layout.h. `keyed`: the hits go to the key buffer of FacadeTableHead, depth is tested before and not
/// written. Push constants: DrawConstants.
Pass create_facade_pass(const Device& device, VkRenderPass pass, uint32_t caster, bool keyed,
                        const PassVariant& variant);
/// Depth of the same triangles as the sun sees them. Push constants: DrawConstants, its frame that of
/// shadow_cascades.h.
Pass create_mesh_shadow_pass(const Device& device, VkRenderPass pass, const PassVariant& variant);
/// The environment where nothing is drawn: one triangle. Push constants: SkyConstants.
Pass create_sky_pass(const Device& device, VkRenderPass pass);
/// Depth of opaque placements' backs (the first kOccluderIndices indices). Push constants: DrawConstants.
Pass create_facade_occluder_pass(const Device& device, VkRenderPass pass, const PassVariant& variant);
/// One triangle that draws the key buffer. Push constants: FacadeTableHead.
Pass create_facade_resolve_pass(const Device& device, VkRenderPass pass);
constexpr uint32_t kFacadeIndices = 18, kOccluderIndices = 6;
std::span<const uint16_t> facade_indices();
/// A compute pipeline with `constant_bytes` of push constants. `full_subgroups`: the device's shuffle_lanes is not 0
/// and divides the workgroup.
Pass create_compute_pass(const Device& device, std::span<const uint32_t> code, uint32_t constant_bytes,
                         const VkSpecializationInfo* constants = nullptr, bool full_subgroups = false);
void destroy_pass(const Device& device, Pass& pass);

}  // namespace citystream::client
