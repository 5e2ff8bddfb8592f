#include "tiles/layers/dress.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "tiles/city/generator_random.h"
#include "tiles/city/surface_colours.h"
#include "tiles/layers/dress_cut.h"
#include "tiles/layers/dress_maps.h"
#include "tiles/layers/dress_plan.h"
#include "tiles/layers/dress_rectangles.h"
#include "tiles/layers/dress_style.h"
#include "tiles/layers/dress_walls.h"

namespace citystream::tiles::layers {
namespace {

using city::CityObject;
using city::SurfaceKind;
using city::Triangle;
using city::Vec2;

constexpr RectangleLimits kLimits{1.5, 2.2};
constexpr double kGreatest = 1000;                     // metres: no wall of a building is wider or higher
constexpr double kCurvedWidth = 3.0;                   // metres
constexpr double kLeastTurn = 0.03, kMostTurn = 0.65;  // radians: a facet of a curve turns by this much at both ends
constexpr double kElevated = 1.2;                      // metres above the building's foot: no doors from here

bool is_detailed(const CityObject& object) {
    return std::any_of(object.triangles.begin(), object.triangles.end(), [](const Triangle& t) {
        return t.surface == SurfaceKind::kWindow || t.surface == SurfaceKind::kDoor;
    });
}

/// A corner of new triangles with the index of its vertex.
class VertexFinder {
  public:
    VertexFinder(CityObject& object, const GridObject& grid) : object_(object) {
        for (uint32_t v = 0; v < grid.points.size(); ++v) by_place_.try_emplace(key(grid.points[v]), v);
    }
    uint32_t index_of(const GridPoint& at) {
        const auto [entry, is_new] = by_place_.try_emplace(key(at), static_cast<uint32_t>(object_.vertices.size()));
        if (is_new) object_.vertices.push_back({to_metres(at.x), to_metres(at.y), to_metres(at.z)});
        return entry->second;
    }

  private:
    struct Key {
        int64_t x, y, z;
        bool operator==(const Key&) const = default;
    };
    struct Hash {
        size_t operator()(const Key& k) const { return city::procedural::hash(0, k.x, k.y, k.z); }
    };
    static Key key(const GridPoint& p) { return {p.x, p.y, p.z}; }

    CityObject& object_;
    std::unordered_map<Key, uint32_t, Hash> by_place_;
};

/// Texture coordinates of a wall as a function of the place on it, when all its triangles agree.
class WallTexture {
  public:
    WallTexture(const CityObject& object, const GridObject& grid, const WallRegion& wall)
        : origin_(wall.columns.front()), direction_(wall.direction()) {
        const Triangle& first = object.triangles[wall.triangles.front()];
        std::array<Vec2, 3> p{};
        for (size_t k = 0; k < 3; ++k) p[k] = place(grid.points[first.vertex[k]]);
        const Vec2 e{p[1].x - p[0].x, p[1].y - p[0].y}, f{p[2].x - p[0].x, p[2].y - p[0].y};
        const double area = e.x * f.y - e.y * f.x;
        const auto solve = [&](double t0, double t1, double t2) {
            const double d1 = t1 - t0, d2 = t2 - t0;
            const double s = (d1 * f.y - d2 * e.y) / area, z = (d2 * e.x - d1 * f.x) / area;
            return std::array{t0 - s * p[0].x - z * p[0].y, s, z};
        };
        const auto& t = first.texcoord;
        u_ = solve(t[0].x, t[1].x, t[2].x);
        v_ = solve(t[0].y, t[1].y, t[2].y);
        for (uint32_t index : wall.triangles) {
            const Triangle& triangle = object.triangles[index];
            for (size_t k = 0; k < 3; ++k) {
                const Vec2 here = at(grid.points[triangle.vertex[k]]);
                if (!(std::hypot(here.x - triangle.texcoord[k].x, here.y - triangle.texcoord[k].y) < kAgree) ||
                    triangle.material != first.material)
                    agrees_ = false;
            }
        }
    }
    bool agrees() const { return agrees_; }
    Vec2 at(const GridPoint& point) const {
        const Vec2 p = place(point);
        return {u_[0] + u_[1] * p.x + u_[2] * p.y, v_[0] + v_[1] * p.x + v_[2] * p.y};
    }

  private:
    static constexpr double kAgree = 0.01;  // repeats of the image

    Vec2 place(const GridPoint& p) const {
        return {direction_.x * to_metres(p.x - origin_[0]) + direction_.y * to_metres(p.y - origin_[1]),
                to_metres(p.z)};
    }

    std::array<int64_t, 2> origin_;
    Vec2 direction_;
    std::array<double, 3> u_{}, v_{};
    bool agrees_ = true;
};

/// Drops vertices that no triangle uses.
void drop_unused_vertices(CityObject& object) {
    std::vector<uint32_t> place(object.vertices.size(), UINT32_MAX);
    std::vector<city::Vec3> kept;
    for (const Triangle& triangle : object.triangles)
        for (uint32_t v : triangle.vertex) place[v] = 0;
    for (size_t v = 0; v < place.size(); ++v) {
        if (place[v] == UINT32_MAX) continue;
        place[v] = static_cast<uint32_t>(kept.size());
        kept.push_back(object.vertices[v]);
    }
    for (Triangle& triangle : object.triangles)
        for (uint32_t& v : triangle.vertex) v = place[v];
    object.vertices = std::move(kept);
}

/// A wall while it is planned: its rectangles and the facades of each.
struct DressedWall {
    std::vector<CutRectangle> cuts;
    std::vector<WallPlan> plans;
};

/// Adds the columns between the facades of each rectangle; columns that are inserted move all that lie right of them.
void add_seams(WallRegion& wall, DressedWall& dressed) {
    const auto insert = [&](double metres) {
        const size_t before = wall.columns.size();
        const uint32_t index = add_column(wall, metres);
        if (wall.columns.size() == before) return index;
        for (CutRectangle& cut : dressed.cuts) {
            for (uint32_t* column : {&cut.rectangle.left, &cut.rectangle.right})
                if (*column >= index) ++*column;
            for (uint32_t& seam : cut.seams)
                if (seam >= index) ++seam;
        }
        return index;
    };
    for (size_t i = 0; i < dressed.cuts.size(); ++i) {
        const LevelRectangle& r = dressed.cuts[i].rectangle;
        const double left = wall.along[r.left], right = wall.along[r.right];
        dressed.cuts[i].seams = {r.left};
        for (uint32_t k = 1; k < dressed.plans[i].columns; ++k) {
            const uint32_t seam = insert(left + (right - left) * k / dressed.plans[i].columns);
            dressed.cuts[i].seams.push_back(seam);
        }
        dressed.cuts[i].seams.push_back(dressed.cuts[i].rectangle.right);
    }
}

}  // namespace

class Dresser::Impl {
  public:
    Impl(uint64_t seed, city::CityCatalog& catalog) : seed_(seed), catalog_(catalog), maps_(seed, catalog) {}

    void dress(CityObject& object) {
        if (object.kind != city::ObjectKind::kBuilding) return;
        ++report_.buildings;
        if (!object.facades.empty() || is_detailed(object) || !put_on_grid(object, grid_)) return;
        for (const Triangle& triangle : object.triangles)
            if (triangle.material >= catalog_.materials.size()) return;
        WallSearch search = find_walls(object, grid_);
        report_.walls += search.walls.size() + search.tangled;
        report_.walls_degenerate += search.tangled;
        if (search.walls.empty()) return;
        std::sort(search.walls.begin(), search.walls.end(), [](const WallRegion& a, const WallRegion& b) {
            return std::tie(a.columns.front(), a.columns.back(), a.outline.front().from.z) <
                   std::tie(b.columns.front(), b.columns.back(), b.outline.front().from.z);
        });
        dress_walls(object, search.walls);
    }

    DressReport report() const {
        DressReport report = report_;
        report.maps = maps_.size();
        return report;
    }

  private:
    void dress_walls(CityObject& object, std::vector<WallRegion>& walls) {
        const BuildingStyle style =
            style_of(shape_of(object, grid_, walls), draws_of(seed_, object.id, grid_), object.facts);
        const auto roles = wall_roles(walls, style);
        const auto turns = wall_turns(walls);
        find_hidden_parts(walls);
        std::vector<bool> replaced(object.triangles.size());
        std::vector<Triangle> rest;
        std::optional<VertexFinder> vertices;
        for (size_t w = 0; w < walls.size(); ++w) {
            const double area = area_of(object, walls[w]);
            report_.wall_area += area;
            DressedWall dressed;
            if (is_dressable(walls[w], turns[w], dressed.cuts)) plan(walls[w], style, roles[w], dressed);
            if (dressed.cuts.empty()) continue;
            if (!cutter_.cut(walls[w], dressed.cuts, grid_.bottom, triangles_)) {
                ++report_.walls_degenerate;
                continue;
            }
            if (catalog_.materials[object.triangles[walls[w].triangles.front()].material].image >= 0)
                ++report_.pictures_covered;
            if (!triangles_.empty()) {
                if (!vertices) vertices.emplace(object, grid_);
                keep_rest(object, walls[w], *vertices, rest);
            }
            for (uint32_t t : walls[w].triangles) replaced[t] = true;
            put_facades(object, walls[w], dressed, style);
        }
        if (object.facades.empty()) return;
        ++report_.dressed_buildings;
        ++report_.by_use[static_cast<size_t>(style.use)];
        finish(object, replaced, rest, maps_.palette_of(style));
    }

    static double area_of(const CityObject& object, const WallRegion& wall) {
        double area = 0;
        for (uint32_t t : wall.triangles) {
            const auto& v = object.triangles[t].vertex;
            const city::Vec3 &a = object.vertices[v[0]], &b = object.vertices[v[1]], &c = object.vertices[v[2]];
            const std::array<double, 3> e = {b.x - a.x, b.y - a.y, b.z - a.z}, f = {c.x - a.x, c.y - a.y, c.z - a.z};
            area += std::hypot(e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]) / 2;
        }
        return area;
    }

    /// Finds the rectangles of a wall, or counts why there are none.
    bool is_dressable(WallRegion& wall, const WallTurn& turn, std::vector<CutRectangle>& cuts) {
        const auto curves = [](double angle) { return angle > kLeastTurn && angle < kMostTurn; };
        if (wall.width() < kLimits.least_width) {
            ++report_.walls_small;
            return false;
        }
        if (wall.width() < kCurvedWidth && curves(turn.left) && curves(turn.right)) {
            ++report_.walls_curved;
            return false;
        }
        std::vector<LevelRectangle> rectangles;
        if (!level_rectangles(wall, kLimits, rectangles)) {
            ++report_.walls_degenerate;
            return false;
        }
        if (wall.width() > kGreatest || to_metres(grid_.top - grid_.bottom) > kGreatest) rectangles.clear();
        for (const LevelRectangle& rectangle : rectangles) cuts.push_back({rectangle, {}});
        if (cuts.empty()) ++(wall.hidden.empty() ? report_.walls_small : report_.walls_shared);
        return !cuts.empty();
    }

    void plan(WallRegion& wall, const BuildingStyle& style, city::procedural::FacadeRole role, DressedWall& dressed) {
        for (const CutRectangle& cut : dressed.cuts) {
            const LevelRectangle& r = cut.rectangle;
            dressed.plans.push_back(plan_wall(style, role, wall.along[r.right] - wall.along[r.left],
                                              to_metres(r.top - r.bottom),
                                              to_metres(r.bottom - grid_.bottom) > kElevated));
        }
        add_seams(wall, dressed);
    }

    void put_facades(CityObject& object, const WallRegion& wall, const DressedWall& dressed,
                     const BuildingStyle& style) {
        const uint32_t palette = maps_.palette_of(style);
        for (size_t i = 0; i < dressed.cuts.size(); ++i) {
            const LevelRectangle& r = dressed.cuts[i].rectangle;
            const WallPlan& plan = dressed.plans[i];
            int64_t foot = r.bottom;
            int below = 0;
            for (const DressMapSpec& spec : plan.pieces) {
                below += map_height_cm(spec);
                const int64_t head = r.bottom + (r.top - r.bottom) * below / plan.height_cm;
                const uint32_t map = maps_.map_of(spec);
                for (size_t s = 1; s < dressed.cuts[i].seams.size(); ++s) {
                    const auto &a = wall.columns[dressed.cuts[i].seams[s - 1]],
                               &b = wall.columns[dressed.cuts[i].seams[s]];
                    object.facades.push_back({{to_metres(a[0]), to_metres(a[1]), to_metres(foot)},
                                              {to_metres(b[0] - a[0]), to_metres(b[1] - a[1])},
                                              to_metres(head - foot),
                                              map,
                                              palette});
                    ++report_.facades;
                    report_.facade_area += std::hypot(object.facades.back().along.x, object.facades.back().along.y) *
                                           object.facades.back().height;
                }
                foot = head;
            }
        }
    }

    /// The triangles that the cutter left of a wall, with its material and texture.
    void keep_rest(CityObject& object, const WallRegion& wall, VertexFinder& vertices, std::vector<Triangle>& rest) {
        const Triangle first = object.triangles[wall.triangles.front()];
        const city::Material material = catalog_.materials[first.material];
        const WallTexture texture(object, grid_, wall);
        const bool textured = material.image >= 0 && texture.agrees();
        const uint32_t plain = material.image >= 0 && !textured
                                   ? catalog_.add_material(city::Material{.rgb = material.rgb})
                                   : first.material;
        for (const auto& corners : triangles_) {
            Triangle triangle;
            triangle.material = plain;
            triangle.surface = first.surface;
            for (size_t k = 0; k < 3; ++k) {
                const auto& column = wall.columns[corners[k].column];
                const GridPoint at{column[0], column[1], corners[k].z};
                triangle.vertex[k] = vertices.index_of(at);
                if (textured) triangle.texcoord[k] = texture.at(at);
            }
            rest.push_back(triangle);
        }
    }

    /// Puts the triangles that remain in place; walls without a colour of their own take the facades'.
    void finish(CityObject& object, const std::vector<bool>& replaced, std::vector<Triangle>& rest, uint32_t palette) {
        std::vector<Triangle> kept;
        for (size_t t = 0; t < object.triangles.size(); ++t)
            if (!replaced[t]) kept.push_back(object.triangles[t]);
        kept.insert(kept.end(), rest.begin(), rest.end());
        const city::Material uncoloured{.rgb = city::default_colour(city::ObjectKind::kBuilding, SurfaceKind::kWall)};
        for (Triangle& triangle : kept)
            if (triangle.surface == SurfaceKind::kWall && catalog_.materials[triangle.material] == uncoloured)
                triangle.material = maps_.wall_material(palette);
        object.triangles = std::move(kept);
        drop_unused_vertices(object);
    }

    uint64_t seed_;
    city::CityCatalog& catalog_;
    DressMaps maps_;
    WallCutter cutter_;
    GridObject grid_;
    std::vector<std::array<WallPoint, 3>> triangles_;
    DressReport report_;
};

Dresser::Dresser(uint64_t seed, city::CityCatalog& catalog) : impl_(std::make_unique<Impl>(seed, catalog)) {}
Dresser::~Dresser() = default;

void Dresser::dress(city::CityObject& object) {
    impl_->dress(object);
}

DressReport Dresser::report() const {
    return impl_->report();
}

}  // namespace citystream::tiles::layers
