#include "tiles/city/cityjson_appearance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace citystream::tiles::city {
namespace {

using simdjson::dom::array;
using simdjson::dom::element;
using simdjson::dom::object;

uint8_t colour_byte(double value) {
    return static_cast<uint8_t>(std::lround(std::clamp(std::isfinite(value) ? value : 0.0, 0.0, 1.0) * 255));
}

std::optional<std::array<uint8_t, 3>> diffuse_colour(element material) {
    array channels;
    if (material["diffuseColor"].get(channels)) return std::nullopt;
    std::array<uint8_t, 3> rgb{};
    size_t count = 0;
    for (const element channel : channels) {
        double value = 0;
        if (count == rgb.size() || channel.get(value)) return std::nullopt;
        rgb[count++] = colour_byte(value);
    }
    return count == rgb.size() ? std::optional(rgb) : std::nullopt;
}

JsonTexture texture_of(element texture) {
    JsonTexture out;
    std::string_view text;
    if (!texture["image"].get(text)) out.image = text;
    if (!texture["wrapMode"].get(text)) out.repeat = text == "wrap" || text == "mirror";
    return out;
}

Vec2 texcoord_of(element pair) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    Vec2 out = {kNone, kNone};
    array numbers;
    if (pair.get(numbers)) return out;
    auto number = numbers.begin();
    if (number == numbers.end() || (*number).get(out.x)) return out;
    ++number;
    if (number == numbers.end() || (*number).get(out.y)) return out;
    return out;
}

}  // namespace

void JsonAppearance::read(element appearance) {
    *this = {};
    array list;
    std::string_view theme;
    if (!appearance["materials"].get(list)) {
        for (const element material : list) materials.push_back(diffuse_colour(material));
    }
    if (!appearance["textures"].get(list)) {
        for (const element texture : list) textures.push_back(texture_of(texture));
    }
    if (!appearance["vertices-texture"].get(list)) {
        for (const element pair : list) texcoords.push_back(texcoord_of(pair));
    }
    if (!appearance["default-theme-material"].get(theme)) material_theme = theme;
    if (!appearance["default-theme-texture"].get(theme)) texture_theme = theme;
}

std::optional<element> theme_of(element themes, const std::string& wanted) {
    object by_name;
    if (themes.get(by_name)) return std::nullopt;
    element found;
    if (!wanted.empty() && !by_name[wanted].get(found)) return found;
    if (by_name.begin() == by_name.end()) return std::nullopt;
    return (*by_name.begin()).value;
}

}  // namespace citystream::tiles::city
