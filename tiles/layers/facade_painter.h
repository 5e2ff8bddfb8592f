// Facades seen flat: what stands in for a facade map, and its pictures in the colours of a palette, painted once and
// kept while a byte budget allows. Thread-safe; what it returns does not depend on what is kept.
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
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
    FacadePainter(const city::CityCatalog& catalog, ImageCache& images, size_t budget_bytes)
        : catalog_(catalog), images_(images), budget_(budget_bytes) {}

    const FacadeFacts& facts(uint32_t map);
    struct PictureSize {
        uint32_t width = 0, height = 0;
        uint64_t texels() const { return uint64_t{width} * height; }
    };
    PictureSize picture_size(uint32_t map, double texel);
    /// The picture at about `texel` metres a texel (paint_facade), with metres_per_texel set.
    std::shared_ptr<const ChartImage> picture(uint32_t map, uint32_t palette, double texel);
    std::array<uint8_t, 3> mean_colour(uint32_t map, uint32_t palette);

  private:
    struct Key {
        uint32_t map = 0, palette = 0;
        double texel = 0;
        friend auto operator<=>(const Key&, const Key&) = default;
    };
    struct Entry {
        std::shared_ptr<const ChartImage> picture;
        std::list<Key>::iterator use;
    };
    std::shared_ptr<const ChartImage> find(const Key& key);
    void keep(const Key& key, const std::shared_ptr<const ChartImage>& picture);
    ChartImage paint(const Key& key);

    const city::CityCatalog& catalog_;
    ImageCache& images_;
    size_t budget_, used_ = 0;
    std::mutex mutex_;  // guards everything below, and used_
    std::map<uint32_t, FacadeFacts> facts_;
    std::map<uint64_t, std::array<uint8_t, 3>> means_;
    std::map<Key, Entry> pictures_;
    std::list<Key> uses_;  // most recent first
};

}  // namespace citystream::tiles::layers
