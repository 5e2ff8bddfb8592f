#include "client/render/frame_lighting.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "client/render/drawn_frame.h"
#include "client/render/light_constants.h"
#include "client/render/map_texels.h"

namespace citystream::client {
namespace {

void split(VkDeviceAddress address, uint32_t out[2]) {
    out[0] = static_cast<uint32_t>(address);
    out[1] = static_cast<uint32_t>(address >> 32);
}

constexpr VkShaderStageFlags kDrawStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

}  // namespace

FrameLighting::FrameLighting(const Device& device, SlotPool& pool, VkRenderPass pass, uint32_t shadow_side)
    : device_(device), shadow_side_(shadow_side), passes_(device, pool) {
    record_ = create_buffer(device, sizeof(LightConstants), BufferPlace::kUpload);
    try {
        sky_ = create_sky_pass(device, pass);
    } catch (const VulkanError&) {
        destroy_buffer(device, record_);
        throw;
    }
}

FrameLighting::~FrameLighting() {
    destroy_pass(device_, sky_);
    destroy_buffer(device_, record_);
    destroy_buffer(device_, map_);
}

uint64_t FrameLighting::bytes() const {
    return record_.bytes + map_.bytes + passes_.buffer_bytes() + (shadows_ ? shadows_->bytes() : 0);
}

void FrameLighting::set_map(const EnvironmentMap& map) {
    const MapTexels texels = map_texels(map);
    const uint64_t bytes = texels.words.size() * 4;
    if (map_.bytes != bytes) {
        destroy_buffer(device_, map_);
        map_ = create_buffer(device_, bytes, BufferPlace::kUpload);
    }
    std::memcpy(map_.mapped, texels.words.data(), bytes);
    map_scale_ = texels.scale;
}

void FrameLighting::set_light(const FrameLight& light) {
    passes_.set_light(light);
    if (number_ != light.number) set_map(light.background);
    number_ = light.number;
    sun_ = light.sun;
    constants_ = light_constants(light, passes_.irradiance_unit(), map_scale_);
    split(map_.address, constants_.map);
}

bool FrameLighting::has_sun() const {
    return sun_ && lights_surfaces(*sun_);
}

Status FrameLighting::plan(const Camera& camera, std::span<const TileDraw> tiles, bool relief) {
    layers_.clear();
    with_local_.clear();
    for (const TileDraw& tile : tiles) {
        if (tile.radiance == kNoLayer) continue;
        layers_.push_back(tile.radiance);
        if (relief && has_facades(tile)) with_local_.push_back(tile.radiance);
    }
    std::sort(layers_.begin(), layers_.end());
    layers_.erase(std::unique(layers_.begin(), layers_.end()), layers_.end());
    if (const Status status = passes_.plan(layers_, with_local_); !status) return status.error();
    const bool is_up = has_sun();
    constants_.cascades = is_up ? SHADOW_CASCADES : 0;
    if (is_up) {
        if (!shadows_) shadows_.emplace(device_, shadow_side_);
        constants_.shadow_side = shadow_side_;
        cascades_ = shadow_cascades(camera, sun_->direction, shadow_side_);
        const CameraCell cell = camera_cell(camera.position);
        for (uint32_t i = 0; i < SHADOW_CASCADES; ++i) {
            constants_.cascade[i] = shadow_lookup(cascades_[i], cell, shadow_side_);
            split(shadows_->depths(i), constants_.cascade[i].depths);
        }
    }
    std::memcpy(record_.mapped, &constants_, sizeof constants_);
    return Done{};
}

void FrameLighting::record_sky(VkCommandBuffer commands, const FrameConstants& frame, uint32_t height) const {
    SkyConstants constants{};
    std::memcpy(constants.clip_x, frame.clip_x, sizeof constants.clip_x);
    std::memcpy(constants.clip_y, frame.clip_y, sizeof constants.clip_y);
    std::memcpy(constants.clip_w, frame.clip_w, sizeof constants.clip_w);
    constants.pixel = 2 / (std::hypot(frame.clip_y[0], frame.clip_y[1], frame.clip_y[2]) * static_cast<float>(height));
    split(record_.address, constants.light);
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, sky_.handle);
    vkCmdPushConstants(commands, sky_.layout, kDrawStages, 0, sizeof constants, &constants);
    vkCmdDraw(commands, 3, 1, 0, 0);
}

}  // namespace citystream::client
