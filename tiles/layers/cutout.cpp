#include "tiles/layers/cutout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <tuple>
#include <vector>

#include "tiles/layers/surface_distance.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildObject;
using quadtree::BuildTriangle;
using quadtree::GridBox;
using quadtree::PaintKind;

constexpr double kOpenShare = 0.25;    // photographs of solid walls have specks of alpha
constexpr double kCoverageLoss = 0.1;  // of what is covered, at most
constexpr double kMostEnlarged = 8;
constexpr int kBisections = 20;
constexpr size_t kMeasuredPairs = 1 << 20;

using Axes = std::array<double, 3>;

struct Face {
    std::vector<size_t> triangles;
    GridBox box;
    Axes area{};  ///< seen along each axis, grid units squared, with its holes
    double there = 1;
    double size() const { return std::hypot(area[0], area[1], area[2]); }
};

Axes extent(const GridBox& box) {
    return {static_cast<double>(box.hi.x - box.lo.x), static_cast<double>(box.hi.y - box.lo.y),
            static_cast<double>(box.hi.z - box.lo.z)};
}

double there_of_paint(const BuildObject& object, uint32_t paint, ImageCache& images) {
    const quadtree::Paint& p = object.paints[paint];
    return p.kind == PaintKind::kMaterial ? images.there_share(p.a) : 1;
}

Axes area_of(const BuildObject& object, const BuildTriangle& triangle) {
    const auto& v = triangle.vertex;
    const auto n = quadtree::triangle_normal(object.vertices[v[0]], object.vertices[v[1]], object.vertices[v[2]]);
    return {std::abs(n[0]) / 2, std::abs(n[1]) / 2, std::abs(n[2]) / 2};
}

std::vector<Face> faces_of(const BuildObject& object, ImageCache& images) {
    std::vector<size_t> parent(object.triangles.size());
    std::iota(parent.begin(), parent.end(), size_t{0});
    const auto root = [&parent](size_t i) {
        while (parent[i] != i) i = parent[i] = parent[parent[i]];
        return i;
    };
    std::map<std::tuple<uint32_t, uint32_t, std::array<int64_t, 2>>, size_t> corners;
    for (size_t i = 0; i < parent.size(); ++i) {
        const BuildTriangle& triangle = object.triangles[i];
        for (size_t k = 0; k < 3; ++k) {
            const auto at = corners.try_emplace({triangle.vertex[k], triangle.paint, triangle.texcoord[k]}, i).first;
            parent[root(i)] = root(at->second);
        }
    }
    std::map<size_t, Face> by_root;
    for (size_t i = 0; i < parent.size(); ++i) {
        Face& face = by_root[root(i)];
        const Axes area = area_of(object, object.triangles[i]);
        for (size_t axis = 0; axis < 3; ++axis) face.area[axis] += area[axis];
        for (const uint32_t v : object.triangles[i].vertex) face.box.add(object.vertices[v]);
        face.there = there_of_paint(object, object.triangles[i].paint, images);
        face.triangles.push_back(i);
    }
    std::vector<Face> faces;
    for (auto& [at, face] : by_root) faces.push_back(std::move(face));
    return faces;
}

/// Faces that are far from each other in place and direction first, after the one that covers most.
std::vector<size_t> spread_order(const std::vector<Face>& faces, size_t count, double radius) {
    const auto distance = [&](const Face& a, const Face& b) {
        const Axes p = {static_cast<double>(a.box.lo.x + a.box.hi.x - b.box.lo.x - b.box.hi.x) / 2,
                        static_cast<double>(a.box.lo.y + a.box.hi.y - b.box.lo.y - b.box.hi.y) / 2,
                        static_cast<double>(a.box.lo.z + a.box.hi.z - b.box.lo.z - b.box.hi.z) / 2};
        const double sizes = a.size() * b.size();
        const double cosine = a.area[0] * b.area[0] + a.area[1] * b.area[1] + a.area[2] * b.area[2];
        return std::hypot(p[0], p[1], p[2]) + radius * (sizes > 0 ? 1 - cosine / sizes : 0);
    };
    std::vector<double> nearest(faces.size(), 1e300);
    std::vector<size_t> order;
    size_t next = 0;
    for (size_t i = 1; i < faces.size(); ++i)
        if (faces[i].size() * faces[i].there > faces[next].size() * faces[next].there) next = i;
    while (order.size() < count) {
        order.push_back(next);
        for (size_t i = 0; i < faces.size(); ++i) nearest[i] = std::min(nearest[i], distance(faces[i], faces[next]));
        for (const size_t i : order) nearest[i] = -1;
        next = static_cast<size_t>(std::max_element(nearest.begin(), nearest.end()) - nearest.begin());
    }
    return order;
}

/// How much a face grows along each axis to have scale^2 of its area: no higher than all of the object.
Axes growth(const Face& face, const Axes& all, double scale) {
    const double height = extent(face.box)[2];
    const double up = height > 0 ? std::min(scale, all[2] / height) : scale;
    return {scale * scale / up, scale * scale / up, up};
}

/// Area that faces cover along the three axes, as if each lay anywhere in the object's bounds.
double coverage(const std::vector<Face>& faces, const std::vector<size_t>& chosen, const Axes& all, double scale) {
    Axes open = {1, 1, 1};
    const Axes side = {all[1] * all[2], all[0] * all[2], all[0] * all[1]};
    for (const size_t i : chosen) {
        const Face& face = faces[i];
        const Axes f = growth(face, all, scale);
        const Axes area = {face.area[0] * f[1] * f[2], face.area[1] * f[0] * f[2], face.area[2] * f[0] * f[1]};
        for (size_t axis = 0; axis < 3; ++axis)
            if (side[axis] > 0) open[axis] *= 1 - face.there * std::min(1.0, area[axis] / side[axis]);
    }
    return side[0] * (1 - open[0]) + side[1] * (1 - open[1]) + side[2] * (1 - open[2]);
}

/// A face enlarged, as far inside the object's bounds as it fits.
void add_enlarged(BuildObject& out, const BuildObject& object, const Face& face, const GridBox& all, double scale) {
    const Axes whole = extent(all), own = extent(face.box), f = growth(face, whole, scale);
    const auto place = [&](size_t axis, int64_t value, int64_t lo, int64_t all_lo) {
        const double size = own[axis] * f[axis], free = whole[axis] - size;
        const double middle = static_cast<double>(lo - all_lo) + (own[axis] - size) / 2;
        const double start = free >= 0 ? std::clamp(middle, 0.0, free) : free / 2;
        return all_lo + std::llround(start + static_cast<double>(value - lo) * f[axis]);
    };
    std::map<uint32_t, uint32_t> renumbered;
    for (const size_t i : face.triangles) {
        BuildTriangle triangle = object.triangles[i];
        for (uint32_t& v : triangle.vertex) {
            const auto [at, is_new] = renumbered.try_emplace(v, static_cast<uint32_t>(out.vertices.size()));
            const GridPoint& p = object.vertices[v];
            if (is_new)
                out.vertices.push_back({place(0, p.x, face.box.lo.x, all.lo.x), place(1, p.y, face.box.lo.y, all.lo.y),
                                        place(2, p.z, face.box.lo.z, all.lo.z)});
            v = at->second;
        }
        triangle.paint = out.paint_index(object.paints[triangle.paint]);
        out.triangles.push_back(triangle);
    }
}

/// The scale at which the chosen faces cover `wanted`; nothing when none does.
std::optional<double> scale_for(const std::vector<Face>& faces, const std::vector<size_t>& chosen, const Axes& all,
                                double wanted) {
    double small = 1, large = kMostEnlarged;
    if (coverage(faces, chosen, all, large) < (1 - kCoverageLoss) * wanted) return std::nullopt;
    for (int i = 0; i < kBisections; ++i) {
        const double middle = (small + large) / 2;
        (coverage(faces, chosen, all, middle) < wanted ? small : large) = middle;
    }
    return large;
}

}  // namespace

bool see_through(const BuildObject& object, ImageCache& images) {
    if (!object.facades.empty()) return false;
    double open = 0, whole = 0;
    for (const BuildTriangle& triangle : object.triangles) {
        const Axes area = area_of(object, triangle);
        const double size = std::hypot(area[0], area[1], area[2]);
        open += size * (1 - there_of_paint(object, triangle.paint, images));
        whole += size;
    }
    return open > 0 && open >= kOpenShare * whole;
}

std::optional<BuildObject> thin_faces(const BuildObject& object, double allowed, ImageCache& images) {
    std::vector<Face> faces = faces_of(object, images);
    // Enlarged trunks would colour the leaves; that they are gone is measured.
    std::erase_if(faces, [](const Face& face) { return face.there >= 1; });
    if (faces.size() <= 2 || allowed <= 0) return std::nullopt;
    const GridBox box = object.box();
    const Axes all = extent(box);
    std::vector<size_t> every(faces.size());
    std::iota(every.begin(), every.end(), size_t{0});
    const double wanted = coverage(faces, every, all, 1);
    const std::vector<size_t> order = spread_order(faces, (faces.size() + 1) / 2, std::hypot(all[0], all[1], all[2]));
    const std::vector<Triangle3> surface = surface_of(object, box.lo);
    const double limit = allowed * kGridUnitsPerMetre;
    for (size_t kept = 2; kept <= order.size(); kept *= 2) {
        const std::vector<size_t> chosen(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept));
        const auto scale = scale_for(faces, chosen, all, wanted);
        if (!scale) continue;
        BuildObject thin;
        thin.kind = object.kind;
        for (const size_t i : chosen) add_enlarged(thin, object, faces[i], box, *scale);
        if (thin.triangles.size() >= object.triangles.size()) continue;
        if (thin.triangles.size() * surface.size() > kMeasuredPairs) return std::nullopt;
        const double distance = surface_distance(surface, surface_of(thin, box.lo), limit);
        if (distance > limit) continue;
        thin.error = object.error + static_cast<float>(distance * kMetresPerGridUnit);
        return thin;
    }
    return std::nullopt;
}

}  // namespace citystream::tiles::layers
