// Pictures of a tile lit through approximations of its radiance layer, beside one that rays from each pixel make.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "codec/radiance/receiver_table.h"
#include "codec/result.h"
#include "tests/bench/irradiance_model.h"
#include "tests/bench/radiance_samples.h"

namespace citystream::bench {

/// Irradiance of each pixel that shows the tile, in the picture's order.
using PixelLight = std::vector<client::LightSum>;

/// What pixels of a view of a tile, cut out of its city, show of it: from above its south-west corner.
class TilePicture {
  public:
    /// Of a tile's sample (not a mesh's). Error: the receiver table's; Embree's; nothing is in view.
    static Result<TilePicture> create(const RadianceSample& sample, uint32_t width, uint32_t height);

    /// Between receivers as the shaders interpolate (receiver_table.h).
    PixelLight between_receivers(std::span<const client::LightSum> irradiance) const;
    /// By the visible sample directions of each pixel's own place, whatever the receivers. 12,000 rays a pixel.
    const PixelLight& by_rays() const { return by_rays_; }
    void cast_rays(std::span<const codec::radiance::Rgb> radiance);

    /// As lit frames show it (client/render/tone.h), matt and grey, so bright that of by_rays() nearly all is below
    /// white. 8 bits, three channels; where nothing is, black.
    std::vector<uint8_t> shown(const PixelLight& light) const;
    Status write_png(const PixelLight& light, const std::string& file) const;

    /// Of a picture against by_rays().
    struct Difference {
        double rmse = 0;     ///< root of the mean square of irradiance over that of by_rays()
        double psnr_db = 0;  ///< of shown(), over pixels that show the tile
    };
    Difference difference(const PixelLight& light) const;

  private:
    struct View;
    uint32_t width_ = 0, height_ = 0;
    std::vector<uint32_t> pixel_;  ///< number in the picture of each that shows the tile
    std::vector<codec::radiance::ReceiverShares> shares_;
    RadianceSample places_;  ///< what is seen from the place of each
    PixelLight by_rays_;
    double exposure_ = 1;
};

}  // namespace citystream::bench
