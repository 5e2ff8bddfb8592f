// The catalog's images, decoded once and kept with their coarser mips while a byte budget allows. Thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "codec/atlas/atlas_layer.h"
#include "codec/result.h"
#include "tiles/city/city_model.h"

namespace citystream::tiles::layers {

using codec::atlas::ChartImage;

/// Decodes any file OpenImageIO reads (8/16 bit, palette, grey, CMYK, alpha dropped) to RGB8, row 0 at the bottom. At
/// most 2^28 pixels.
Result<ChartImage> decode_image(const std::string& path);

class ImageCache {
  public:
    ImageCache(const city::CityCatalog& catalog, size_t budget_bytes) : catalog_(catalog), budget_(budget_bytes) {}

    /// Mip `level` (0 = as it is) of an image, or nothing when it cannot be read (the defect is kept for take_defects,
    /// once an image).
    std::shared_ptr<const ChartImage> mip(uint32_t image, uint32_t level);

    /// Mean colour of a material, averaged in linear light; its flat colour when it has no readable image.
    std::array<uint8_t, 3> mean_colour(uint32_t material);

    std::vector<city::Defect> take_defects();

  private:
    struct Entry {
        std::shared_ptr<const ChartImage> pixels;
        std::list<uint64_t>::iterator use;
    };
    std::shared_ptr<const ChartImage> find(uint64_t key);
    void keep(uint64_t key, const std::shared_ptr<const ChartImage>& pixels);
    std::shared_ptr<const ChartImage> decode(uint32_t image);

    const city::CityCatalog& catalog_;
    size_t budget_, used_ = 0;
    std::mutex mutex_;                         // guards everything below
    std::array<std::mutex, 16> decode_mutex_;  // one image is decoded by one thread
    std::map<uint64_t, Entry> entries_;
    std::list<uint64_t> uses_;  // most recent first
    std::map<uint32_t, bool> failed_;
    std::map<uint32_t, std::array<uint8_t, 3>> means_;
    std::vector<city::Defect> defects_;
};

/// sRGB <-> linear light, 0..1.
float srgb_to_linear(uint8_t value);
uint8_t linear_to_srgb(float value);

/// Rounded to 5 bits a channel, about what BC1 keeps: colours that look alike become equal, and share a chart.
std::array<uint8_t, 3> rounded_colour(const std::array<uint8_t, 3>& rgb);

/// Mean colour of an image, averaged in linear light.
std::array<uint8_t, 3> mean_of(const ChartImage& image);

}  // namespace citystream::tiles::layers
