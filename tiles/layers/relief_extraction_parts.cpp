#include "tiles/layers/relief_extraction_parts.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

namespace citystream::tiles::layers::relief {
namespace {

constexpr double kFlatCosine = 0.995;  // of a front's normal with the wall's: the light hardly changes
constexpr double kSideCosine = 0.05;
constexpr double kDeepSideMetres = 0.6;
constexpr double kSpeckHeight = 1e-4;  // metres
constexpr double kRimMetres = 0.01;    // beyond the rectangle
constexpr double kSameLevelMetres = 0.003, kSamePlaneMetres = 0.0005;
constexpr double kNearMetres = 0.5;  // around the volume: what else can cover the relief's sides

Part make_part(const city::CityObject& object, const WallFrame& frame, uint32_t index) {
    Part part;
    part.triangle = index;
    part.vertex = object.triangles[index].vertex;
    part.material = part.look = object.triangles[index].material;
    part.ground = object.triangles[index].surface == city::SurfaceKind::kGround;
    for (size_t k = 0; k < 3; ++k) part.corner[k] = frame.local(object.vertices[object.triangles[index].vertex[k]]);
    const auto& [a, b, c] = part.corner;
    part.low = {std::min({a.u, b.u, c.u}), std::min({a.v, b.v, c.v}), std::min({a.w, b.w, c.w})};
    part.high = {std::max({a.u, b.u, c.u}), std::max({a.v, b.v, c.v}), std::max({a.w, b.w, c.w})};
    const Point twice = cross(b - a, c - a);
    const double size = length(twice);
    part.area = size / 2;
    if (size > 0) part.normal = twice * (1 / size);
    return part;
}

PartKind kind_of(const Part& part, city::SurfaceKind surface, const WallFrame& frame, bool taken, double behind,
                 const ReliefExtractionOptions& options) {
    const bool inside = part.low.w >= -behind && part.high.w <= options.depth_before && part.low.u >= -kRimMetres &&
                        part.low.v >= -kRimMetres && part.high.u <= frame.width + kRimMetres &&
                        part.high.v <= frame.height + kRimMetres;
    if (taken || !inside) return PartKind::kOutside;
    const double longest = std::max({length(part.corner[1] - part.corner[0]), length(part.corner[2] - part.corner[1]),
                                     length(part.corner[0] - part.corner[2])});
    if (part.area * 2 <= longest * kSpeckHeight) return PartKind::kSpeck;
    if (part.normal.w > kFlatCosine && part.high.w - part.low.w <= 2 * options.tolerance) return PartKind::kFlat;
    if (std::abs(part.normal.w) >= kSideCosine) return PartKind::kOther;
    // What runs far along the depth is a wall of its own, with relief of its own.
    const bool wall = surface == city::SurfaceKind::kWall && part.high.w - part.low.w > kDeepSideMetres;
    return wall ? PartKind::kOther : PartKind::kSide;
}

bool comes_near(const Part& part, const WallFrame& frame, double behind, double before) {
    return part.high.u >= -kNearMetres && part.low.u <= frame.width + kNearMetres && part.high.v >= -kNearMetres &&
           part.low.v <= frame.height + kNearMetres && part.high.w >= -behind - kNearMetres &&
           part.low.w <= before + kNearMetres;
}

/// Sets of flat parts, joined over common edges.
class Joiner {
  public:
    Joiner(const city::CityObject& object, std::vector<Part>& parts) : object_(object), parts_(parts) {
        above_.resize(parts.size());
        std::iota(above_.begin(), above_.end(), 0U);
    }

    uint32_t root(uint32_t i) {
        while (above_[i] != i) i = above_[i] = above_[above_[i]];
        return i;
    }

    void join_over_edges() {
        struct Edge {
            uint32_t a, b, part;
        };
        std::vector<Edge> edges;
        for (uint32_t i = 0; i < parts_.size(); ++i) {
            if (parts_[i].kind != PartKind::kFlat) continue;
            const auto& vertex = object_.triangles[parts_[i].triangle].vertex;
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t a = vertex[k], b = vertex[(k + 1) % 3];
                edges.push_back({std::min(a, b), std::max(a, b), i});
            }
        }
        std::sort(edges.begin(), edges.end(),
                  [](const Edge& x, const Edge& y) { return std::tie(x.a, x.b, x.part) < std::tie(y.a, y.b, y.part); });
        for (size_t i = 1; i < edges.size(); ++i) {
            const Edge &x = edges[i - 1], &y = edges[i];
            if (x.a == y.a && x.b == y.b && parts_[x.part].material == parts_[y.part].material)
                above_[root(y.part)] = root(x.part);
        }
    }

  private:
    const city::CityObject& object_;
    std::vector<Part>& parts_;
    std::vector<uint32_t> above_;
};

void grow(Patch& patch, const Part& part) {
    const double depth = (part.corner[0].w + part.corner[1].w + part.corner[2].w) / 3;
    patch.depth = (patch.depth * patch.area + depth * part.area) / (patch.area + part.area);
    patch.low = patch.area == 0 ? part.low
                                : Point{std::min(patch.low.u, part.low.u), std::min(patch.low.v, part.low.v),
                                        std::min(patch.low.w, part.low.w)};
    patch.high = patch.area == 0 ? part.high
                                 : Point{std::max(patch.high.u, part.high.u), std::max(patch.high.v, part.high.v),
                                         std::max(patch.high.w, part.high.w)};
    patch.area += part.area;
    patch.material = part.material;
}

double deviation(const Patch& patch, double depth) {
    return std::max(patch.high.w - depth, depth - patch.low.w);
}

/// Patches of joined parts; where these are not flat together, each part for itself.
void make_patches(const city::CityObject& object, FacadeParts& facade, double tolerance) {
    Joiner joiner(object, facade.parts);
    joiner.join_over_edges();
    std::map<uint32_t, std::vector<uint32_t>> sets;
    for (uint32_t i = 0; i < facade.parts.size(); ++i) {
        if (facade.parts[i].kind == PartKind::kFlat) sets[joiner.root(i)].push_back(i);
    }
    const double most = tolerance - kSameLevelMetres;
    for (const auto& [root, members] : sets) {
        Patch whole;
        for (const uint32_t i : members) grow(whole, facade.parts[i]);
        const bool flat = deviation(whole, whole.depth) <= most;
        if (flat) facade.patches.push_back(whole);
        for (const uint32_t i : members) {
            Part& part = facade.parts[i];
            if (!flat) {
                Patch single;
                grow(single, part);
                if (deviation(single, single.depth) > most) {
                    part.kind = PartKind::kOther;
                    continue;
                }
                facade.patches.push_back(single);
            }
            part.patch = static_cast<uint32_t>(facade.patches.size()) - 1;
        }
    }
}

/// Patches in one plane but for rounding get exactly one depth.
void settle_depths(std::vector<Patch>& patches, const std::vector<uint32_t>& by_depth) {
    double begin = -1e300, depth = 0;
    for (const uint32_t i : by_depth) {
        if (patches[i].depth - begin > kSamePlaneMetres) begin = depth = patches[i].depth;
        patches[i].depth = depth;
    }
}

/// Patches that differ by less than kSameLevelMetres get one level.
void settle_levels(std::vector<Patch>& patches) {
    std::vector<uint32_t> order(patches.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return patches[a].depth < patches[b].depth; });
    settle_depths(patches, order);
    for (size_t begin = 0; begin < order.size();) {
        size_t end = begin;
        double area = 0, sum = 0;
        while (end < order.size() && patches[order[end]].depth - patches[order[begin]].depth <= kSameLevelMetres) {
            const Patch& patch = patches[order[end++]];
            area += patch.area;
            sum += patch.area * patch.depth;
        }
        const auto level = static_cast<int32_t>(std::lround(sum / area * 1000));
        for (size_t i = begin; i < end; ++i) {
            Patch& patch = patches[order[i]];
            patch.level_mm = level;
            patch.error = deviation(patch, level * 0.001);
        }
        begin = end;
    }
}

}  // namespace

std::vector<OutlineEdge> outlines(const FacadeParts& facade) {
    struct Edge {
        uint32_t patch, a, b, part, corner;
    };
    std::vector<Edge> edges;
    for (uint32_t i = 0; i < facade.parts.size(); ++i) {
        const Part& part = facade.parts[i];
        if (part.kind != PartKind::kFlat) continue;
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t a = part.vertex[k], b = part.vertex[(k + 1) % 3];
            edges.push_back({part.patch, std::min(a, b), std::max(a, b), i, k});
        }
    }
    const auto key = [](const Edge& e) { return std::tie(e.patch, e.a, e.b); };
    std::sort(edges.begin(), edges.end(), [&](const Edge& x, const Edge& y) {
        return std::tie(x.patch, x.a, x.b, x.part) < std::tie(y.patch, y.a, y.b, y.part);
    });
    std::vector<OutlineEdge> alone;
    for (size_t i = 0; i < edges.size(); ++i) {
        const bool shared = (i > 0 && key(edges[i - 1]) == key(edges[i])) ||
                            (i + 1 < edges.size() && key(edges[i + 1]) == key(edges[i]));
        if (shared) continue;
        const auto& corner = facade.parts[edges[i].part].corner;
        alone.push_back({edges[i].patch, corner[edges[i].corner], corner[(edges[i].corner + 1) % 3]});
    }
    return alone;
}

FacadeParts gather_parts(const city::CityObject& object, const WallFrame& frame, std::span<const uint8_t> taken,
                         double depth_behind, const ReliefExtractionOptions& options) {
    FacadeParts facade;
    for (uint32_t i = 0; i < object.triangles.size(); ++i) {
        Part part = make_part(object, frame, i);
        if (!comes_near(part, frame, depth_behind, options.depth_before)) continue;
        part.kind = kind_of(part, object.triangles[i].surface, frame, taken[i] != 0, depth_behind, options);
        facade.parts.push_back(part);
    }
    make_patches(object, facade, options.tolerance);
    settle_levels(facade.patches);
    return facade;
}

}  // namespace citystream::tiles::layers::relief
