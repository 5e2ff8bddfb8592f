#include "client/report/lit_reference.h"

#ifdef CITYSTREAM_HAS_EMBREE

#include <cmath>
#include <utility>

#include "client/light/frame_light_maker.h"
#include "client/light/sun_split.h"
#include "client/reference/reference_renderer.h"
#include "client/reference/sky_reference.h"

#endif

namespace citystream::client {

#ifdef CITYSTREAM_HAS_EMBREE

namespace {

/// n x n values to one, as the renderers do.
FrameImage box_filtered(const FrameImage& image, uint32_t n) {
    FrameImage out{image.width / n, image.height / n, {}};
    out.rgba.reserve(size_t{4} * out.width * out.height);
    for (uint32_t y = 0; y < out.height; ++y) {
        for (uint32_t x = 0; x < out.width; ++x) {
            for (uint32_t c = 0; c < 4; ++c) {
                uint32_t sum = 0;
                for (uint32_t row = y * n; row < (y + 1) * n; ++row) {
                    for (uint32_t column = x * n; column < (x + 1) * n; ++column)
                        sum += image.rgba[4 * (size_t{row} * image.width + column) + c];
                }
                out.rgba.push_back(static_cast<uint8_t>((sum + n * n / 2) / (n * n)));
            }
        }
    }
    return out;
}

class RayTracedCity final : public LitReference {
  public:
    RayTracedCity(const LitReferenceOptions& options, std::unique_ptr<ReferenceRenderer> colours, SkyReference rays)
        : options_(options),
          across_(static_cast<uint32_t>(std::ceil(std::sqrt(options.rays) / options.supersample))),
          colours_(std::move(colours)),
          rays_(std::move(rays)) {}

    Result<FrameImage> draw(const CameraSample& sample, const LightMoment& moment, const FrameLight& shown) override {
        const Camera camera =
            Camera::from_sample(sample, options_.width * options_.supersample, options_.height * options_.supersample);
        const auto colours = colours_->draw(camera);
        if (!colours) return colours.error();
        EnvironmentMap sky = turned_map(moment.map, moment.yaw);
        ReferenceLight light{&sky, &shown.background, moment.sun};
        light.sun_is_seen = moment.sun.has_value();
        if (!moment.sun) light.sun = take_sun(sky);
        const RadiancePicture picture = rays_.draw(camera, light, {.across = across_}, &*colours);
        return box_filtered(shown_picture(picture, shown.exposure), options_.supersample);
    }
    uint64_t triangles() const override { return rays_.triangles(); }
    uint32_t rays_a_pixel() const override { return across_ * across_ * options_.supersample * options_.supersample; }

  private:
    LitReferenceOptions options_;
    uint32_t across_;
    std::unique_ptr<ReferenceRenderer> colours_;
    SkyReference rays_;
};

}  // namespace

bool lit_references_can_be_drawn() {
    return true;
}

Result<std::unique_ptr<LitReference>> LitReference::create(const std::string& glb, const LitReferenceOptions& options) {
    ReferenceOptions colour_options;
    colour_options.width = options.width * options.supersample;
    colour_options.height = options.height * options.supersample;
    colour_options.lit = false;
    auto colours = ReferenceRenderer::create(glb, colour_options);
    if (!colours) return colours.error();
    const auto scene = load_glb(glb);
    if (!scene) return scene.error();
    auto rays = SkyReference::create(*scene, {1, 1, 1});
    if (!rays) return rays.error();
    return std::unique_ptr<LitReference>(
        std::make_unique<RayTracedCity>(options, std::move(colours).value(), std::move(rays).value()));
}

#else

bool lit_references_can_be_drawn() {
    return false;
}

Result<std::unique_ptr<LitReference>> LitReference::create(const std::string&, const LitReferenceOptions&) {
    return Error{"this citystream-report was made without Embree, which draws what lit frames are compared with"};
}

#endif

}  // namespace citystream::client
