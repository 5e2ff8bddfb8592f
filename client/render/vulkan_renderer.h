// The Vulkan renderer: packed layers in fixed-size slots of GPU memory, decoded in the shaders, drawn front to back
// with reversed z, headless.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/cache/layer_store.h"
#include "client/render/chart_transport.h"
#include "client/render/facade_renderer.h"
#include "client/render/frame.h"
#include "client/render/frame_light.h"
#include "client/select/camera.h"
#include "codec/atlas/facade_tint.h"
#include "codec/result.h"

namespace citystream::client {

struct RendererOptions {
    uint32_t width = 1280, height = 720;
    uint64_t gpu_budget_bytes = 512ull << 20;  ///< of layer slots; frame buffers are counted apart and reported
    std::string device;        ///< part of a device name or an index; empty: the one that matches the EGL device
    uint32_t supersample = 1;  ///< 1 or 2: box filter over n x n samples a pixel
    FacadeRenderer facade_renderer = FacadeRenderer::kPatch;  ///< all maps must be in a form that it draws
    /// One of kFacadeSampleCounts: rays of a pixel that covers more than the finest parts of its facade.
    uint32_t facade_samples = kFacadeSamples;
    /// Facade hits as 64-bit keys instead of depth writes (facade.frag.glsl); empty: where the device is faster so.
    std::optional<bool> keyed_facades;
    /// How charts in pages come to the vertex shader. Coordinates of kAttribute and kPacked take room that
    /// layers leave in the budget (FrameCounts).
    ChartTransport chart_transport = ChartTransport::kTable;
    /// Memory for decoded strip code (strip_arena.h), taken when the first is drawn, beside gpu_budget_bytes. Frames
    /// that need more are drawn in rounds; one range at least must fit.
    uint64_t index_arena_bytes = 64ull << 20;
    codec::atlas::FacadeTint facade_tint;  ///< of walls; none by default
    /// Texels of each of the sun's shadow maps, where a light has a sun: 64..8192. Empty: shadow_side of the frame.
    std::optional<uint32_t> shadow_side;
    /// In frames with a light relief shades itself: by masks, further away by BTFs (relief_light.h), where a tile's
    /// walls can have local light (codec/radiance/local_light.h). Masks and local light take room that layers leave in
    /// the budget; BTFs have one of their own, taken when the first is made.
    bool meso = false;
    uint64_t btf_budget_bytes = 64ull << 20;
    uint32_t btf_texels = 16;  ///< of a BTF across: 4, 8, 16, 32 or 64; memory and time to make it grow as their square
    /// Rays that a frame may cast to make masks, and as many for BTFs; 0: all that it needs. What is not made yet is
    /// drawn as without.
    uint64_t relief_rays = 0;
    bool validation = false;  ///< Khronos validation with synchronization validation; messages are counted
    std::array<float, 4> background = {-1, 0, 0, 0};  ///< sRGB 0..1; first < 0: the sky of lighting_layout.h
};

/// Memory for layers is taken in chunks up to the budget, never beyond. All calls from one thread.
class VulkanRenderer : public LayerStore {
  public:
    using LayerStore::create;
    static Result<std::unique_ptr<VulkanRenderer>> create(const RendererOptions& options);
    /// Draws the tiles (the renderer sorts them front to back) and reads the frame back.
    virtual Result<FrameImage> draw(const Camera& camera, std::span<const TileDraw> tiles, FrameTimings* timings) = 0;
    /// Of frames from here on, until it is set again; copied. Null: none, frames are lit by lighting_layout.h. Fails
    /// for a light of which a value is negative or not finite, or whose parts are missing.
    virtual Status set_light(const FrameLight* light) = 0;
    /// Tiles besides those of the next frame, and for that one alone, that cast shadows where a light has a sun: those
    /// out of view that stand towards it. Of them meshes are taken, as draw() takes them.
    virtual void set_casters(std::span<const TileDraw> casters) = 0;
    virtual std::string device_name() const = 0;  ///< with driver name and version
    virtual FrameCounts counts() const = 0;       ///< of the last frame
    virtual uint64_t frame_buffer_bytes() const = 0;
    virtual uint64_t gpu_bytes_allocated() const = 0;  ///< chunks of slots really allocated
    virtual uint64_t validation_messages() const = 0;
    /// The facade renderer's pipeline is made when the first tile with relief is drawn (a scene without relief makes
    /// none).
    virtual bool has_facade_pipeline() const = 0;
    /// What frames with light need is made when the first one is drawn (scenes without make none).
    virtual bool has_radiance_pipeline() const = 0;
};

/// Lists devices: one line each, EGL devices and the Vulkan device that matches.
std::vector<std::string> list_devices();

}  // namespace citystream::client
