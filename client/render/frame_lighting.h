// What frames with a light take besides the others: the light's record and the environment's map, the passes that bring
// the light to the tiles' receivers (radiance_passes.h), the sky, and the sun's shadow maps. Made when the first such
// frame is drawn. Errors: VulkanError, or Result where said. Not thread safe; nothing may be in flight but where
// `record` says so.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "client/render/frame.h"
#include "client/render/frame_light.h"
#include "client/render/pipelines.h"
#include "client/render/radiance_passes.h"
#include "client/render/shadow_cascades.h"
#include "client/render/shadow_maps.h"

namespace citystream::client {

class FrameLighting {
  public:
    /// Both outlive it. `pass`: that the sky is drawn in; `shadow_side`: texels of a shadow map.
    FrameLighting(const Device& device, SlotPool& pool, VkRenderPass pass, uint32_t shadow_side);
    ~FrameLighting();
    FrameLighting(const FrameLighting&) = delete;
    FrameLighting& operator=(const FrameLighting&) = delete;

    /// For frames from here on. What did not change since the light before is not brought to the device again.
    /// Precondition: check_light.
    void set_light(const FrameLight& light);
    /// Before a layer is destroyed.
    void forget(LayerId layer) { passes_.forget(layer); }

    /// One that lights surfaces: light_constants.h.
    bool has_sun() const;

    /// A frame: plan what its tiles miss; have the cascades drawn, if there are any, into shadow_maps(); record.
    /// `relief`: tiles with facades have local light, too.
    Status plan(const Camera& camera, std::span<const TileDraw> tiles, bool relief = false);
    /// Of a tile of the frame planned last: see RadiancePasses.
    LayerId local_light(LayerId radiance) const { return passes_.local_light(radiance); }
    uint32_t local_receivers(LayerId radiance) const { return passes_.local_receivers(radiance); }
    void make_room(uint64_t slots) { passes_.make_room(slots); }
    uint64_t local_slots() const { return passes_.local_slots(); }
    /// None without a sun above the horizon.
    std::span<const CascadeView> cascades() const { return {cascades_.data(), constants_.cascades}; }
    /// Where there are cascades.
    const ShadowMaps& shadow_maps() const { return *shadows_; }
    /// Before the render pass.
    void record_light(VkCommandBuffer commands) { passes_.record(commands); }
    /// In the render pass, after all else. `height`: of the picture, in samples.
    void record_sky(VkCommandBuffer commands, const FrameConstants& frame, uint32_t height) const;
    void finish() { passes_.finish(); }

    VkDeviceAddress address() const { return record_.address; }  ///< of the frame's LightConstants
    uint64_t bytes() const;
    /// What the light passes did for the frame planned last.
    const RadianceCounts& counts() const { return passes_.counts(); }

  private:
    void set_map(const EnvironmentMap& map);

    const Device& device_;
    uint32_t shadow_side_;
    RadiancePasses passes_;
    Pass sky_;
    Buffer record_, map_;
    std::optional<ShadowMaps> shadows_;  ///< made for the first sun
    std::optional<uint64_t> number_;     ///< of the light that was set
    float map_scale_ = 1;
    LightConstants constants_{};
    std::optional<Sun> sun_;
    std::array<CascadeView, SHADOW_CASCADES> cascades_{};
    std::vector<LayerId> layers_, with_local_;  ///< of the frame
};

}  // namespace citystream::client
