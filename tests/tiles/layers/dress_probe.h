// Buildings to dress, and exact checks of what came out of it.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "codec/grid.h"
#include "tiles/city/triangulate.h"
#include "tiles/layers/dress.h"

namespace citystream::tiles::layers {

using Ring = std::vector<city::Vec2>;

/// Puts an object together from polygons; vertices are welded.
class HouseBuilder {
  public:
    explicit HouseBuilder(std::string id) {
        object_.id = std::move(id);
        object_.kind = city::ObjectKind::kBuilding;
    }
    /// Counter-clockwise from outside; holes may follow.
    HouseBuilder& face(const std::vector<std::vector<city::Vec3>>& rings, city::SurfaceKind kind,
                       uint32_t material = 0) {
        std::vector<city::Corner> corners;
        std::vector<uint32_t> ends;
        for (const auto& ring : rings) {
            for (const city::Vec3& p : ring) corners.push_back({p, {}});
            ends.push_back(static_cast<uint32_t>(corners.size()));
        }
        std::vector<std::array<uint32_t, 3>> triangles;
        city::Triangulator triangulator;
        triangulator.triangulate(corners, ends, triangles);
        for (const auto& t : triangles)
            triangle({corners[t[0]].position, corners[t[1]].position, corners[t[2]].position}, kind, material);
        return *this;
    }
    HouseBuilder& triangle(const std::array<city::Vec3, 3>& corners, city::SurfaceKind kind, uint32_t material = 0) {
        city::Triangle made;
        for (size_t k = 0; k < 3; ++k) made.vertex[k] = vertex(corners[k]);
        made.material = material;
        made.surface = kind;
        object_.triangles.push_back(made);
        return *this;
    }
    HouseBuilder& wall(const city::Vec2& a, const city::Vec2& b, double foot, double head) {
        return face({{{a.x, a.y, foot}, {b.x, b.y, foot}, {b.x, b.y, head}, {a.x, a.y, head}}},
                    city::SurfaceKind::kWall);
    }
    /// Floor, walls and flat roof over rings: the first counter-clockwise, holes clockwise.
    HouseBuilder& prism(const std::vector<Ring>& rings, double foot, double head) {
        std::vector<std::vector<city::Vec3>> floor, roof;
        for (const Ring& ring : rings) {
            std::vector<city::Vec3> low, high;
            for (size_t i = 0; i < ring.size(); ++i) {
                high.push_back({ring[i].x, ring[i].y, head});
                low.insert(low.begin(), {ring[i].x, ring[i].y, foot});
                wall(ring[i], ring[(i + 1) % ring.size()], foot, head);
            }
            floor.push_back(low);
            roof.push_back(high);
        }
        face(floor, city::SurfaceKind::kGround, 1);
        return face(roof, city::SurfaceKind::kRoof, 1);
    }
    city::CityObject done() const { return object_; }

  private:
    uint32_t vertex(const city::Vec3& p) {
        const auto [at, is_new] = places_.try_emplace({p.x, p.y, p.z}, static_cast<uint32_t>(object_.vertices.size()));
        if (is_new) object_.vertices.push_back(p);
        return at->second;
    }
    city::CityObject object_;
    std::map<std::tuple<double, double, double>, uint32_t> places_;
};

/// Materials 0 (walls) and 1 (the rest).
inline city::CityCatalog plain_catalog() {
    city::CityCatalog catalog;
    catalog.materials = {{.rgb = {210, 190, 170}}, {.rgb = {90, 80, 80}}};
    return catalog;
}

inline Ring rectangle(double width, double depth, city::Vec2 at = {}, double turn = 0) {
    Ring ring;
    const double c = std::cos(turn), s = std::sin(turn);
    for (const auto& [x, y] : {std::pair{0.0, 0.0}, {width, 0.0}, {width, depth}, {0.0, depth}})
        ring.push_back({at.x + c * x - s * y, at.y + s * x + c * y});
    return ring;
}

inline GridPoint on_grid(const city::Vec3& p) {
    return {to_grid(p.x), to_grid(p.y), to_grid(p.z)};
}

/// Corners of a facade on the grid, as the builder rounds them: lower left, lower right, upper right, upper left.
inline std::array<GridPoint, 4> corners_of(const city::FacadeWall& wall) {
    const GridPoint a = on_grid(wall.lower_left),
                    c = on_grid({wall.lower_left.x + wall.along.x, wall.lower_left.y + wall.along.y,
                                 wall.lower_left.z + wall.height});
    return {a, {c.x, c.y, a.z}, c, {a.x, a.y, c.z}};
}

/// All faces of an object, facades among them, as triangles on the grid.
inline std::vector<std::array<GridPoint, 3>> faces_of(const city::CityObject& object) {
    std::vector<std::array<GridPoint, 3>> faces;
    for (const city::Triangle& t : object.triangles)
        faces.push_back({on_grid(object.vertices[t.vertex[0]]), on_grid(object.vertices[t.vertex[1]]),
                         on_grid(object.vertices[t.vertex[2]])});
    for (const city::FacadeWall& wall : object.facades) {
        const auto c = corners_of(wall);
        faces.push_back({c[0], c[1], c[2]});
        faces.push_back({c[0], c[2], c[3]});
    }
    return faces;
}

/// How much edge, in whole lines, is left open by the faces: edges that lie on one line cancel piece by piece, exactly
/// on the grid, so that a corner of one face on another's straight edge leaves nothing open. Lines at the height
/// `floor` do not count.
inline size_t open_lines(const city::CityObject& object, int64_t floor) {
    using Line = std::array<int64_t, 6>;
    std::map<Line, std::map<int64_t, int64_t>> cover;  // line -> place -> change of the signed count
    const auto faces = faces_of(object);
    if (faces.empty()) return 0;
    const GridPoint origin = faces[0][0];
    for (const auto& face : faces) {
        for (size_t k = 0; k < 3; ++k) {
            const GridPoint &a = face[k], &b = face[(k + 1) % 3];
            std::array<int64_t, 3> d = {b.x - a.x, b.y - a.y, b.z - a.z};
            const int64_t divisor = std::gcd(std::gcd(d[0], d[1]), d[2]);
            if (divisor == 0 || (a.z == floor && b.z == floor)) continue;
            int64_t sign = 1;
            for (int64_t& part : d) part /= divisor;
            if (d < std::array<int64_t, 3>{0, 0, 0}) {
                sign = -1;
                for (int64_t& part : d) part = -part;
            }
            const std::array<int64_t, 3> p = {a.x - origin.x, a.y - origin.y, a.z - origin.z},
                                         q = {b.x - origin.x, b.y - origin.y, b.z - origin.z};
            const Line line = {
                d[0], d[1], d[2], p[1] * d[2] - p[2] * d[1], p[2] * d[0] - p[0] * d[2], p[0] * d[1] - p[1] * d[0]};
            const int64_t from = p[0] * d[0] + p[1] * d[1] + p[2] * d[2], to = q[0] * d[0] + q[1] * d[1] + q[2] * d[2];
            cover[line][std::min(from, to)] += sign;
            cover[line][std::max(from, to)] -= sign;
        }
    }
    size_t open = 0;
    for (const auto& [line, changes] : cover) {
        const bool any = std::any_of(changes.begin(), changes.end(), [](const auto& c) { return c.second != 0; });
        open += any ? 1 : 0;
    }
    return open;
}

/// Area in square metres of the walls: upright triangles and facades.
inline double upright_area(const city::CityObject& object) {
    double area = 0;
    for (const auto& f : faces_of(object)) {
        const auto x = static_cast<double>((f[1].y - f[0].y) * (f[2].z - f[0].z) -
                                           (f[1].z - f[0].z) * (f[2].y - f[0].y)),
                   y = static_cast<double>((f[1].z - f[0].z) * (f[2].x - f[0].x) -
                                           (f[1].x - f[0].x) * (f[2].z - f[0].z)),
                   z = static_cast<double>((f[1].x - f[0].x) * (f[2].y - f[0].y) -
                                           (f[1].y - f[0].y) * (f[2].x - f[0].x));
        const double length = std::sqrt(x * x + y * y + z * z);
        if (std::abs(z) < 0.1 * length) area += length / 2;
    }
    return area * kMetresPerGridUnit * kMetresPerGridUnit;
}

/// Where no triangle of `before` lies behind a facade of `after` that looks the same way within a centimetre.
inline size_t facades_off_their_walls(const city::CityObject& before, const city::CityObject& after) {
    size_t off = 0;
    for (const city::FacadeWall& wall : after.facades) {
        const double length = std::hypot(wall.along.x, wall.along.y);
        const city::Vec3 normal{wall.along.y / length, -wall.along.x / length, 0};
        const city::Vec3 middle{wall.lower_left.x + wall.along.x / 2, wall.lower_left.y + wall.along.y / 2,
                                wall.lower_left.z + wall.height / 2};
        bool found = false;
        for (const city::Triangle& t : before.triangles) {
            const city::Vec3 &a = before.vertices[t.vertex[0]], &b = before.vertices[t.vertex[1]],
                             &c = before.vertices[t.vertex[2]];
            const city::Vec3 n{(b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y),
                               (b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z),
                               (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)};
            const double size = std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
            if (size == 0 || (n.x * normal.x + n.y * normal.y) / size < 0.999) continue;
            const double distance = ((middle.x - a.x) * n.x + (middle.y - a.y) * n.y + (middle.z - a.z) * n.z) / size;
            const auto side = [&](const city::Vec3& p, const city::Vec3& q) {
                const city::Vec3 e{q.x - p.x, q.y - p.y, q.z - p.z}, f{middle.x - p.x, middle.y - p.y, middle.z - p.z};
                return (e.y * f.z - e.z * f.y) * n.x + (e.z * f.x - e.x * f.z) * n.y + (e.x * f.y - e.y * f.x) * n.z;
            };
            const double slack = -1e-2 * size;
            if (std::abs(distance) < 0.012 && side(a, b) >= slack && side(b, c) >= slack && side(c, a) >= slack)
                found = true;
        }
        off += found ? 0 : 1;
    }
    return off;
}

}  // namespace citystream::tiles::layers
