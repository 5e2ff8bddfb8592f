// What frames under an environment are compared with: the uncompressed city (a .glb made by citystream-build
// --reference) under the same sky and sun, by rays (client/reference/sky_reference.h). Colours of surfaces are those
// that the reference renderer shows; places that are looked at are the same as the renderer's, so that what differs is
// the light.
#pragma once

#include <memory>
#include <string>

#include "client/light/environment_light.h"
#include "client/path/camera_path.h"
#include "client/render/frame.h"
#include "client/render/frame_light.h"
#include "codec/result.h"

namespace citystream::client {

struct LitReferenceOptions {
    uint32_t width = 1280, height = 720;
    uint32_t supersample = 1;  ///< places in a pixel, in x and in y
    uint32_t rays = 256;       ///< of a pixel, over the hemispheres above what its places meet; at least that many
};

/// Whether this build can draw them: it has Embree.
bool lit_references_can_be_drawn();

class LitReference {
  public:
    /// Error: a file that is no city, no Embree, no OpenGL ES.
    static Result<std::unique_ptr<LitReference>> create(const std::string& glb, const LitReferenceOptions& options);
    virtual ~LitReference() = default;
    /// `moment` lights it; `shown`, made of it, has the background and the exposure. A sun that is left in the map is
    /// taken out of it here: rays would meet it too seldom. O(pixels rays), on all cores.
    virtual Result<FrameImage> draw(const CameraSample& sample, const LightMoment& moment, const FrameLight& shown) = 0;
    virtual uint64_t triangles() const = 0;     ///< instances counted
    virtual uint32_t rays_a_pixel() const = 0;  ///< those to the sun are beside them
};

}  // namespace citystream::client
