// The images of a city for those who make tiles: prepared images with their coarser mips, read from disk and kept while
// a byte budget allows. An image that was not prepared is decoded as it is. Thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tiles/city/city_model.h"
#include "tiles/layers/image_decode.h"
#include "tiles/layers/prepared_images.h"

namespace citystream::tiles::layers {

class ImageCache {
  public:
    /// What is kept goes beyond the budget by one image at most. `prepared` may be null; else it outlives the cache.
    ImageCache(const city::CityCatalog& catalog, size_t budget_bytes, const PreparedImages* prepared = nullptr)
        : catalog_(catalog), budget_(budget_bytes), prepared_(prepared) {}

    /// Mip `level` of an image (0: as it was prepared), the coarsest beyond the last; nothing when it cannot be read
    /// (once an image, the defect is kept for take_defects).
    std::shared_ptr<const ChartImage> mip(uint32_t image, uint32_t level);

    /// Sides of mip 0, which is not read where the image was prepared; nothing when it cannot be read.
    std::optional<std::array<uint32_t, 2>> sides(uint32_t image);

    /// Whether what shows the image can be seen through.
    bool has_alpha(uint32_t image);

    /// Mean colour of a material, averaged in linear light; its flat colour when it has no readable image.
    std::array<uint8_t, 3> mean_colour(uint32_t material);

    /// The share of a material's image that is there where it has alpha (alpha_mask.h), 0..1; 1 without.
    double there_share(uint32_t material);

    std::vector<city::Defect> take_defects();

    /// The most that was kept at a time.
    size_t peak_bytes() const;

  private:
    struct Entry {
        std::shared_ptr<const ChartImage> pixels;
        std::list<uint64_t>::iterator use;
    };
    std::shared_ptr<const ChartImage> find(uint64_t key);
    void keep(uint64_t key, const std::shared_ptr<const ChartImage>& pixels);
    std::shared_ptr<const ChartImage> load(uint32_t image, uint32_t level);
    std::shared_ptr<const ChartImage> make(uint32_t image, uint32_t level);
    std::shared_ptr<const ChartImage> small_mip(uint32_t image);
    std::shared_ptr<const ChartImage> give_up(uint32_t image, const std::string& why);
    Result<ChartImage> decode(uint32_t image) const;

    const city::CityCatalog& catalog_;
    const size_t budget_;
    const PreparedImages* prepared_;
    size_t used_ = 0, peak_ = 0;
    mutable std::mutex mutex_;               // guards everything above that changes, and below
    std::array<std::mutex, 16> read_mutex_;  // one image is read by one thread
    std::map<uint64_t, Entry> entries_;
    std::list<uint64_t> uses_;  // most recent first
    std::set<uint32_t> failed_;
    std::map<uint32_t, std::array<uint8_t, 3>> means_;
    std::map<uint32_t, double> there_;
    std::vector<city::Defect> defects_;
};

/// sRGB <-> linear light, 0..1.
float srgb_to_linear(uint8_t value);
uint8_t linear_to_srgb(float value);

/// Rounded to 5 bits a channel, about what BC1 keeps: colours that look alike become equal, and share a chart.
std::array<uint8_t, 3> rounded_colour(const std::array<uint8_t, 3>& rgb);

/// Mean colour of an image, averaged in linear light, by alpha.
std::array<uint8_t, 3> mean_of(const ChartImage& image);

}  // namespace citystream::tiles::layers
