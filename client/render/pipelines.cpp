#include "client/render/pipelines.h"

#include <array>
#include <cstddef>

#include "client/render/draw_layout.h"
#include "client/render/facade_shaders.h"
#include "client/render/graphics_pipeline.h"
#include "client/render/light_layout.h"
#include "shaders/facade_occluder.vert.h"
#include "shaders/facade_resolve.frag.h"
#include "shaders/facade_resolve.vert.h"
#include "shaders/mesh.frag.h"
#include "shaders/mesh.vert.h"
#include "shaders/mesh_lit.frag.h"
#include "shaders/mesh_lit.vert.h"
#include "shaders/mesh_shadow.vert.h"
#include "shaders/sky.frag.h"
#include "shaders/sky.vert.h"

namespace citystream::client {
namespace {

VkPipelineLayout create_layout(const Device& device, VkShaderStageFlags stages, uint32_t constant_bytes) {
    const VkPushConstantRange range{stages, 0, constant_bytes};
    auto info = vk_struct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
    info.pushConstantRangeCount = 1;
    info.pPushConstantRanges = &range;
    VkPipelineLayout layout = VK_NULL_HANDLE;
    vk_check(vkCreatePipelineLayout(device.handle, &info, nullptr, &layout), "vkCreatePipelineLayout");
    return layout;
}

// The specialization constants of shaders/words.glsl and shaders/draw_constants.glsl.
struct ShaderConstants {
    VkBool32 direct_layers, pages;
    uint32_t transport;
    VkBool32 alpha_test;
    float facade_tint, tints_per_metre;
    uint32_t mesh_form;
    VkBool32 sun, receivers, relief;
};
constexpr std::array<VkSpecializationMapEntry, 10> kConstantEntries = {
    {{DIRECT_LAYERS_CONSTANT, offsetof(ShaderConstants, direct_layers), sizeof(VkBool32)},
     {PAGES_CONSTANT, offsetof(ShaderConstants, pages), sizeof(VkBool32)},
     {CHART_TRANSPORT_CONSTANT, offsetof(ShaderConstants, transport), sizeof(uint32_t)},
     {ALPHA_TEST_CONSTANT, offsetof(ShaderConstants, alpha_test), sizeof(VkBool32)},
     {FACADE_TINT_CONSTANT, offsetof(ShaderConstants, facade_tint), sizeof(float)},
     {TINTS_PER_METRE_CONSTANT, offsetof(ShaderConstants, tints_per_metre), sizeof(float)},
     {MESH_FORM_CONSTANT, offsetof(ShaderConstants, mesh_form), sizeof(uint32_t)},
     {SUN_CONSTANT, offsetof(ShaderConstants, sun), sizeof(VkBool32)},
     {RECEIVERS_CONSTANT, offsetof(ShaderConstants, receivers), sizeof(VkBool32)},
     {RELIEF_LIGHT_CONSTANT, offsetof(ShaderConstants, relief), sizeof(VkBool32)}}};

ShaderConstants constants_of(const PassVariant& variant) {
    return {variant.reading == LayerReading::kDirect ? VK_TRUE : VK_FALSE,
            variant.form == codec::atlas::AtlasForm::kPages ? VK_TRUE : VK_FALSE,
            static_cast<uint32_t>(variant.transport),
            variant.alpha_test ? VK_TRUE : VK_FALSE,
            static_cast<float>(variant.tint.strength),
            static_cast<float>(1 / variant.tint.step_metres),
            variant.mesh_form,
            variant.sun ? VK_TRUE : VK_FALSE,
            variant.receivers ? VK_TRUE : VK_FALSE,
            variant.relief ? VK_TRUE : VK_FALSE};
}

// `fragment` empty: depth only.
Pass create_drawing_pass(const Device& device, VkRenderPass render_pass, std::span<const uint32_t> vertex,
                         std::span<const uint32_t> fragment, const PassVariant& variant, PassWrites writes = {},
                         uint32_t constant_bytes = sizeof(DrawConstants)) {
    Pass pass;
    const ShaderConstants values = constants_of(variant);
    const VkSpecializationInfo constants{static_cast<uint32_t>(kConstantEntries.size()), kConstantEntries.data(),
                                         sizeof values, &values};
    std::array<VkShaderModule, 2> modules{};
    const auto destroy_modules = [&] {
        for (VkShaderModule module : modules) vkDestroyShaderModule(device.handle, module, nullptr);
    };
    try {
        modules[0] = create_shader_module(device, vertex);
        if (!fragment.empty()) modules[1] = create_shader_module(device, fragment);
        const std::array<VkPipelineShaderStageCreateInfo, 2> stages = {
            shader_stage(VK_SHADER_STAGE_VERTEX_BIT, modules[0], &constants),
            shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, modules[1], &constants)};
        pass.layout = create_layout(device, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, constant_bytes);
        pass.handle = create_graphics_pipeline(device, render_pass, pass.layout,
                                               std::span(stages).first(fragment.empty() ? 1 : 2), writes);
    } catch (const VulkanError&) {
        destroy_modules();
        destroy_pass(device, pass);
        throw;
    }
    destroy_modules();
    return pass;
}

// Three quads of four vertices.
constexpr std::array<uint16_t, kFacadeIndices> kQuadIndices = {0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7, 8, 9, 10, 10, 9, 11};

}  // namespace

Pass create_mesh_pass(const Device& device, VkRenderPass render_pass, const PassVariant& variant) {
    if (variant.lit) return create_drawing_pass(device, render_pass, k_mesh_lit_vert, k_mesh_lit_frag, variant);
    return create_drawing_pass(device, render_pass, k_mesh_vert, k_mesh_frag, variant);
}

Pass create_mesh_shadow_pass(const Device& device, VkRenderPass render_pass, const PassVariant& variant) {
    return create_drawing_pass(device, render_pass, k_mesh_shadow_vert, {}, variant, {.colour = false});
}

Pass create_sky_pass(const Device& device, VkRenderPass render_pass) {
    return create_drawing_pass(device, render_pass, k_sky_vert, k_sky_frag, {}, {.depth = false, .over_nothing = true},
                               sizeof(SkyConstants));
}

std::span<const uint16_t> facade_indices() {
    return kQuadIndices;
}

Pass create_facade_pass(const Device& device, VkRenderPass render_pass, uint32_t caster, bool keyed,
                        const PassVariant& variant) {
    const FacadeShaders shaders = facade_shaders(caster, variant.lit);
    if (!keyed) return create_drawing_pass(device, render_pass, shaders.vertex, shaders.fragment, variant);
    return create_drawing_pass(device, render_pass, shaders.vertex, shaders.keyed_fragment, variant, {false, false});
}

Pass create_facade_occluder_pass(const Device& device, VkRenderPass render_pass, const PassVariant& variant) {
    return create_drawing_pass(device, render_pass, k_facade_occluder_vert, {}, variant, {false, true});
}

Pass create_facade_resolve_pass(const Device& device, VkRenderPass render_pass) {
    return create_drawing_pass(device, render_pass, k_facade_resolve_vert, k_facade_resolve_frag, {}, {},
                               sizeof(FacadeTableHead));
}

Pass create_compute_pass(const Device& device, std::span<const uint32_t> code, uint32_t constant_bytes,
                         const VkSpecializationInfo* constants, bool full_subgroups) {
    Pass pass;
    VkShaderModule module = create_shader_module(device, code);
    auto info = vk_struct<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
    info.stage = shader_stage(VK_SHADER_STAGE_COMPUTE_BIT, module, constants);
    if (full_subgroups) info.stage.flags = VK_PIPELINE_SHADER_STAGE_CREATE_REQUIRE_FULL_SUBGROUPS_BIT;
    VkResult result = VK_SUCCESS;
    try {
        pass.layout = create_layout(device, VK_SHADER_STAGE_COMPUTE_BIT, constant_bytes);
        info.layout = pass.layout;
        result = vkCreateComputePipelines(device.handle, VK_NULL_HANDLE, 1, &info, nullptr, &pass.handle);
        vk_check(result, "vkCreateComputePipelines");
    } catch (const VulkanError&) {
        vkDestroyShaderModule(device.handle, module, nullptr);
        destroy_pass(device, pass);
        throw;
    }
    vkDestroyShaderModule(device.handle, module, nullptr);
    return pass;
}

void destroy_pass(const Device& device, Pass& pass) {
    vkDestroyPipeline(device.handle, pass.handle, nullptr);
    vkDestroyPipelineLayout(device.handle, pass.layout, nullptr);
    pass = {};
}

}  // namespace citystream::client
