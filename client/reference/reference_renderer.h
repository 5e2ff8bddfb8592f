// The reference renderer: the uncompressed city (a .glb made by citystream-build --reference) as plain triangles with
// EGL + OpenGL ES 3. It shares nothing with the Vulkan path but the camera, the lighting constants
// and the palette of tints.
#pragma once

#include <memory>
#include <string>

#include "client/render/frame.h"
#include "client/select/camera.h"
#include "codec/atlas/facade_tint.h"
#include "codec/result.h"

namespace citystream::client {

struct ReferenceOptions {
    uint32_t width = 1280, height = 720;
    uint32_t supersample = 1;
    std::array<float, 4> background = {-1, 0, 0, 0};  ///< sRGB 0..1; first < 0: the sky of lighting_layout.h
    codec::atlas::FacadeTint facade_tint = {};        ///< of walls; none by default
    bool lit = true;                                  ///< else surfaces show their own colours
};

class ReferenceRenderer {
  public:
    static Result<std::unique_ptr<ReferenceRenderer>> create(const std::string& glb_path,
                                                             const ReferenceOptions& options);
    virtual ~ReferenceRenderer() = default;
    virtual Result<FrameImage> draw(const Camera& camera) = 0;
    virtual double last_frame_ms() const = 0;
    virtual uint64_t triangles_drawn() const = 0;  ///< of the last frame, instances counted
    virtual uint64_t gpu_bytes() const = 0;        ///< vertex, index, instance and texture bytes
    virtual std::string device_name() const = 0;
};

}  // namespace citystream::client
