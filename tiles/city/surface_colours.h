// Colours of surfaces whose model gives none, so that a picture shows what is what; and materials by image.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>

#include "tiles/city/city_model.h"

namespace citystream::tiles::city {

/// sRGB colour of a surface without material: light walls, reddish roofs, dark grey roads, blue water, green plants.
std::array<uint8_t, 3> default_colour(ObjectKind object, SurfaceKind surface);

/// Hands out indices into CityCatalog::materials without searching the catalog each time. One for all files of a city.
class MaterialTable {
  public:
    MaterialTable(CityCatalog& catalog, CityReport& report) : catalog_(catalog), report_(report) {}

    uint32_t flat(std::array<uint8_t, 3> rgb);
    uint32_t by_default(ObjectKind object, SurfaceKind surface) { return flat(default_colour(object, surface)); }

    /// The material of image `uri` (relative to `model_file`'s folder; percent-encoding and backslashes are
    /// understood). Empty, and a defect once for each image, when there is no such file.
    std::optional<uint32_t> textured(const std::string& model_file, const std::string& uri, bool repeat,
                                     std::array<uint8_t, 3> fallback, const std::string& feature);

  private:
    int32_t image_of(const std::string& model_file, const std::string& uri, const std::string& feature);

    CityCatalog& catalog_;
    CityReport& report_;
    std::map<std::array<uint8_t, 3>, uint32_t> flat_;
    std::map<std::pair<std::string, std::string>, int32_t> by_uri_;  ///< (file, uri) -> image, -1 missing
    std::map<std::string, int32_t> by_path_;
    std::map<std::pair<std::pair<int32_t, bool>, std::array<uint8_t, 3>>, uint32_t> textured_;
};

}  // namespace citystream::tiles::city
