#include "tiles/city/object_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "tiles/city/shell_orientation.h"

namespace citystream::tiles::city {
namespace {

/// Stands in Triangle::material until finish() knows the surface's kind.
constexpr uint32_t kByDefault = std::numeric_limits<uint32_t>::max();

bool same(const Vec3& a, const Vec3& b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}
Vec3 minus(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec3 cross(const Vec3& a, const Vec3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
double dot(const Vec3& a, const Vec3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
double length(const Vec3& a) {
    return std::sqrt(dot(a, a));
}

Vec3 triangle_normal(const CityObject& object, const Triangle& t) {
    const Vec3& a = object.vertices[t.vertex[0]];
    return cross(minus(object.vertices[t.vertex[1]], a), minus(object.vertices[t.vertex[2]], a));
}

}  // namespace

void ObjectBuilder::begin(std::string id, ObjectKind kind, std::string where) {
    object_ = {};
    object_.id = std::move(id);
    object_.kind = kind;
    where_ = std::move(where);
    welder_.clear();
    shell_begin_ = 0;
    counts_ = {};
}

void ObjectBuilder::report(const std::string& what) {
    report_.add({.feature = object_.id, .what = what, .where = where_});
}

bool ObjectBuilder::coordinates_are_sane() const {
    const auto sane = [](double v) { return std::abs(v) <= kMostMetres; };  // false for NaN too
    return std::all_of(corners_.begin(), corners_.end(), [&](const Corner& c) {
        return sane(c.position.x) && sane(c.position.y) && sane(c.position.z) && std::isfinite(c.texcoord.x) &&
               std::isfinite(c.texcoord.y);
    });
}

void ObjectBuilder::drop_repeated_points() {
    uint32_t begin = 0;
    size_t out = 0;
    for (uint32_t& ring_end : ring_ends_) {
        const uint32_t end = ring_end;
        const size_t ring_begin = out;
        for (uint32_t i = begin; i < end; ++i) {
            const bool repeated = out > ring_begin && same(corners_[out - 1].position, corners_[i].position);
            if (repeated) {
                ++counts_.repeated_points;
            } else {
                corners_[out++] = corners_[i];
            }
        }
        while (out > ring_begin + 1 && same(corners_[out - 1].position, corners_[ring_begin].position)) --out;
        begin = end;
        ring_end = static_cast<uint32_t>(out);
    }
    corners_.resize(out);
}

/// Drops holes of fewer than three points; false when the outer ring itself is one.
bool ObjectBuilder::keep_real_rings() {
    constexpr uint32_t kLeastPoints = 3;
    if (ring_ends_.empty() || ring_ends_[0] < kLeastPoints) return false;
    kept_.clear();
    uint32_t begin = 0;
    size_t rings = 0;
    for (const uint32_t end : ring_ends_) {
        if (end - begin >= kLeastPoints) {
            kept_.insert(kept_.end(), corners_.begin() + begin, corners_.begin() + end);
            ring_ends_[rings++] = static_cast<uint32_t>(kept_.size());
        } else {
            ++counts_.short_holes;
        }
        begin = end;
    }
    ring_ends_.resize(rings);
    corners_.swap(kept_);
    return true;
}

void ObjectBuilder::turn_surface() {
    uint32_t begin = 0;
    for (const uint32_t end : ring_ends_) {
        std::reverse(corners_.begin() + begin, corners_.begin() + end);
        begin = end;
    }
}

void ObjectBuilder::add_triangles(const SurfaceStyle& style) {
    for (const auto& corner : triangles_) {
        Triangle triangle;
        for (size_t k = 0; k < 3; ++k) {
            triangle.vertex[k] = welder_.index_of(object_.vertices, corners_[corner[k]].position);
            if (style.textured) triangle.texcoord[k] = corners_[corner[k]].texcoord;
        }
        triangle.material = style.material.value_or(kByDefault);
        triangle.surface = style.kind;
        const bool flat = triangle.vertex[0] == triangle.vertex[1] || triangle.vertex[1] == triangle.vertex[2] ||
                          triangle.vertex[2] == triangle.vertex[0];
        if (!flat) object_.triangles.push_back(triangle);
    }
}

void ObjectBuilder::end_surface(const SurfaceStyle& style, bool turned) {
    if (object_.triangles.size() >= kMostTriangles) {
        ++counts_.beyond_limit;
        return;
    }
    if (!coordinates_are_sane()) {
        ++counts_.wild;
        return;
    }
    drop_repeated_points();
    if (!keep_real_rings()) {
        ++counts_.short_rings;
        return;
    }
    if (turned) turn_surface();
    triangles_.clear();
    const PolygonOutcome outcome = triangulator_.triangulate(corners_, ring_ends_, triangles_);
    switch (outcome.fault) {
        case PolygonFault::kNone:
            break;
        case PolygonFault::kDegenerate:
            ++counts_.degenerate;
            return;
        case PolygonFault::kTangled:
            ++counts_.tangled;
            return;
        case PolygonFault::kFailed:
            ++counts_.failed;
            return;
    }
    if (outcome.crosses_itself) ++counts_.crossing;
    add_triangles(style);
}

void ObjectBuilder::end_shell(bool cavity) {
    const size_t begin = std::exchange(shell_begin_, object_.triangles.size());
    switch (orient_shell(object_.vertices, std::span(object_.triangles).subspan(begin), cavity)) {
        case ShellRepair::kNone:
            break;
        case ShellRepair::kTurned:
            ++counts_.turned_shells;
            break;
        case ShellRepair::kStraightened:
            ++counts_.straightened_shells;
            break;
    }
}

void ObjectBuilder::infer_kinds() {
    if (object_.kind != ObjectKind::kBuilding) return;
    double foot = std::numeric_limits<double>::infinity();
    for (const Vec3& v : object_.vertices) foot = std::min(foot, v.z);
    constexpr double kSlope = 0.2, kFootMetres = 0.1;
    for (Triangle& t : object_.triangles) {
        if (t.surface != SurfaceKind::kUnknown) continue;
        const Vec3 n = triangle_normal(object_, t);
        const double up = n.z / std::max(length(n), 1e-30);
        const bool at_foot = std::all_of(t.vertex.begin(), t.vertex.end(),
                                         [&](uint32_t v) { return object_.vertices[v].z < foot + kFootMetres; });
        if (up > kSlope)
            t.surface = SurfaceKind::kRoof;
        else if (std::abs(up) <= kSlope)
            t.surface = SurfaceKind::kWall;
        else if (at_foot)
            t.surface = SurfaceKind::kGround;
    }
}

void ObjectBuilder::report_counts() {
    const auto say = [&](uint64_t count, const char* what) {
        if (count > 0) report(std::to_string(count) + what);
    };
    say(counts_.wild, " surface(s) skipped: coordinate is no finite number or beyond 1e9 m");
    say(counts_.short_rings, " surface(s) skipped: ring of fewer than 3 distinct points");
    say(counts_.short_holes, " hole(s) skipped: ring of fewer than 3 distinct points");
    say(counts_.degenerate, " surface(s) skipped: degenerate, no area");
    say(counts_.tangled, " surface(s) skipped: cross themselves too often or have more than 50000 points");
    say(counts_.failed, " surface(s) skipped: cannot be triangulated");
    say(counts_.beyond_limit, " surface(s) skipped: the object has more than 8 million triangles");
    say(counts_.crossing, " surface(s) cross themselves: split by the odd-even rule");
    say(counts_.repeated_points, " repeated point(s) dropped");
    say(counts_.turned_shells, " shell(s) inside out: turned");
    say(counts_.straightened_shells, " shell(s) with surfaces facing both ways: straightened");
}

std::optional<CityObject> ObjectBuilder::finish() {
    report_counts();
    counts_ = {};
    if (object_.triangles.empty()) return std::nullopt;
    infer_kinds();
    for (Triangle& t : object_.triangles) {
        if (t.material == kByDefault) t.material = materials_.by_default(object_.kind, t.surface);
    }
    return std::exchange(object_, {});
}

}  // namespace citystream::tiles::city
