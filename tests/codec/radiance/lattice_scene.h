// A made-up tile of a radiance layer for tests: flat ground, a few boxes and a pitched roof, with receivers on a
// lattice.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "codec/radiance/radiance_layer.h"
#include "tests/codec/radiance/radiance_scenes.h"

namespace citystream::codec::radiance {

/// Axis-aligned boxes on the ground around (0, 0): metres.
struct Box {
    Point least, most;
};

class LatticeScene {
  public:
    static constexpr double kUnitsPerMetre = 1024;

    explicit LatticeScene(std::vector<Box> boxes) : boxes_(std::move(boxes)) {}

    /// Towers on a square of `size` metres.
    static LatticeScene towers(double size, uint32_t across, uint64_t seed) {
        std::mt19937_64 random(seed);
        std::vector<Box> boxes;
        const double pitch = size / across;
        for (uint32_t i = 0; i < across * across; ++i) {
            const double x = (i % across + 0.2) * pitch, y = (i / across + 0.3) * pitch;
            boxes.push_back(
                {{x, y, 0}, {x + 0.5 * pitch, y + 0.4 * pitch, 4.25 + static_cast<double>(random() % 160) / 8}});
        }
        return LatticeScene(std::move(boxes));
    }

    /// Receivers on ground, walls and roofs of a square of `size` metres; every fifth column of the ground is tilted.
    RadianceTile tile(double size, uint32_t spacing_log2, uint32_t side) const {
        RadianceTile tile;
        tile.spacing_log2 = spacing_log2;
        const double spacing = std::ldexp(1.0, static_cast<int>(spacing_log2)) / kUnitsPerMetre;
        for (uint32_t surface_class = 0; surface_class < 6; ++surface_class)
            add_class(tile.places, surface_class, size, spacing);
        std::sort(tile.places.begin(), tile.places.end(), [](const ReceiverPlace& a, const ReceiverPlace& b) {
            return std::tuple(a.surface_class, a.column[1], a.column[0], a.depth) <
                   std::tuple(b.surface_class, b.column[1], b.column[0], b.depth);
        });
        tile.visibility.side = side;
        for (uint32_t r = 0; r < tile.places.size(); ++r) {
            tile.visibility.add_receiver(frame_of_place(tile.places[r]));
            cast(tile, r, spacing);
        }
        return tile;
    }

  private:
    void add_class(std::vector<ReceiverPlace>& places, uint32_t surface_class, double size, double spacing) const {
        const uint32_t own = surface_class / 2, a = (own + 1) % 3, b = (own + 2) % 3;
        const bool up = surface_class % 2 == 0;
        const auto most = static_cast<int32_t>(std::floor(size / spacing));
        const auto add = [&](int32_t i, int32_t j, double depth, std::array<int8_t, 2> tilt) {
            places.push_back({surface_class, {i, j}, static_cast<int32_t>(std::lround(depth * kUnitsPerMetre)), tilt});
        };
        if (surface_class == 5) return;  // nothing looks down
        for (int32_t j = 0; j <= most; ++j) {
            for (int32_t i = 0; i <= most; ++i) {
                if (surface_class == 4 && !is_inside(i * spacing, j * spacing))
                    add(i, j, 0, {0, static_cast<int8_t>(i % 5 == 4 ? 3 : 0)});
                for (const Box& box : boxes_) {
                    if (i * spacing < box.least[a] || i * spacing > box.most[a] || j * spacing < box.least[b] ||
                        j * spacing > box.most[b])
                        continue;
                    add(i, j, up ? box.most[own] : box.least[own], {});
                }
            }
        }
    }

    bool is_inside(double x, double y) const {
        return std::any_of(boxes_.begin(), boxes_.end(), [&](const Box& box) {
            return x >= box.least[0] && x <= box.most[0] && y >= box.least[1] && y <= box.most[1];
        });
    }

    static bool hits(const Box& box, const Point& from, const Point& d) {
        double near = 0, far = std::numeric_limits<double>::infinity();
        for (size_t axis = 0; axis < 3; ++axis) {
            if (d[axis] == 0) {
                if (from[axis] < box.least[axis] || from[axis] > box.most[axis]) return false;
                continue;
            }
            const double x = (box.least[axis] - from[axis]) / d[axis], y = (box.most[axis] - from[axis]) / d[axis];
            near = std::max(near, std::min(x, y));
            far = std::min(far, std::max(x, y));
        }
        return near < far;
    }

    void cast(RadianceTile& tile, uint32_t receiver, double spacing) const {
        const ReceiverPlace& place = tile.places[receiver];
        const uint32_t own = place.surface_class / 2;
        Point from{};
        from[own] = place.depth / kUnitsPerMetre + (place.surface_class % 2 == 0 ? 0.01 : -0.01);
        from[(own + 1) % 3] = place.column[0] * spacing;
        from[(own + 2) % 3] = place.column[1] * spacing;
        const Frame frame = unpack_frame(frame_of_place(place));
        VisibilityTile& visibility = tile.visibility;
        for (uint32_t s = 0; s < sample_count(visibility.side); ++s) {
            const GridDirection d = cell_direction(kSamplesAcross * visibility.side, s);
            if (!frame.sees(d) || d[2] <= 0) continue;
            const Point direction{static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2])};
            if (std::none_of(boxes_.begin(), boxes_.end(), [&](const Box& box) { return hits(box, from, direction); }))
                visibility.set(receiver, s);
        }
    }

    std::vector<Box> boxes_;
};

/// First steps of a layer as a decoder takes them, and their decoded bytes.
struct LayerPrefix {
    std::vector<std::span<const std::byte>> steps;
    uint64_t decoded_bytes = 0;

    LayerPrefix(const std::vector<RadianceLayerStep>& layer, size_t count) {
        for (size_t i = 0; i < count; ++i) {
            steps.emplace_back(layer[i].wire);
            decoded_bytes += layer[i].decoded_bytes;
        }
    }
};

}  // namespace citystream::codec::radiance
