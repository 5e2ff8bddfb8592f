// A plate with round grooves and ridges as machined metal has them: wide smooth faces, and creases of a few
// centimetres across which normals turn: where dropped bits show (Meyer 2012, Figure 3.9).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "codec/mesh/grid_mesh.h"

namespace citystream::client::test {

struct CreasedModel {
    std::vector<codec::mesh::GridPoint> points;  ///< grid units of 2^-10 m
    std::vector<float> normals;                  ///< three a point
    std::vector<std::array<uint32_t, 3>> triangles;

    /// Normals at the corners of all triangles, as AttributeLimit wants them.
    std::vector<double> corner_normals() const {
        std::vector<double> values;
        for (const auto& triangle : triangles) {
            for (const uint32_t v : triangle) {
                for (size_t c = 0; c < 3; ++c) values.push_back(static_cast<double>(normals[3 * v + c]));
            }
        }
        return values;
    }
};

/// Rings around the centre: smooth waves of 2 m, and every `spacing` metres a ridge `width` metres wide and half as
/// high, in six steps.
inline CreasedModel creased_plate(double radius, double spacing, double width) {
    std::vector<double> rings;
    for (double r = 0.5; r < radius; r += spacing) {
        for (const double part : {0.2, 0.4, 0.6, 0.8}) rings.push_back(r + part * (spacing - width));
        for (int i = 0; i <= 6; ++i) rings.push_back(r + spacing - width + width * i / 6);
    }
    const auto height = [&](double r) {
        const double phase = std::fmod(r - 0.5, spacing) - (spacing - width);
        const double ridge = phase > 0 ? width / 2 * (1 - std::cos(2 * M_PI * phase / width)) / 2 : 0;
        return 0.15 * std::sin(r * M_PI) + ridge;
    };
    constexpr uint32_t kSectors = 160;
    CreasedModel model;
    for (const double r : rings) {
        const double slope = (height(r + 1e-5) - height(r - 1e-5)) / 2e-5;
        const double length = std::hypot(slope, 1.0);
        for (uint32_t s = 0; s < kSectors; ++s) {
            const double a = 2 * M_PI * s / kSectors;
            const double place[3] = {r * std::cos(a), r * std::sin(a), height(r)};
            codec::mesh::GridPoint point{};
            for (size_t c = 0; c < 3; ++c) point[c] = static_cast<int32_t>(std::lround(place[c] * 1024));
            model.points.push_back(point);
            for (const double n : {-slope * std::cos(a) / length, -slope * std::sin(a) / length, 1 / length})
                model.normals.push_back(static_cast<float>(n));
        }
    }
    for (uint32_t ring = 0; ring + 1 < rings.size(); ++ring) {
        for (uint32_t s = 0; s < kSectors; ++s) {
            const uint32_t a = ring * kSectors + s, b = ring * kSectors + (s + 1) % kSectors;
            model.triangles.push_back({a, a + kSectors, b + kSectors});
            model.triangles.push_back({a, b + kSectors, b});
        }
    }
    return model;
}

}  // namespace citystream::client::test
