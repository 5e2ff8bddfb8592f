// The "appearance" member of CityJSON, unpacked.
#pragma once

#include <simdjson.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tiles/city/city_model.h"

namespace citystream::tiles::city {

struct JsonTexture {
    std::string image;
    bool repeat = true;
};

struct JsonAppearance {
    std::vector<std::optional<std::array<uint8_t, 3>>> materials;  ///< diffuseColor as sRGB; empty when it gives none
    std::vector<JsonTexture> textures;
    std::vector<Vec2> texcoords;
    std::string material_theme, texture_theme;  ///< default themes, may be empty

    void read(simdjson::dom::element appearance);
};

/// The object of theme `wanted` in {"theme": {...}, ...}, else the first one.
std::optional<simdjson::dom::element> theme_of(simdjson::dom::element themes, const std::string& wanted);

}  // namespace citystream::tiles::city
