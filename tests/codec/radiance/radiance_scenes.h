// Visibility for the radiance tests: an open sphere, a wall, towers on a grid by ray casting, and noise.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "codec/radiance/series_angle.h"
#include "codec/radiance/visibility_bits.h"

namespace citystream::codec::radiance {

using Point = std::array<double, 3>;

struct Receiver {
    Point position, normal;
};

/// Sees(receiver's place, direction of any length) decides each sample above the receiver's plane.
inline VisibilityTile cast_rays(const std::vector<Receiver>& receivers, uint32_t side, double yaw,
                                const std::function<bool(const Receiver&, const Point&)>& sees) {
    std::vector<GridDirection> directions;
    std::vector<Point> world;
    for (uint32_t s = 0; s < sample_count(side); ++s) {
        const GridDirection d = cell_direction(kSamplesAcross * side, s);
        directions.push_back(d);
        world.push_back(
            turned({static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2])}, -yaw));
    }
    VisibilityTile tile{side, {}, {}, {}};
    for (const Receiver& receiver : receivers) {
        tile.add_receiver(pack_frame(turned(receiver.normal, yaw)));
        const uint32_t r = tile.receivers() - 1;
        const Frame frame = unpack_frame(tile.frames[tile.frame_of[r]]);
        for (uint32_t s = 0; s < sample_count(side); ++s) {
            if (frame.sees(directions[s]) && sees(receiver, world[s])) tile.set(r, s);
        }
    }
    return tile;
}

inline std::vector<Receiver> sphere_receivers(uint32_t count) {
    std::vector<Receiver> receivers;
    for (uint32_t i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), phi = i * 2.399963229728653;
        const double turn = phi - 2 * kPi * std::floor(phi / (2 * kPi));
        const AngleParts parts = angle_parts(turn);
        receivers.push_back({{r * parts.cosine, r * parts.sine, z}, {r * parts.cosine, r * parts.sine, z}});
    }
    return receivers;
}

/// Every receiver of a sphere sees all that is above its plane.
inline VisibilityTile open_sphere(uint32_t count, uint32_t side) {
    return cast_rays(sphere_receivers(count), side, 0, [](const Receiver&, const Point&) { return true; });
}

/// One receiver on open ground.
inline VisibilityTile open_ground(uint32_t side) {
    return cast_rays({{{0, 0, 0}, {0, 0, 1}}}, side, 0, [](const Receiver&, const Point&) { return true; });
}

/// Towers on a grid of `pitch` metres, as the notes' measured tile has them: 5 x 5 in a tile of 128 m, and as many in
/// each of its eight neighbours.
class TowerCity {
  public:
    static constexpr int kTowers = 5, kTiles = 3, kAcross = kTowers * kTiles;
    static constexpr double kSide = 128, kPitch = kSide / kTowers, kWidth = 16, kHeightStep = 0.5;

    explicit TowerCity(uint64_t seed = 1) {
        std::mt19937_64 random(seed);
        for (double& h : heights_) h = 8 + kHeightStep * static_cast<double>(random() % 105);
    }

    bool is_hit(const Point& from, const Point& direction) const {
        if (direction[2] <= 0) return true;
        int cell[2];
        for (int a = 0; a < 2; ++a) cell[a] = static_cast<int>(std::floor(from[a] / kPitch)) + kTowers;
        while (std::min(cell[0], cell[1]) >= 0 && std::max(cell[0], cell[1]) < kAcross) {
            if (hits_tower(from, direction, cell[0], cell[1])) return true;
            const double x = leaves(from, direction, cell, 0), y = leaves(from, direction, cell, 1);
            if (from[2] + std::min(x, y) * direction[2] > 60.5 || !std::isfinite(std::min(x, y))) return false;
            const int axis = x < y ? 0 : 1;
            cell[axis] += direction[axis] > 0 ? 1 : -1;
        }
        return false;
    }

    /// A lattice on the ground, the walls and the roofs of the middle tile, both sides of creases.
    std::vector<Receiver> receivers(double spacing) const {
        std::vector<Receiver> all;
        add_rectangle(all, {0, 0, 0}, {kSide, 0, 0}, {0, kSide, 0}, {0, 0, 1}, spacing);
        std::erase_if(all, [&](const Receiver& r) { return is_inside(r.position); });
        for (int i = kTowers; i < 2 * kTowers; ++i) {
            for (int k = kTowers; k < 2 * kTowers; ++k) add_tower(all, i, k, spacing);
        }
        return all;
    }

    VisibilityTile visibility(double spacing, uint32_t side, double yaw = 0) const {
        return cast_rays(receivers(spacing), side, yaw, [&](const Receiver& r, const Point& d) {
            Point from = r.position;
            for (size_t a = 0; a < 3; ++a) from[a] += 0.01 * r.normal[a];
            return !is_hit(from, d);
        });
    }

  private:
    static double low(int cell) { return (cell - kTowers) * kPitch + (kPitch - kWidth) / 2; }
    double height(int i, int k) const { return heights_[static_cast<size_t>(i * kAcross + k)]; }

    static double leaves(const Point& from, const Point& d, const int cell[2], int axis) {
        if (d[axis] == 0) return std::numeric_limits<double>::infinity();
        return ((cell[axis] - kTowers + (d[axis] > 0 ? 1 : 0)) * kPitch - from[axis]) / d[axis];
    }

    bool hits_tower(const Point& from, const Point& d, int i, int k) const {
        double near = 0, far = std::numeric_limits<double>::infinity();
        const Point least{low(i), low(k), 0}, most{low(i) + kWidth, low(k) + kWidth, height(i, k)};
        for (size_t a = 0; a < 3; ++a) {
            if (d[a] == 0) {
                if (from[a] < least[a] || from[a] > most[a]) return false;
                continue;
            }
            const double x = (least[a] - from[a]) / d[a], y = (most[a] - from[a]) / d[a];
            near = std::max(near, std::min(x, y));
            far = std::min(far, std::max(x, y));
        }
        return near < far;
    }

    bool is_inside(const Point& p) const {
        for (int i = kTowers; i < 2 * kTowers; ++i) {
            for (int k = kTowers; k < 2 * kTowers; ++k) {
                if (p[0] > low(i) && p[0] < low(i) + kWidth && p[1] > low(k) && p[1] < low(k) + kWidth) return true;
            }
        }
        return false;
    }

    static void add_rectangle(std::vector<Receiver>& all, Point corner, Point u, Point v, Point normal,
                              double spacing) {
        const auto parts = [&](const Point& e) {
            return std::max(
                1, static_cast<int>(std::lround((std::abs(e[0]) + std::abs(e[1]) + std::abs(e[2])) / spacing)));
        };
        for (int row = 0; row <= parts(v); ++row) {
            for (int column = 0; column <= parts(u); ++column) {
                Receiver r{corner, normal};
                for (size_t a = 0; a < 3; ++a) r.position[a] += u[a] * column / parts(u) + v[a] * row / parts(v);
                all.push_back(r);
            }
        }
    }

    void add_tower(std::vector<Receiver>& all, int i, int k, double spacing) const {
        const double x = low(i), y = low(k), h = height(i, k);
        add_rectangle(all, {x, y, h}, {kWidth, 0, 0}, {0, kWidth, 0}, {0, 0, 1}, spacing);
        add_rectangle(all, {x, y, 0}, {kWidth, 0, 0}, {0, 0, h}, {0, -1, 0}, spacing);
        add_rectangle(all, {x + kWidth, y, 0}, {0, kWidth, 0}, {0, 0, h}, {1, 0, 0}, spacing);
        add_rectangle(all, {x, y + kWidth, 0}, {kWidth, 0, 0}, {0, 0, h}, {0, 1, 0}, spacing);
        add_rectangle(all, {x, y, 0}, {0, kWidth, 0}, {0, 0, h}, {-1, 0, 0}, spacing);
    }

    double heights_[static_cast<size_t>(kAcross) * kAcross] = {};
};

/// The tile's first receivers.
inline VisibilityTile first_receivers(VisibilityTile tile, uint32_t count) {
    tile.frame_of.resize(count);
    tile.words.resize(size_t{count} * tile.words_a_receiver());
    return tile;
}

/// Bits and frames at random.
inline VisibilityTile noise(uint32_t receivers, uint32_t side, uint64_t seed) {
    std::mt19937_64 random(seed);
    VisibilityTile tile{side, {}, {}, {}};
    for (uint32_t r = 0; r < receivers; ++r) {
        tile.add_receiver(static_cast<uint32_t>(random()));
        for (uint32_t s = 0; s < sample_count(side); ++s) {
            if (random() % 2 == 0) tile.set(r, s);
        }
    }
    clear_below_planes(tile);
    return tile;
}

/// Bars: each receiver sees every third column of the sky, which moves along with it.
inline VisibilityTile fence(uint32_t receivers, uint32_t side) {
    VisibilityTile tile{side, {}, {}, {}};
    for (uint32_t r = 0; r < receivers; ++r) {
        tile.add_receiver(pack_frame({0, 0, 1}));
        for (uint32_t s = 0; s < sample_count(side); ++s) {
            if ((s + r) % 3 == 0) tile.set(r, s);
        }
    }
    clear_below_planes(tile);
    return tile;
}

}  // namespace citystream::codec::radiance
