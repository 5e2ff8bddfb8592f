#include "client/render/frame_passes.h"

#include <algorithm>
#include <cstring>

namespace citystream::client {
namespace {

void split(VkDeviceAddress address, uint32_t out[2]) {
    out[0] = static_cast<uint32_t>(address);
    out[1] = static_cast<uint32_t>(address >> 32);
}

/// Zeros for a pass to draw from: a tile without vertices or atlas, of which every corner falls on one point.
constexpr uint64_t kZeroWords = 1024;

/// Constants of such a tile, whose tables are in the zeros.
TileConstants nothing_to_draw(const Buffer& zeros) {
    std::memset(zeros.mapped, 0, kZeroWords * 4);
    TileConstants tile{};
    for (uint32_t* reference : {tile.mesh, tile.atlas, tile.facade, tile.shared_charts})
        split(zeros.address | LAYER_REF_DIRECT, reference);
    // No corner is beyond the zeros.
    constexpr uint64_t kDraw = kZeroWords / 4 * 3 * 4;
    LitMeshDraw draw{};
    split(zeros.address, draw.draw.corners);
    split(zeros.address, draw.radiance.light);
    std::memcpy(static_cast<std::byte*>(zeros.mapped) + kDraw, &draw, sizeof draw);
    split(zeros.address + kDraw, tile.mesh_draw);
    // One placement, of which the tile has no map.
    constexpr uint64_t kTable = kZeroWords / 2 * 4;
    FacadeTableHead head{};
    split(zeros.address, head.map_of_placement);
    std::memcpy(static_cast<std::byte*>(zeros.mapped) + kTable, &head, sizeof head);
    split(zeros.address + kTable, tile.facade_maps);
    return tile;
}

}  // namespace

FramePasses::~FramePasses() {
    destroy_pass(device_, resolve_);
    const auto destroy_all = [&](Passes& passes) {
        for (auto& [variant, pass] : passes) destroy_pass(device_, pass);
    };
    destroy_all(mesh_);
    destroy_all(occluder_);
    destroy_all(shadow_);
    std::ranges::for_each(facades_, destroy_all);
    destroy_buffer(device_, facade_indices_);
    destroy_buffer(device_, keys_);
}

void FramePasses::ensure_mesh(const PassVariant& variant) {
    if (mesh_.contains(variant)) return;
    const Pass pass = mesh_[variant] = create_mesh_pass(device_, target_.clear_pass, variant);
    warm_up(pass, 3);
}

void FramePasses::ensure_facades(const DrawnTile& drawn) {
    if (!has_facades()) {
        const std::span<const uint16_t> indices = client::facade_indices();
        facade_indices_ = create_buffer(device_, indices.size_bytes(), BufferPlace::kUpload);
        std::memcpy(facade_indices_.mapped, indices.data(), indices.size_bytes());
        if (keyed_) {
            resolve_ = create_facade_resolve_pass(device_, target_.load_pass);
            keys_ = create_buffer(device_, uint64_t{8} * target_.width * target_.height * target_.scale * target_.scale,
                                  BufferPlace::kDevice);
        }
    }
    if (!occluder_.contains(drawn.occluder()))
        occluder_[drawn.occluder()] = create_facade_occluder_pass(device_, target_.clear_pass, drawn.occluder());
    for (uint32_t caster = 0; caster < FACADE_RENDERER_COUNT; ++caster) {
        if ((drawn.casters >> caster & 1) == 0 || facades_[caster].contains(drawn.facade())) continue;
        const Pass pass = facades_[caster][drawn.facade()] =
            create_facade_pass(device_, target_.load_pass, caster, keyed_, drawn.facade());
        warm_up(pass, kFacadeIndices);
    }
}

bool FramePasses::ensure(const DrawnFrame& frame, const MeshDraws& draws, const ShadowMaps* maps) {
    const VkDeviceAddress keys = keys_.address;
    for (const DrawnTile& drawn : frame.tiles) {
        for (uint32_t range = 0; range < drawn.tile->mesh_ranges.size(); ++range) {
            const PassVariant variant = drawn.mesh_of(draws.of(drawn.tile->mesh, range));
            if (frame.kind != FrameKind::kShadow) {
                ensure_mesh(variant);
            } else if (!shadow_.contains(variant)) {
                shadow_[variant] = create_mesh_shadow_pass(device_, maps->render_pass(), variant);
            }
        }
        if (drawn.casters != 0) ensure_facades(drawn);
    }
    return keys_.address != keys;
}

// Draws one invisible primitive, so that drivers which compile at the first draw do it now and not in a measured frame.
void FramePasses::warm_up(const Pass& pass, uint32_t vertices) const {
    Buffer zeros = create_buffer(device_, kZeroWords * 4, BufferPlace::kUpload);
    const DrawConstants constants{{}, nothing_to_draw(zeros)};
    constexpr std::array<float, 4> kClear{};
    const auto record = [&](VkCommandBuffer commands) {
        begin_target(commands, target_);
        begin_pass(commands, target_, target_.clear_pass, kClear.data());
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.handle);
        vkCmdPushConstants(commands, pass.layout, VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT, 0,
                           sizeof constants, &constants);
        if (vertices == kFacadeIndices) {
            vkCmdBindIndexBuffer(commands, facade_indices_.handle, 0, VK_INDEX_TYPE_UINT16);
            vkCmdDrawIndexed(commands, vertices, 1, 0, 0, 0);
        } else {
            vkCmdDraw(commands, vertices, 1, 0, 0);
        }
        vkCmdEndRenderPass(commands);
    };
    try {
        submit_and_wait(device_, record);
    } catch (const VulkanError&) {
        destroy_buffer(device_, zeros);
        throw;
    }
    destroy_buffer(device_, zeros);
}

}  // namespace citystream::client
