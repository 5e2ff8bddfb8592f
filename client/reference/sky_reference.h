// What lit pictures are measured against: a city's triangles under an environment map and a sun, by rays from every
// pixel, and from what each of them meets over the hemisphere above it (Embree). Matt surfaces, light from far away, no
// light from surface to surface, as the radiance layer has it; nothing of its receivers, directions and matrices, nor
// of shadow maps.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "client/light/environment_map.h"
#include "client/light/sun.h"
#include "client/reference/glb_scene.h"
#include "client/render/frame.h"
#include "client/select/camera.h"
#include "codec/result.h"

namespace citystream::client {

struct ReferenceTriangle {
    std::array<Direction, 3> corners{};  ///< metres from the scene's origin
    Rgb albedo{1, 1, 1};                 ///< linear
};

struct SkyRays {
    uint32_t across = 32;       ///< across^2 rays over a hemisphere, one in each of as many equal parts of its cosine
    uint32_t pixel_across = 1;  ///< pixel_across^2 places in a pixel, each with rays of its own
    uint32_t sun_across = 4;    ///< sun_across^2 rays to the sun's disc, where there is one apart from the map
    uint32_t jobs = 0;          ///< threads; 0: one a core. Pictures do not depend on it
};

/// Borrows what it names.
struct ReferenceLight {
    const EnvironmentMap* sky = nullptr;         ///< lights surfaces
    const EnvironmentMap* background = nullptr;  ///< is seen where no surface is met
    std::optional<Sun> sun;                      ///< lights surfaces
    bool sun_is_seen = true;                     ///< its disc above the horizon, before the background
};

/// Linear, before exposure; top row first.
struct RadiancePicture {
    uint32_t width = 0, height = 0;
    std::vector<Rgb> pixels;
    std::vector<uint8_t> surface;  ///< 1: all of the pixel's places meet one
};

/// Unit vector `ray` of across^2 about a unit normal, as often in a direction as its cosine is great: a jittered place
/// in a cell of a square, mapped to the disc (Shirley and Chiu 1997) and up to the hemisphere (Malley). The jitter
/// follows from `seed`.
Direction cosine_direction(const Direction& normal, uint32_t ray, uint32_t across, uint64_t seed);

class SkyReference {
  public:
    /// `origin`: absolute metres. Triangles may be up to about 16 km from it. Error: Embree's.
    static Result<SkyReference> create(std::span<const ReferenceTriangle> triangles,
                                       const std::array<double, 3>& origin);
    /// All of one albedo. Instances share their triangles: memory follows the scene's, not what they would be spelled
    /// out. Transparent parts of pictures are taken as solid.
    static Result<SkyReference> create(const GlbScene& scene, const Rgb& albedo);
    ~SkyReference();
    SkyReference(SkyReference&&) noexcept;
    SkyReference& operator=(SkyReference&&) noexcept;

    /// Instances counted.
    uint64_t triangles() const;

    /// Light of the environment that arrives at a point of a surface (metres from the origin) from above it. Rays start
    /// kRayLift above it, without end.
    LightSum irradiance(const Direction& point, const Direction& normal, const EnvironmentMap& environment,
                        uint32_t across, uint64_t seed) const;
    /// The same of a sun: of each place of its disc as much as the cosine to it.
    LightSum sun_irradiance(const Direction& point, const Direction& normal, const Sun& sun, uint32_t across,
                            uint64_t seed) const;

    /// Surfaces show albedo / pi times the irradiance on the side that is looked at. Deterministic. O(pixels
    /// pixel_across^2 across^2). `albedo`: a picture of the same view, sRGB, pixel_across times as wide and high, whose
    /// values take the place of the triangles' albedo.
    RadiancePicture draw(const Camera& camera, const ReferenceLight& light, const SkyRays& rays,
                         const FrameImage* albedo = nullptr) const;
    /// Lit by what is seen.
    RadiancePicture draw(const Camera& camera, const EnvironmentMap& environment, const SkyRays& rays) const {
        return draw(camera, {&environment, &environment, {}}, rays);
    }

  private:
    struct State;
    struct View;
    explicit SkyReference(std::unique_ptr<State> state);
    struct Pixel {
        LightSum radiance{};
        bool surface = true;
    };
    Pixel pixel(const View& view, uint32_t x, uint32_t y) const;
    std::unique_ptr<State> state_;
};

inline constexpr double kRayLift = 1e-3;  ///< metres

/// As lit frames are shown (client/render/tone.h).
FrameImage shown_picture(const RadiancePicture& picture, double exposure);

}  // namespace citystream::client
