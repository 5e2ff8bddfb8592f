// Aerial photographs over ground that has no texture of its own: terrain and land use, and the flat ground that is made
// up where the input has none (thesis section 8.2.3). Triangles are cut along the photograph's edges and along blocks
// of texels, so that no image that a tile shows is larger than a chart may be; the coarser levels of the tree then show
// the photograph by the pictures that inner tiles make of their ground.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "codec/result.h"
#include "tiles/city/city_model.h"

namespace citystream::tiles::layers {

/// A photograph and where its outer edges lie, metres in the city's CRS; north is up.
struct AerialImage {
    std::string path;
    double xmin = 0, ymin = 0, xmax = 0, ymax = 0;
    uint32_t width = 0, height = 0;
};

/// A photograph as it is asked for.
struct AerialRequest {
    std::string path;
    std::optional<std::array<double, 4>> place;  ///< xmin, ymin, xmax, ymax; none: a world file says it
};

/// "IMAGE,XMIN,YMIN,XMAX,YMAX" or "IMAGE"; the path may hold commas itself. Error: one line, if the numbers are no four
/// or bound no area. Whether there is such an image is not asked, unless its name ends in what could be numbers.
Result<AerialRequest> parse_aerial(const std::string& text);

/// parse_aerial, then the image and, without numbers, the world file beside it (.tfw, .jgw, .pgw, .tifw ..., .wld).
/// Error: one line, if the image cannot be opened, or its place is missing, empty, or turned.
Result<AerialImage> open_aerial(const std::string& text);

class AerialDrape {
  public:
    /// Texels of a block, without the margin that neighbours share for filtering.
    static constexpr uint32_t kBlockTexels = 4096, kMarginTexels = 4;

    /// Images and materials are added to the catalog as they are needed; of images that overlap the first one is shown.
    AerialDrape(std::vector<AerialImage> images, city::CityCatalog& catalog)
        : images_(std::move(images)), catalog_(catalog) {}

    /// Cuts and paints what has no image in objects of the ground; leaves all others as they are. The surface stays
    /// where it is. Cut edges get the same points from both sides.
    void drape(city::CityObject& object);

    uint64_t triangles_draped() const { return draped_; }

  private:
    void drape_image(size_t image, city::CityObject& object);
    uint32_t material_of(size_t image, uint32_t column, uint32_t row);

    std::vector<AerialImage> images_;
    city::CityCatalog& catalog_;
    std::map<std::array<size_t, 3>, uint32_t> materials_;  // by image, column and row of blocks
    uint64_t draped_ = 0;
};

}  // namespace citystream::tiles::layers
