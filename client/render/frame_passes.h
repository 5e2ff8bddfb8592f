// The pipelines of frames, each made when the first frame draws something that needs it, and what facades draw with:
// their indices and the key buffer. Nothing may be in flight when passes are made. Errors: VulkanError.
#pragma once

#include <array>
#include <map>

#include "client/render/drawn_frame.h"
#include "client/render/facade_renderer_layout.h"
#include "client/render/mesh_draws.h"
#include "client/render/shadow_maps.h"

namespace citystream::client {

class FramePasses {
  public:
    /// Both outlive it. `keyed`: facades put their hits into keys (facade.frag.glsl). Nothing is made yet.
    FramePasses(const Device& device, const FrameTarget& target, bool keyed)
        : device_(device), target_(target), keyed_(keyed) {}
    ~FramePasses();
    FramePasses(const FramePasses&) = delete;
    FramePasses& operator=(const FramePasses&) = delete;

    /// Makes what the frame misses. `maps`: where its kind is kShadow. True: the key buffer was made, which the frame's
    /// tables do not name.
    bool ensure(const DrawnFrame& frame, const MeshDraws& draws, const ShadowMaps* maps);
    void ensure_mesh(const PassVariant& variant);

    /// Precondition: ensured.
    const Pass& mesh(FrameKind kind, const PassVariant& variant) const {
        return (kind == FrameKind::kShadow ? shadow_ : mesh_).at(variant);
    }
    const Pass& occluder(const PassVariant& variant) const { return occluder_.at(variant); }
    const Pass& facade(uint32_t caster, const PassVariant& variant) const { return facades_[caster].at(variant); }
    const Pass& resolve() const { return resolve_; }
    VkBuffer facade_indices() const { return facade_indices_.handle; }
    const Buffer& keys() const { return keys_; }

    bool is_keyed() const { return keyed_; }
    bool has_facades() const { return facade_indices_.handle != VK_NULL_HANDLE; }
    uint64_t bytes() const { return facade_indices_.bytes + keys_.bytes; }

  private:
    using Passes = std::map<PassVariant, Pass>;

    void ensure_facades(const DrawnTile& drawn);
    void warm_up(const Pass& pass, uint32_t vertices) const;

    const Device& device_;
    const FrameTarget& target_;
    bool keyed_;
    Pass resolve_;
    Passes mesh_, occluder_, shadow_;
    std::array<Passes, FACADE_RENDERER_COUNT> facades_;  ///< by caster
    Buffer facade_indices_;
    Buffer keys_;  ///< of the keyed facade pass
};

}  // namespace citystream::client
