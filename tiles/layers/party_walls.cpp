#include "tiles/layers/party_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildFacade;
using quadtree::BuildObject;

constexpr double kFacing = -0.995;  // cosine between walls that look at each other: 5.7 degrees
constexpr double kEndSlack = 0.1;   // metres of a wall's end and of its top that may stay uncovered
constexpr double kFootSlack = 0.5;  // metres: neighbours on a slope begin at different heights
constexpr double kCell = 16 * kGridUnitsPerMetre;

struct Wall {
    size_t object = 0, facade = 0;
    double x = 0, y = 0, z = 0, top = 0;  ///< grid units
    double ux = 0, uy = 0, length = 0;    ///< along the wall; outwards is (uy, -ux)
};

struct Interval {
    double begin = 0, end = 0;
};

std::vector<Wall> walls_of(const std::vector<BuildObject>& objects) {
    std::vector<Wall> walls;
    for (size_t i = 0; i < objects.size(); ++i) {
        for (size_t k = 0; k < objects[i].facades.size(); ++k) {
            const BuildFacade& facade = objects[i].facades[k];
            Wall wall{i,
                      k,
                      static_cast<double>(facade.origin.x),
                      static_cast<double>(facade.origin.y),
                      static_cast<double>(facade.origin.z),
                      static_cast<double>(facade.origin.z) + facade.height};
            wall.length = std::hypot(facade.along[0], facade.along[1]);
            if (wall.length <= 0) continue;
            wall.ux = facade.along[0] / wall.length;
            wall.uy = facade.along[1] / wall.length;
            walls.push_back(wall);
        }
    }
    return walls;
}

/// Which walls may touch a cell of the ground.
class WallCells {
  public:
    explicit WallCells(const std::vector<Wall>& walls) {
        for (size_t i = 0; i < walls.size(); ++i)
            each_cell(walls[i], [&](const std::array<int64_t, 2>& cell) { cells_[cell].push_back(i); });
    }
    std::set<size_t> near(const Wall& wall) const {
        std::set<size_t> found;
        each_cell(wall, [&](const std::array<int64_t, 2>& cell) {
            const auto at = cells_.find(cell);
            if (at != cells_.end()) found.insert(at->second.begin(), at->second.end());
        });
        return found;
    }

  private:
    /// Cells within kPartyGap of the box around a wall's foot.
    template <typename Visit>
    static void each_cell(const Wall& wall, const Visit& visit) {
        constexpr double kReach = kPartyGap * kGridUnitsPerMetre;
        const auto cell = [](double at) { return static_cast<int64_t>(std::floor(at / kCell)); };
        const double x1 = wall.x + wall.ux * wall.length, y1 = wall.y + wall.uy * wall.length;
        for (int64_t y = cell(std::min(wall.y, y1) - kReach); y <= cell(std::max(wall.y, y1) + kReach); ++y) {
            for (int64_t x = cell(std::min(wall.x, x1) - kReach); x <= cell(std::max(wall.x, x1) + kReach); ++x)
                visit({x, y});
        }
    }
    std::map<std::array<int64_t, 2>, std::vector<size_t>> cells_;
};

/// The part of `wall`, along it, that `other` hides over its whole height; empty where it hides none.
Interval hidden_by(const Wall& wall, const Wall& other) {
    constexpr double kMetre = kGridUnitsPerMetre;
    if (wall.object == other.object || wall.ux * other.ux + wall.uy * other.uy > kFacing) return {};
    if (other.z > wall.z + kFootSlack * kMetre || other.top < wall.top - kEndSlack * kMetre) return {};
    std::array<double, 2> along{};
    for (size_t end = 0; end < 2; ++end) {
        const double reach = end == 0 ? 0 : other.length;
        const double dx = other.x + other.ux * reach - wall.x, dy = other.y + other.uy * reach - wall.y;
        const double before = dx * wall.uy - dy * wall.ux;
        if (before > kPartyGap * kMetre || before < -kPartyOverlap * kMetre) return {};
        along[end] = dx * wall.ux + dy * wall.uy;
    }
    return {std::min(along[0], along[1]), std::max(along[0], along[1])};
}

bool cover(std::vector<Interval>& parts, double length) {
    constexpr double kSlack = kEndSlack * kGridUnitsPerMetre;
    std::sort(parts.begin(), parts.end(), [](const Interval& a, const Interval& b) { return a.begin < b.begin; });
    double reached = 0;
    for (const Interval& part : parts) {
        if (part.begin > reached + kSlack) return false;
        reached = std::max(reached, part.end);
    }
    return reached >= length - kSlack;
}

}  // namespace

uint64_t hide_party_walls(std::vector<BuildObject>& objects, FacadePainter& facades) {
    const std::vector<Wall> walls = walls_of(objects);
    const WallCells cells(walls);
    std::vector<std::vector<bool>> hidden(objects.size());
    uint64_t count = 0;
    std::vector<Interval> parts;
    for (const Wall& wall : walls) {
        parts.clear();
        for (const size_t other : cells.near(wall)) {
            const Interval part = hidden_by(wall, walls[other]);
            if (part.end > part.begin) parts.push_back(part);
        }
        if (parts.empty() || !cover(parts, wall.length)) continue;
        hidden[wall.object].resize(objects[wall.object].facades.size());
        hidden[wall.object][wall.facade] = true;
        ++count;
    }
    for (size_t i = 0; i < objects.size(); ++i) {
        if (hidden[i].empty()) continue;
        std::vector<BuildFacade> kept;
        for (size_t k = 0; k < hidden[i].size(); ++k) {
            const BuildFacade& facade = objects[i].facades[k];
            if (!hidden[i][k]) {
                kept.push_back(facade);
                continue;
            }
            const auto colour = rounded_colour(facades.mean_colour(facade.map, facade.palette));
            add_flat_wall(objects[i], facade, facades.facts(facade.map).flat, quadtree::Paint::flat(colour));
        }
        objects[i].facades = std::move(kept);
    }
    return count;
}

}  // namespace citystream::tiles::layers
