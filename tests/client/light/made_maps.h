// Environment maps made by formula, and the real ones of ../shared/data.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "client/light/environment_map.h"

namespace citystream::client {

/// Radiance of each texel's centre.
template <typename Radiance>
EnvironmentMap made_map(uint32_t width, uint32_t height, Radiance&& radiance) {
    EnvironmentMap map{width, height, {}};
    for (uint32_t row = 0; row < height; ++row) {
        for (uint32_t column = 0; column < width; ++column)
            map.texels.push_back(radiance(map_direction(width, height, column + 0.5, row + 0.5)));
    }
    return map;
}

inline EnvironmentMap uniform_map(uint32_t width, uint32_t height, const Rgb& radiance) {
    return made_map(width, height, [&](const Direction&) { return radiance; });
}

/// Values of 0..1 without any order, the same at every call.
inline EnvironmentMap noise_map(uint32_t width, uint32_t height, uint32_t seed = 1) {
    return made_map(width, height, [&](const Direction&) {
        Rgb texel{};
        for (float& v : texel) {
            seed = seed * 1664525U + 1013904223U;
            v = static_cast<float>(seed >> 8) / static_cast<float>(1 << 24);
        }
        return texel;
    });
}

inline Direction direction_at(double azimuth_degrees, double height_degrees) {
    const double azimuth = azimuth_degrees * M_PI / 180, height = height_degrees * M_PI / 180;
    return {std::cos(height) * std::sin(azimuth), std::cos(height) * std::cos(azimuth), std::sin(height)};
}

/// Adds an even disc: each texel gets the part of its area that the disc covers (16 x 16 lookups).
inline void add_disc(EnvironmentMap& map, const Direction& centre, double radius, const Rgb& radiance) {
    constexpr uint32_t kParts = 16;
    for (uint32_t row = 0; row < map.height; ++row) {
        for (uint32_t column = 0; column < map.width; ++column) {
            if (angle_between(map_direction(map.width, map.height, column + 0.5, row + 0.5), centre) >
                radius + 4 * M_PI / map.height)
                continue;
            double inside = 0, all = 0;
            for (uint32_t i = 0; i < kParts * kParts; ++i) {
                const double down = row + (i / kParts + 0.5) / kParts, area = std::sin(M_PI * down / map.height);
                const Direction there =
                    map_direction(map.width, map.height, column + (i % kParts + 0.5) / kParts, down);
                all += area;
                inside += angle_between(there, centre) <= radius ? area : 0;
            }
            Rgb& texel = map.texels[size_t{row} * map.width + column];
            for (size_t c = 0; c < 3; ++c) texel[c] += radiance[c] * static_cast<float>(inside / all);
        }
    }
}

/// Irradiance of a disc on a surface that faces it, as radiance times solid angle.
inline double disc_solid_angle(double radius) {
    return 2 * M_PI * (1 - std::cos(radius));
}

/// The environment maps of ../shared/data; empty where that is absent.
inline std::vector<std::string> shared_environments() {
    const std::filesystem::path folder = CITYSTREAM_SOURCE_DIR "/../shared/data/hdr_env";
    std::vector<std::string> files;
    std::error_code absent;
    for (const auto& entry : std::filesystem::directory_iterator(folder, absent)) {
        if (entry.path().extension() == ".hdr" || entry.path().extension() == ".exr")
            files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    return files;
}

inline void expect_near(const LightSum& a, const LightSum& b, double relative) {
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], relative * std::abs(b[c])) << "channel " << c;
}

}  // namespace citystream::client
