#include "tiles/layers/relief_extraction_frame.h"

#include <algorithm>
#include <array>
#include <numeric>

namespace citystream::tiles::layers::relief {
namespace {

constexpr double kMostUp = 0.1;              // of a wall's unit normal
constexpr double kSameDirection = 0.99756;   // cosine of 4 degrees
constexpr double kSharpDirection = 0.99985;  // cosine of 1 degree
constexpr double kSameOffset = 0.6;
constexpr size_t kMostPlanes = 64;
constexpr double kMostMetres = 2000;

struct WallTriangle {
    const city::Triangle* triangle = nullptr;
    city::Vec2 normal;
    city::Vec2 centre;
    double area = 0;
};

struct Group {
    city::Vec2 normal, point;
    std::vector<const WallTriangle*> members;
    double area = 0;
};

std::vector<WallTriangle> wall_triangles(const city::CityObject& object) {
    std::vector<WallTriangle> found;
    for (const city::Triangle& t : object.triangles) {
        if (t.surface != city::SurfaceKind::kWall && t.surface != city::SurfaceKind::kWindow &&
            t.surface != city::SurfaceKind::kDoor)
            continue;
        const city::Vec3 &a = object.vertices[t.vertex[0]], &b = object.vertices[t.vertex[1]],
                         &c = object.vertices[t.vertex[2]];
        const Point n = cross({b.x - a.x, b.y - a.y, b.z - a.z}, {c.x - a.x, c.y - a.y, c.z - a.z});
        const double twice = length(n), flat = std::hypot(n.u, n.v);
        if (!(twice > 1e-9) || std::abs(n.w) > kMostUp * twice) continue;
        found.push_back({&t, {n.u / flat, n.v / flat}, {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3}, twice / 2});
    }
    std::stable_sort(found.begin(), found.end(),
                     [](const WallTriangle& a, const WallTriangle& b) { return a.area > b.area; });
    return found;
}

std::vector<Group> group(const std::vector<WallTriangle>& triangles) {
    std::vector<Group> groups;
    for (const WallTriangle& t : triangles) {
        const auto fits = [&](const Group& g) {
            const double offset = (t.centre.x - g.point.x) * g.normal.x + (t.centre.y - g.point.y) * g.normal.y;
            return g.normal.x * t.normal.x + g.normal.y * t.normal.y > kSameDirection && std::abs(offset) < kSameOffset;
        };
        auto at = std::find_if(groups.begin(), groups.end(), fits);
        if (at == groups.end()) {
            if (groups.size() == kMostPlanes) continue;
            at = groups.insert(groups.end(), Group{t.normal, t.centre, {}, 0});
        }
        at->members.push_back(&t);
        at->area += t.area;
    }
    return groups;
}

city::Vec2 mean_normal(const Group& g) {
    city::Vec2 sum;
    for (const WallTriangle* t : g.members) {
        if (g.normal.x * t->normal.x + g.normal.y * t->normal.y < kSharpDirection) continue;
        sum.x += t->normal.x * t->area;
        sum.y += t->normal.y * t->area;
    }
    const double size = std::hypot(sum.x, sum.y);
    return {sum.x / size, sum.y / size};
}

/// Offset from the group's point along `normal` that halves the area.
double median_offset(const Group& g, const city::Vec2& normal) {
    std::vector<std::pair<double, double>> offsets;
    for (const WallTriangle* t : g.members) {
        offsets.emplace_back((t->centre.x - g.point.x) * normal.x + (t->centre.y - g.point.y) * normal.y, t->area);
    }
    std::sort(offsets.begin(), offsets.end());
    double sum = 0;
    for (const auto& [offset, area] : offsets) {
        sum += area;
        if (sum * 2 >= g.area) return offset;
    }
    return offsets.back().first;
}

bool is_inside(const Point& p, const std::array<Point, 3>& t) {
    const Point n = cross(t[1] - t[0], t[2] - t[0]);
    return dot(cross(t[1] - t[0], p - t[0]), n) >= 0 && dot(cross(t[2] - t[1], p - t[1]), n) >= 0 &&
           dot(cross(t[0] - t[2], p - t[2]), n) >= 0;
}

/// The next surface before the wall is seen from its back: a pane that faces the room, not the street.
bool faces_inside(const city::CityObject& object, const WallFrame& frame, const Point& p) {
    double nearest = 1e300;
    bool from_back = false;
    for (const city::Triangle& t : object.triangles) {
        std::array<Point, 3> corner;
        for (size_t k = 0; k < 3; ++k) corner[k] = frame.local(object.vertices[t.vertex[k]]);
        const Point n = cross(corner[1] - corner[0], corner[2] - corner[0]);
        if (n.w == 0) continue;
        const double way = dot(corner[0] - p, n) / n.w;
        if (way < 0 || way >= nearest || !is_inside({p.u, p.v, p.w + way}, corner)) continue;
        nearest = way;
        from_back = n.w > 0;
    }
    return from_back;
}

/// Most of the group, by the area of its largest triangles.
bool faces_inside(const city::CityObject& object, const WallFrame& frame, const Group& g) {
    constexpr size_t kProbes = 12;
    constexpr double kAwayMetres = 0.01;
    double inside = 0, all = 0;
    for (size_t i = 0; i < std::min(kProbes, g.members.size()); ++i) {
        const auto& vertex = g.members[i]->triangle->vertex;
        Point centre;
        for (const uint32_t v : vertex) centre = centre + frame.local(object.vertices[v]) * (1.0 / 3);
        centre.w += kAwayMetres;
        all += g.members[i]->area;
        if (faces_inside(object, frame, centre)) inside += g.members[i]->area;
    }
    return inside * 2 > all;
}

WallFrame frame_of(const city::CityObject& object, const Group& g) {
    const city::Vec2 normal = mean_normal(g);
    const double offset = median_offset(g, normal);
    WallFrame frame;
    frame.along = {-normal.y, normal.x};
    frame.origin = {g.point.x + normal.x * offset, g.point.y + normal.y * offset,
                    object.vertices[g.members.front()->triangle->vertex[0]].z};
    frame.area = g.area;
    Point low = {1e300, 1e300, 0}, high = {-1e300, -1e300, 0};
    for (const WallTriangle* t : g.members) {
        for (const uint32_t vertex : t->triangle->vertex) {
            const Point p = frame.local(object.vertices[vertex]);
            low = {std::min(low.u, p.u), std::min(low.v, p.v), 0};
            high = {std::max(high.u, p.u), std::max(high.v, p.v), 0};
        }
    }
    frame.origin = frame.world(low);
    frame.width = high.u - low.u;
    frame.height = high.v - low.v;
    return frame;
}

}  // namespace

std::vector<WallFrame> find_wall_frames(const city::CityObject& object, const ReliefExtractionOptions& options) {
    const std::vector<WallTriangle> triangles = wall_triangles(object);
    std::vector<WallFrame> frames;
    for (const Group& g : group(triangles)) {
        if (g.area < options.least_area) continue;
        const WallFrame frame = frame_of(object, g);
        if (!(frame.width < kMostMetres && frame.height < kMostMetres)) continue;  // nor no number
        if (!faces_inside(object, frame, g)) frames.push_back(frame);
    }
    std::stable_sort(frames.begin(), frames.end(),
                     [](const WallFrame& a, const WallFrame& b) { return a.area > b.area; });
    return frames;
}

}  // namespace citystream::tiles::layers::relief
