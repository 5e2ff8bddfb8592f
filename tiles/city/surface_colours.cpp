#include "tiles/city/surface_colours.h"

#include <algorithm>
#include <filesystem>

namespace citystream::tiles::city {
namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

std::string percent_decoded(const std::string& text) {
    std::string out;
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0) {
            out += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
            i += 2;
        } else {
            out += text[i];
        }
    }
    return out;
}

/// The file that a URI names, tried as it is written and then percent-decoded; empty when there is none.
std::string existing_image(const std::string& model_file, const std::string& uri) {
    const std::filesystem::path folder = std::filesystem::path(model_file).parent_path();
    for (std::string name : {uri, percent_decoded(uri)}) {
        if (name.empty() || name.find('\0') != std::string::npos) continue;
        std::replace(name.begin(), name.end(), '\\', '/');
        constexpr std::string_view kFileScheme = "file://";
        if (name.starts_with(kFileScheme)) name.erase(0, kFileScheme.size());
        const std::filesystem::path path = (folder / name).lexically_normal();
        std::error_code code;
        if (std::filesystem::is_regular_file(path, code)) return path.string();
    }
    return {};
}

std::array<uint8_t, 3> building_colour(SurfaceKind surface) {
    switch (surface) {
        case SurfaceKind::kRoof:
            return {168, 92, 74};
        case SurfaceKind::kGround:
            return {128, 136, 116};
        case SurfaceKind::kWindow:
            return {92, 118, 142};
        case SurfaceKind::kDoor:
            return {112, 78, 54};
        case SurfaceKind::kInstallation:
            return {176, 172, 166};
        case SurfaceKind::kWall:
        case SurfaceKind::kUnknown:
            break;
    }
    return {222, 214, 198};
}

}  // namespace

std::array<uint8_t, 3> default_colour(ObjectKind object, SurfaceKind surface) {
    switch (object) {
        case ObjectKind::kBuilding:
            return building_colour(surface);
        case ObjectKind::kTerrain:
            return {132, 142, 102};
        case ObjectKind::kLandUse:
            return {158, 164, 128};
        case ObjectKind::kRoad:
            return {86, 86, 90};
        case ObjectKind::kWater:
            return {84, 136, 186};
        case ObjectKind::kVegetation:
            return {92, 142, 72};
        case ObjectKind::kBridge:
            return {148, 144, 140};
        case ObjectKind::kFurniture:
            return {118, 112, 108};
        case ObjectKind::kOther:
            break;
    }
    return {184, 180, 172};
}

uint32_t MaterialTable::flat(std::array<uint8_t, 3> rgb) {
    const auto [entry, is_new] = flat_.try_emplace(rgb, 0);
    if (is_new) entry->second = catalog_.add_material(Material{.rgb = rgb});
    return entry->second;
}

int32_t MaterialTable::image_of(const std::string& model_file, const std::string& uri, const std::string& feature) {
    const auto [entry, is_new] = by_uri_.try_emplace({model_file, uri}, -1);
    if (!is_new) return entry->second;
    const std::string path = existing_image(model_file, uri);
    if (path.empty()) {
        report_.add({.feature = feature, .what = "image missing: " + uri, .where = model_file});
        return -1;
    }
    const auto [image, new_image] = by_path_.try_emplace(path, static_cast<int32_t>(catalog_.images.size()));
    if (new_image) catalog_.images.push_back({.path = path, .pixels = nullptr});
    entry->second = image->second;
    return entry->second;
}

std::optional<uint32_t> MaterialTable::textured(const std::string& model_file, const std::string& uri, bool repeat,
                                                std::array<uint8_t, 3> fallback, const std::string& feature) {
    const int32_t image = image_of(model_file, uri, feature);
    if (image < 0) return std::nullopt;
    const auto [entry, is_new] = textured_.try_emplace({{image, repeat}, fallback}, 0);
    if (is_new) entry->second = catalog_.add_material(Material{.rgb = fallback, .image = image, .repeat = repeat});
    return entry->second;
}

}  // namespace citystream::tiles::city
