#include "tiles/layers/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace citystream::tiles::layers {
namespace {

Point3 minus(const Point3& a, const Point3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Point3 along(const Point3& a, const Point3& d, double t) {
    return {a[0] + d[0] * t, a[1] + d[1] * t, a[2] + d[2] * t};
}
double dot(const Point3& a, const Point3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
double squared(const Point3& a, const Point3& b) {
    const Point3 d = minus(a, b);
    return dot(d, d);
}

double squared_to_segment(const Point3& p, const Point3& a, const Point3& b) {
    const Point3 d = minus(b, a);
    const double length = dot(d, d);
    const double t = length > 0 ? std::clamp(dot(minus(p, a), d) / length, 0.0, 1.0) : 0.0;
    return squared(p, along(a, d, t));
}

Point3 middle(const Point3& a, const Point3& b) {
    return along(a, minus(b, a), 0.5);
}

}  // namespace

std::vector<Triangle3> surface_of(const quadtree::BuildObject& object, const GridPoint& origin) {
    std::vector<Triangle3> out;
    out.reserve(object.triangles.size() + 2 * object.facades.size());
    const auto local = [&](const GridPoint& p) {
        return Point3{static_cast<double>(p.x - origin.x), static_cast<double>(p.y - origin.y),
                      static_cast<double>(p.z - origin.z)};
    };
    for (const quadtree::BuildTriangle& triangle : object.triangles) {
        out.push_back({local(object.vertices[triangle.vertex[0]]), local(object.vertices[triangle.vertex[1]]),
                       local(object.vertices[triangle.vertex[2]])});
    }
    for (const quadtree::BuildFacade& facade : object.facades) {
        const auto c = facade.corners();
        out.push_back({local(c[0]), local(c[1]), local(c[2])});
        out.push_back({local(c[0]), local(c[2]), local(c[3])});
    }
    return out;
}

double squared_distance(const Point3& p, const Triangle3& t) {
    const Point3 u = minus(t[1], t[0]), v = minus(t[2], t[0]), w = minus(p, t[0]);
    const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), wu = dot(w, u), wv = dot(w, v);
    const double denominator = uu * vv - uv * uv;
    if (denominator > 0) {
        const double s = (vv * wu - uv * wv) / denominator, r = (uu * wv - uv * wu) / denominator;
        if (s >= 0 && r >= 0 && s + r <= 1) return squared(p, along(along(t[0], u, s), v, r));
    }
    return std::min(
        {squared_to_segment(p, t[0], t[1]), squared_to_segment(p, t[1], t[2]), squared_to_segment(p, t[2], t[0])});
}

double one_sided_distance(std::span<const Triangle3> from, std::span<const Triangle3> to, double limit) {
    double worst = 0;
    const auto check = [&](const Point3& p) {
        double nearest = std::numeric_limits<double>::max();
        for (const Triangle3& triangle : to) {
            nearest = std::min(nearest, squared_distance(p, triangle));
            if (nearest <= worst) return;
        }
        worst = std::max(worst, nearest);
    };
    for (const Triangle3& t : from) {
        check(t[0]);
        check(t[1]);
        check(t[2]);
        if (worst > limit * limit) break;
        check(middle(t[0], t[1]));
        check(middle(t[1], t[2]));
        check(middle(t[2], t[0]));
        check(
            {(t[0][0] + t[1][0] + t[2][0]) / 3, (t[0][1] + t[1][1] + t[2][1]) / 3, (t[0][2] + t[1][2] + t[2][2]) / 3});
        if (worst > limit * limit) break;
    }
    return std::sqrt(worst);
}

double surface_distance(std::span<const Triangle3> a, std::span<const Triangle3> b, double limit) {
    const double there = one_sided_distance(a, b, limit);
    return there > limit ? there : std::max(there, one_sided_distance(b, a, limit));
}

}  // namespace citystream::tiles::layers
