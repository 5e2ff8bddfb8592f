// A textured city of equal blocks with flat roofs, in several tiles.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

namespace citystream::tests {

using nlohmann::json;

inline constexpr int kBlocks = 30;          // houses a side of the city
inline constexpr double kBlockPitch = 100;  // from house to house
inline constexpr int kTextureSide = 512;

/// A value of noise, 0..1, that repeats after the texture's side.
inline double noise_at(int x, int y, int cell) {
    const auto random = [cell](int i, int j) {
        const int cells = kTextureSide / cell;
        auto h = static_cast<uint32_t>((i % cells) * 73856093) ^ static_cast<uint32_t>((j % cells) * 19349663) ^
                 static_cast<uint32_t>(cell * 83492791);
        h = (h ^ h >> 13) * 0x5bd1e995U;
        return static_cast<double>((h ^ h >> 15) & 0xffffU) / 65535;
    };
    const int i = x / cell, j = y / cell;
    const double u = static_cast<double>(x % cell) / cell, v = static_cast<double>(y % cell) / cell;
    const double low = random(i, j) * (1 - u) + random(i + 1, j) * u;
    const double high = random(i, j + 1) * (1 - u) + random(i + 1, j + 1) * u;
    return low * (1 - v) + high * v;
}

/// An uncompressed TGA file with detail of all sizes.
inline std::string noise_texture() {
    std::string file(18, '\0');
    file[2] = 2;
    file[13] = static_cast<char>(kTextureSide >> 8);
    file[15] = static_cast<char>(kTextureSide >> 8);
    file[16] = 24;
    for (int y = 0; y < kTextureSide; ++y) {
        for (int x = 0; x < kTextureSide; ++x) {
            double value = 0;
            for (const int cell : {2, 4, 8, 16, 32, 64}) value += noise_at(x, y, cell) / 6;
            for (const double tint : {200.0, 230.0, 250.0})
                file += static_cast<char>(static_cast<uint8_t>(std::clamp((value - 0.5) * 3 + 0.5, 0.0, 1.0) * tint));
        }
    }
    return file;
}

/// Blocks of 64 x 64 m, all sides and roofs textured with noise.tga, 32 m a repeat. `wall`: and one of wall.tga before
/// them, longer and higher than they are.
inline std::string block_city(bool wall = false) {
    json vertices = json::array(), places = json::array(), objects = json::object();
    const auto add_quad = [&](const std::array<std::array<double, 3>, 4>& corners, double width, double height) {
        const size_t v = vertices.size();
        for (const auto& c : corners) {
            vertices.push_back(
                {static_cast<int>(c[0] * 1000), static_cast<int>(c[1] * 1000), static_cast<int>(c[2] * 1000)});
        }
        for (const auto& [a, b] :
             {std::array{0.0, 0.0}, std::array{width, 0.0}, std::array{width, height}, std::array{0.0, height}})
            places.push_back({a / 32, b / 32});
        return v;
    };
    for (int i = 0; i < kBlocks * kBlocks; ++i) {
        const double x = i % kBlocks * kBlockPitch, y = i / kBlocks * kBlockPitch, high = 48 + 8 * (i % 3), s = 64;
        json boundaries = json::array(), values = json::array();
        for (const auto& corners :
             {std::array<std::array<double, 3>, 4>{{{x, y, 0}, {x + s, y, 0}, {x + s, y, high}, {x, y, high}}},
              {{{x + s, y, 0}, {x + s, y + s, 0}, {x + s, y + s, high}, {x + s, y, high}}},
              {{{x + s, y + s, 0}, {x, y + s, 0}, {x, y + s, high}, {x + s, y + s, high}}},
              {{{x, y + s, 0}, {x, y, 0}, {x, y, high}, {x, y + s, high}}},
              {{{x, y, high}, {x + s, y, high}, {x + s, y + s, high}, {x, y + s, high}}}}) {
            const size_t v = add_quad(corners, s, boundaries.size() < 4 ? high : s);
            boundaries.push_back({{v, v + 1, v + 2, v + 3}});
            values.push_back({{0, v, v + 1, v + 2, v + 3}});
        }
        json geometry = {{"type", "MultiSurface"}, {"lod", "2"}, {"boundaries", boundaries}};
        geometry["texture"]["t"]["values"] = values;
        objects["house" + std::to_string(i)] = {{"type", "Building"}, {"geometry", json::array({geometry})}};
    }
    if (wall) {
        const double end = kBlocks * kBlockPitch;
        const size_t v = add_quad({{{-400, -4, 0}, {end, -4, 0}, {end, -4, 90}, {-400, -4, 90}}}, 32 * 200, 32 * 6);
        json geometry = {{"type", "MultiSurface"}, {"lod", "2"}, {"boundaries", {{{v, v + 1, v + 2, v + 3}}}}};
        geometry["texture"]["t"]["values"] = {{{1, v, v + 1, v + 2, v + 3}}};
        objects["wall"] = {{"type", "CityFurniture"}, {"geometry", json::array({geometry})}};
    }
    json city = {{"type", "CityJSON"}, {"version", "2.0"}, {"vertices", vertices}, {"CityObjects", objects}};
    city["transform"] = {{"scale", {0.001, 0.001, 0.001}}, {"translate", {500.0, 500.0, 0.0}}};
    city["appearance"] = {{"textures",
                           {{{"type", "TGA"}, {"image", "noise.tga"}, {"wrapMode", "wrap"}},
                            {{"type", "TGA"}, {"image", "wall.tga"}, {"wrapMode", "wrap"}}}},
                          {"vertices-texture", places}};
    return city.dump();
}

}  // namespace citystream::tests
