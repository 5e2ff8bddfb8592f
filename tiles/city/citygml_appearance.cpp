#include "tiles/city/citygml_appearance.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tiles/city/number_text.h"

namespace citystream::tiles::city {
namespace {

std::string trimmed(std::string_view text) {
    constexpr const char* kSpace = " \t\r\n";
    const size_t begin = text.find_first_not_of(kSpace);
    if (begin == std::string_view::npos) return {};
    return std::string(text.substr(begin, text.find_last_not_of(kSpace) - begin + 1));
}

/// "#id" or "file.gml#id" -> "id".
std::string id_of(std::string_view reference) {
    const size_t hash = reference.find('#');
    return trimmed(hash == std::string_view::npos ? reference : reference.substr(hash + 1));
}

std::optional<std::array<uint8_t, 3>> colour_of_text(const std::string& text) {
    std::array<uint8_t, 3> rgb{};
    size_t count = 0;
    bool good = true;
    for_each_number(text, [&](double value) {
        good = good && std::isfinite(value) && count < rgb.size();
        if (good) rgb[count] = static_cast<uint8_t>(std::lround(std::clamp(value, 0.0, 1.0) * 255));
        ++count;
    });
    return good && count == rgb.size() ? std::optional(rgb) : std::nullopt;
}

std::vector<Vec2> texcoords_of_text(const std::string& text) {
    std::vector<Vec2> points;
    double u = 0;
    bool second = false;
    for_each_number(text, [&](double value) {
        if (second) points.push_back({u, value});
        u = value;
        second = !second;
    });
    return points;
}

}  // namespace

std::optional<std::array<uint8_t, 3>> GmlAppearance::colour_of(const std::string& surface_id) const {
    const auto found = colours_.find(surface_id);
    return found == colours_.end() ? std::nullopt : std::optional(found->second.rgb);
}

GmlAppearance::RingLook GmlAppearance::look_of(const std::string& ring_id) const {
    const auto found = rings_.find(ring_id);
    if (found == rings_.end()) return {};
    return {&textures_[found->second.texture], texcoords_.data() + found->second.first, found->second.count};
}

void GmlAppearance::clear() {
    colours_.clear();
    rings_.clear();
    textures_.clear();
    texcoords_.clear();
}

bool GmlAppearanceParser::start(std::string_view name, const XmlAttributes& attributes) {
    if (name == "X3DMaterial" || name == "ParameterizedTexture") {
        targets_.clear();
        coordinates_.clear();
        rings_named_ = 0;
        colour_.reset();
        texture_ = {};
        front_ = true;
        return false;
    }
    if (name == "GeoreferencedTexture" || name == "TexCoordGen") ++unsupported_;
    if (name == "target") {
        const std::string_view uri = attributes["uri"].empty() ? attributes["href"] : attributes["uri"];
        if (!uri.empty()) targets_.push_back(id_of(uri));
        return true;
    }
    if (name == "textureCoordinates") {
        coordinates_.push_back({id_of(attributes["ring"]), {}});
        return true;
    }
    return name == "ring" || name == "imageURI" || name == "wrapMode" || name == "diffuseColor" || name == "isFront";
}

void GmlAppearanceParser::end(std::string_view name, const std::string& text, GmlAppearance& into) {
    if (name == "X3DMaterial") {
        finish_material(into);
    } else if (name == "ParameterizedTexture") {
        finish_texture(into);
    } else if (name == "target") {
        if (std::string id = id_of(text); text.find('#') != std::string::npos) targets_.push_back(std::move(id));
    } else if (name == "textureCoordinates") {
        if (!coordinates_.empty()) coordinates_.back().points = texcoords_of_text(text);
    } else if (name == "ring") {
        // CityGML 3.0 names the rings in elements of their own, in the order of the coordinates.
        if (rings_named_ < coordinates_.size()) coordinates_[rings_named_].ring = id_of(text);
        ++rings_named_;
    } else if (name == "TexCoordList") {
        rings_named_ = coordinates_.size();
    } else if (name == "imageURI") {
        texture_.uri = trimmed(text);
    } else if (name == "wrapMode") {
        const std::string mode = trimmed(text);
        texture_.repeat = mode == "wrap" || mode == "mirror";
    } else if (name == "diffuseColor") {
        colour_ = colour_of_text(text);
    } else if (name == "isFront") {
        const std::string value = trimmed(text);
        front_ = value != "false" && value != "0";
    }
}

void GmlAppearanceParser::finish_material(GmlAppearance& into) {
    if (!colour_) return;
    for (std::string& target : targets_) {
        const auto [entry, is_new] =
            into.colours_.try_emplace(std::move(target), GmlAppearance::Colour{*colour_, front_});
        if (!is_new && front_ && !entry->second.front) entry->second = {*colour_, true};
    }
}

void GmlAppearanceParser::finish_texture(GmlAppearance& into) {
    if (coordinates_.empty()) return;
    const auto texture = static_cast<uint32_t>(into.textures_.size());
    into.textures_.push_back(std::move(texture_));
    for (Coordinates& list : coordinates_) {
        const GmlAppearance::Ring ring = {texture, into.texcoords_.size(), list.points.size(), front_};
        const auto [entry, is_new] = into.rings_.try_emplace(std::move(list.ring), ring);
        if (!is_new && (!front_ || entry->second.front)) continue;
        entry->second = ring;
        into.texcoords_.insert(into.texcoords_.end(), list.points.begin(), list.points.end());
    }
}

}  // namespace citystream::tiles::city
