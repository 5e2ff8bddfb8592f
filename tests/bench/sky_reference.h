// What lit pictures are measured against: a city's triangles under an environment map, by rays from every pixel, and
// from what each of them meets over the hemisphere above it (Embree). Matt surfaces, light from far away, no light from
// surface to surface, as the radiance layer has it; nothing of its receivers, directions and matrices.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "client/light/environment_map.h"
#include "client/reference/glb_scene.h"
#include "client/render/frame.h"
#include "client/select/camera.h"
#include "codec/result.h"

namespace citystream::bench {

struct ReferenceTriangle {
    std::array<client::Direction, 3> corners{};  ///< metres from the scene's origin
    client::Rgb albedo{1, 1, 1};                 ///< linear
};

/// The scene's triangles, all of one albedo; instances spelled out.
std::vector<ReferenceTriangle> reference_triangles(const client::GlbScene& scene, const client::Rgb& albedo);

struct SkyRays {
    uint32_t across = 32;       ///< across^2 rays over a hemisphere, one in each of as many equal parts of its cosine
    uint32_t pixel_across = 1;  ///< pixel_across^2 places in a pixel, each with rays of its own
    uint32_t jobs = 0;          ///< threads; 0: one a core. Pictures do not depend on it
};

/// Linear, before exposure; top row first.
struct RadiancePicture {
    uint32_t width = 0, height = 0;
    std::vector<client::Rgb> pixels;
    std::vector<uint8_t> surface;  ///< 1: all of the pixel's places meet one
};

/// Unit vector `ray` of across^2 about a unit normal, as often in a direction as its cosine is great: a jittered place
/// in a cell of a square, mapped to the disc (Shirley and Chiu 1997) and up to the hemisphere (Malley). The jitter
/// follows from `seed`.
client::Direction cosine_direction(const client::Direction& normal, uint32_t ray, uint32_t across, uint64_t seed);

class SkyReference {
  public:
    /// `origin`: absolute metres. Triangles may be up to about 16 km from it. Error: Embree's.
    static Result<SkyReference> create(std::span<const ReferenceTriangle> triangles,
                                       const std::array<double, 3>& origin);
    ~SkyReference();
    SkyReference(SkyReference&&) noexcept;
    SkyReference& operator=(SkyReference&&) noexcept;

    /// Light of the environment that arrives at a point of a surface (metres from the origin) from above it. Rays start
    /// kRayLift above it, without end.
    client::LightSum irradiance(const client::Direction& point, const client::Direction& normal,
                                const client::EnvironmentMap& environment, uint32_t across, uint64_t seed) const;

    /// Surfaces show albedo / pi times the irradiance on the side that is looked at; where nothing is met, the
    /// environment. Deterministic. O(pixels pixel_across^2 across^2).
    RadiancePicture draw(const client::Camera& camera, const client::EnvironmentMap& environment,
                         const SkyRays& rays) const;

  private:
    struct State;
    explicit SkyReference(std::unique_ptr<State> state);
    struct Pixel {
        client::LightSum radiance{};
        bool surface = true;
    };
    Pixel pixel(const client::Camera& camera, const client::EnvironmentMap& environment, const SkyRays& rays,
                uint32_t x, uint32_t y) const;
    std::unique_ptr<State> state_;
};

inline constexpr double kRayLift = 1e-3;  ///< metres

/// As lit frames are shown (client/render/tone.h).
client::FrameImage shown_picture(const RadiancePicture& picture, double exposure);

}  // namespace citystream::bench
