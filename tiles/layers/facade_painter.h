// Facades seen flat: a facade map and its palette drawn to a picture, and their mean colour. Thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>

#include "tiles/layers/flat_facade.h"
#include "tiles/layers/image_cache.h"

namespace citystream::tiles::layers {

/// Relief counts this many times its depth as the error of drawing it flat. It moves by its depth at most, but it also
/// shows sides and hides wall below it: at a weight of one, balconies vanish while they are still a pixel deep.
constexpr double kReliefWeight = 2;

struct FacadeFacts {
    double width_metres = 0, height_metres = 0;  ///< of the map itself
    double depth_metres = 0;                     ///< greatest |displacement|
    int16_t depth_min_mm = 0, depth_max_mm = 0;
    uint32_t slots = 0;  ///< bit s: material slot s is used
    FacadePanels flat;   ///< what stands in for it
    /// Metres that drawing it flat loses; counts kReliefWeight times as an error.
    double flat_loss() const;
};

class FacadePainter {
  public:
    FacadePainter(const city::CityCatalog& catalog, ImageCache& images) : catalog_(catalog), images_(images) {}

    const FacadeFacts& facts(uint32_t map);
    /// The picture at about `texel` metres a texel (four samples a texel, averaged in linear light; open cells count
    /// only where a texel holds nothing else, and show their slot), clamped, metres_per_texel set.
    ChartImage picture(uint32_t map, uint32_t palette, double texel);
    std::array<uint8_t, 3> mean_colour(uint32_t map, uint32_t palette);

  private:
    const city::CityCatalog& catalog_;
    ImageCache& images_;
    std::mutex mutex_;
    std::map<uint32_t, FacadeFacts> facts_;
    std::map<uint64_t, std::array<uint8_t, 3>> means_;
};

}  // namespace citystream::tiles::layers
