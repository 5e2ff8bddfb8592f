#include "tiles/layers/block.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tiles/layers/cutout.h"
#include "tiles/layers/outline.h"
#include "tiles/layers/surface_distance.h"

namespace citystream::tiles::layers {
namespace {

using quadtree::BuildFacade;
using quadtree::BuildObject;
using quadtree::BuildTriangle;
using quadtree::GridBox;
using quadtree::Paint;
using quadtree::PaintKind;

constexpr double kRoofSlope = 0.5;
constexpr size_t kFacadeTriangles = 2;
constexpr size_t kMeasuredPairs = 1 << 18;  // triangles times triangles; beyond it an object is left to decimation
constexpr size_t kDirections = 24;
constexpr double kAnyDistance = 1e9;  // metres: what a crowd loses is told, not limited

/// Sum of colours in linear light.
struct ColourSum {
    std::array<double, 3> sum{};
    double weight = 0;
    void add(const std::array<uint8_t, 3>& rgb, double w) {
        for (size_t c = 0; c < 3; ++c) sum[c] += w * static_cast<double>(srgb_to_linear(rgb[c]));
        weight += w;
    }
    std::array<uint8_t, 3> mean() const {
        std::array<uint8_t, 3> out = {180, 180, 180};
        for (size_t c = 0; c < 3 && weight > 0; ++c) out[c] = linear_to_srgb(static_cast<float>(sum[c] / weight));
        return weight > 0 ? rounded_colour(out) : out;
    }
};

std::array<uint8_t, 3> colour_of(const Paint& paint, ImageCache& images, FacadePainter& facades) {
    switch (paint.kind) {
        case PaintKind::kMaterial:
            return images.mean_colour(paint.a);
        case PaintKind::kFacade:
            return facades.mean_colour(paint.a, paint.b);
        default:
            return paint.rgb();
    }
}

double length_of(const std::array<double, 3>& n) {
    return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

std::array<double, 3> normal_of(const BuildObject& object, const BuildTriangle& triangle) {
    return quadtree::triangle_normal(object.vertices[triangle.vertex[0]], object.vertices[triangle.vertex[1]],
                                     object.vertices[triangle.vertex[2]]);
}

/// Mean height of what faces up, weighted by its area seen from above.
std::optional<int64_t> mean_top(const BuildObject& object) {
    double sum = 0, weight = 0;
    for (const BuildTriangle& triangle : object.triangles) {
        const auto n = normal_of(object, triangle);
        if (n[2] <= 0.3 * length_of(n)) continue;
        double z = 0;
        for (uint32_t v : triangle.vertex) z += static_cast<double>(object.vertices[v].z) / 3;
        sum += n[2] * z;
        weight += n[2];
    }
    if (weight <= 0) return std::nullopt;
    return std::llround(sum / weight);
}

void add_triangle(BuildObject& object, uint32_t a, uint32_t b, uint32_t c, uint32_t paint, city::SurfaceKind surface) {
    BuildTriangle triangle;
    triangle.vertex = {a, b, c};
    triangle.paint = paint;
    triangle.surface = surface;
    object.triangles.push_back(triangle);
}

/// Walls around an outline and a roof on it. False when the outline cannot be cut into triangles.
bool extrude(BuildObject& block, const Outline& outline, const GridPoint& origin, int64_t bottom, int64_t top,
             const BlockColours& colours) {
    const std::vector<uint32_t> roof = triangulate_outline(outline);
    if (roof.empty()) return false;
    const uint32_t wall_paint = block.paint_index(Paint::flat(colours.wall)),
                   roof_paint = block.paint_index(Paint::flat(colours.roof));
    const auto base = static_cast<uint32_t>(block.vertices.size()), n = static_cast<uint32_t>(outline.size());
    for (const OutlinePoint& p : outline) {
        block.vertices.push_back({origin.x + p[0], origin.y + p[1], bottom});
        block.vertices.push_back({origin.x + p[0], origin.y + p[1], top});
    }
    for (uint32_t i = 0; i < n; ++i) {
        const uint32_t a = base + 2 * i, b = base + 2 * ((i + 1) % n);
        add_triangle(block, a, b, b + 1, wall_paint, city::SurfaceKind::kWall);
        add_triangle(block, a, b + 1, a + 1, wall_paint, city::SurfaceKind::kWall);
    }
    for (size_t i = 0; i + 2 < roof.size(); i += 3) {
        add_triangle(block, base + 2 * roof[i] + 1, base + 2 * roof[i + 1] + 1, base + 2 * roof[i + 2] + 1, roof_paint,
                     city::SurfaceKind::kRoof);
    }
    return true;
}

/// The rectangle around everything, sides along the object's longest edges.
Outline box_outline(const BuildObject& object, const GridPoint& origin) {
    std::vector<OutlinePoint> points, directions;
    std::map<OutlinePoint, bool> seen;
    const auto add = [&](const GridPoint& p) {
        if (seen.try_emplace({p.x - origin.x, p.y - origin.y}, true).second)
            points.push_back({p.x - origin.x, p.y - origin.y});
    };
    for (const GridPoint& p : object.vertices) add(p);
    for (const BuildFacade& facade : object.facades) {
        for (const GridPoint& p : facade.corners()) add(p);
        directions.push_back({facade.along[0], facade.along[1]});
    }
    for (const BuildTriangle& triangle : object.triangles) {
        for (size_t k = 0; k < 3; ++k) {
            const GridPoint& p = object.vertices[triangle.vertex[k]];
            const GridPoint& q = object.vertices[triangle.vertex[(k + 1) % 3]];
            if (p.x != q.x || p.y != q.y) directions.push_back({q.x - p.x, q.y - p.y});
        }
    }
    const auto length = [](const OutlinePoint& d) { return d[0] * d[0] + d[1] * d[1]; };
    std::stable_sort(directions.begin(), directions.end(),
                     [&](const OutlinePoint& a, const OutlinePoint& b) { return length(a) > length(b); });
    if (directions.size() > kDirections) directions.resize(kDirections);
    directions.push_back({1, 0});
    return oriented_box(points, directions);
}

BuildObject empty_block(const BuildObject& object) {
    BuildObject block;
    block.kind = object.kind;
    block.block = true;
    return block;
}

std::optional<BuildObject> outline_block(const BuildObject& object, double tolerance, int64_t top, const GridBox& box,
                                         const BlockColours& colours) {
    BuildObject block = empty_block(object);
    for (Outline& outline : roof_outlines(object, box.lo)) {
        if (doubled_area(outline) <= 2 * tolerance * tolerance)
            continue;  // holes and specks; the measurement says whether they may go
        simplify_outline(outline, tolerance);
        if (!extrude(block, outline, box.lo, box.lo.z, top, colours)) return std::nullopt;
    }
    if (block.triangles.empty()) return std::nullopt;
    return block;
}

struct CrowdMember {
    size_t object = 0;
    GridBox box;
};

double footprint_area(const GridBox& box) {
    return static_cast<double>(box.hi.x - box.lo.x) * static_cast<double>(box.hi.y - box.lo.y);
}

/// Greatest distance of a corner of box a to box b as a solid.
double corner_distance(const GridBox& a, const GridBox& b) {
    const auto reach = [](int64_t lo, int64_t hi, int64_t l, int64_t h) {
        return static_cast<double>(std::max<int64_t>({0, l - lo, hi - h}));
    };
    return std::hypot(reach(a.lo.x, a.hi.x, b.lo.x, b.hi.x), reach(a.lo.y, a.hi.y, b.lo.y, b.hi.y),
                      reach(a.lo.z, a.hi.z, b.lo.z, b.hi.z));
}

/// Distance of a corner of a box to the nearest of the members as solids, greatest over the corners.
double distance_to_members(const GridBox& box, const std::vector<CrowdMember>& members) {
    double worst = 0;
    for (uint32_t i = 0; i < 8; ++i) {
        const GridPoint p = {(i & 1U) != 0 ? box.hi.x : box.lo.x, (i & 2U) != 0 ? box.hi.y : box.lo.y,
                             (i & 4U) != 0 ? box.hi.z : box.lo.z};
        double nearest = 1e300;
        for (const CrowdMember& member : members) nearest = std::min(nearest, corner_distance({p, p}, member.box));
        worst = std::max(worst, nearest);
    }
    return worst;
}

BuildObject crowd_box(const std::vector<BuildObject>& objects, const std::vector<CrowdMember>& members,
                      ImageCache& images, FacadePainter& facades) {
    double area = 0, x = 0, y = 0, height = 0;
    GridBox all;
    ColourSum walls, roofs;
    float error = 0;
    for (const CrowdMember& member : members) {
        const GridBox& b = member.box;
        const double a = std::max(footprint_area(b), 1.0);
        area += a;
        x += a * static_cast<double>(b.lo.x - members[0].box.lo.x + b.hi.x - members[0].box.lo.x) / 2;
        y += a * static_cast<double>(b.lo.y - members[0].box.lo.y + b.hi.y - members[0].box.lo.y) / 2;
        height += a * static_cast<double>(b.hi.z - b.lo.z);
        all.add(b);
        const BlockColours colours = mean_colours(objects[member.object], images, facades);
        walls.add(colours.wall, a);
        roofs.add(colours.roof, a);
        error = std::max(error, objects[member.object].error);
    }
    const auto half = static_cast<int64_t>(std::sqrt(area) / 2) + 1;
    const GridPoint centre = {members[0].box.lo.x + std::llround(x / area),
                              members[0].box.lo.y + std::llround(y / area), all.lo.z};
    const int64_t top = all.lo.z + std::max<int64_t>(1, std::llround(height / area));
    BuildObject box = empty_block(objects[members[0].object]);
    extrude(box, {{-half, -half}, {half, -half}, {half, half}, {-half, half}}, centre, all.lo.z, top,
            {walls.mean(), roofs.mean()});
    const GridBox bounds = box.box();
    double reached = distance_to_members(bounds, members);
    for (const CrowdMember& member : members) reached = std::max(reached, corner_distance(member.box, bounds));
    box.error = error + static_cast<float>(reached * kMetresPerGridUnit);
    return box;
}

/// All triangles of the members in one object, to be thinned together.
BuildObject joined(const std::vector<BuildObject>& objects, const std::vector<CrowdMember>& members) {
    BuildObject all;
    all.kind = objects[members[0].object].kind;
    for (const CrowdMember& member : members) {
        const BuildObject& object = objects[member.object];
        const auto base = static_cast<uint32_t>(all.vertices.size());
        all.vertices.insert(all.vertices.end(), object.vertices.begin(), object.vertices.end());
        for (BuildTriangle triangle : object.triangles) {
            for (uint32_t& v : triangle.vertex) v += base;
            triangle.paint = all.paint_index(object.paints[triangle.paint]);
            all.triangles.push_back(triangle);
        }
        all.error = std::max(all.error, object.error);
    }
    return all;
}

}  // namespace

BlockColours mean_colours(const BuildObject& object, ImageCache& images, FacadePainter& facades) {
    ColourSum walls, roofs;
    for (const BuildTriangle& triangle : object.triangles) {
        const auto n = normal_of(object, triangle);
        const Paint& paint = object.paints[triangle.paint];
        const double area = length_of(n) * (paint.kind == PaintKind::kMaterial ? images.there_share(paint.a) : 1);
        const auto rgb = colour_of(paint, images, facades);
        if (std::abs(n[2]) < kRoofSlope * length_of(n)) walls.add(rgb, area);
        if (n[2] >= kRoofSlope * length_of(n)) roofs.add(rgb, area);
    }
    for (const BuildFacade& facade : object.facades) {
        const double area = 2 * std::hypot(facade.along[0], facade.along[1]) * facade.height;
        walls.add(facades.mean_colour(facade.map, facade.palette), area);
    }
    if (roofs.weight <= 0) roofs = walls;
    if (walls.weight <= 0) walls = roofs;
    return {walls.mean(), roofs.mean()};
}

std::optional<BuildObject> make_block(const BuildObject& object, double allowed, ImageCache& images,
                                      FacadePainter& facades) {
    const size_t triangles = object.triangles.size() + kFacadeTriangles * object.facades.size();
    // What is measured takes facades as flat, so their relief is lost on top of it.
    double relief = 0;
    for (const BuildFacade& facade : object.facades) relief = std::max(relief, facades.facts(facade.map).flat_loss());
    const double limit = (allowed - relief) * kGridUnitsPerMetre;
    if (limit <= 0) return std::nullopt;
    if (triangles <= 10) return std::nullopt;  // a box has ten: four walls and a roof
    const GridBox box = object.box();
    const auto top = mean_top(object);
    // A block this low or this far from the highest point is out before anything is measured.
    if (!top || *top <= box.lo.z || static_cast<double>(box.hi.z - *top) > limit * 1.5) return std::nullopt;
    const BlockColours colours = mean_colours(object, images, facades);
    const std::vector<Triangle3> surface = surface_of(object, box.lo);
    std::optional<BuildObject> best;
    const auto consider = [&](std::optional<BuildObject> block) {
        if (!block || block->triangles.size() >= (best ? best->triangles.size() : triangles)) return;
        if (block->triangles.size() * surface.size() > kMeasuredPairs) return;
        const double distance = surface_distance(surface, surface_of(*block, box.lo), limit);
        if (distance > limit) return;
        block->error = object.error + static_cast<float>(distance * kMetresPerGridUnit + relief);
        best = std::move(block);
    };
    BuildObject rectangle = empty_block(object);
    if (extrude(rectangle, box_outline(object, box.lo), box.lo, box.lo.z, *top, colours))
        consider(std::move(rectangle));
    if (!best) consider(outline_block(object, limit * 0.8, *top, box, colours));
    if (!best) consider(outline_block(object, limit * 0.3, *top, box, colours));
    return best;
}

void merge_crowds(std::vector<BuildObject>& objects, int64_t cell, ImageCache& images, FacadePainter& facades) {
    struct Cell {
        int64_t y, x;
        bool see_through;
        auto operator<=>(const Cell&) const = default;
    };
    std::map<Cell, std::vector<CrowdMember>> cells;
    const auto cell_of = [cell](int64_t a, int64_t b) {
        const int64_t middle = a + (b - a) / 2;
        return middle >= 0 ? middle / cell : (middle + 1) / cell - 1;
    };
    for (size_t i = 0; i < objects.size(); ++i) {
        if (objects[i].ground()) continue;
        const GridBox box = objects[i].box();
        if (box.hi.x - box.lo.x >= cell || box.hi.y - box.lo.y >= cell || box.hi.z - box.lo.z >= cell) continue;
        cells[{cell_of(box.lo.y, box.hi.y), cell_of(box.lo.x, box.hi.x), see_through(objects[i], images)}].push_back(
            {i, box});
    }
    std::vector<bool> gone(objects.size());
    std::vector<BuildObject> merged;
    for (const auto& [at, members] : cells) {
        if (members.size() < 2) continue;
        if (at.see_through) {
            BuildObject all = joined(objects, members);
            auto thin = thin_faces(all, kAnyDistance, images);
            merged.push_back(thin ? std::move(*thin) : std::move(all));
        } else {
            merged.push_back(crowd_box(objects, members, images, facades));
        }
        for (const CrowdMember& member : members) gone[member.object] = true;
    }
    std::vector<BuildObject> kept;
    for (size_t i = 0; i < objects.size(); ++i) {
        if (!gone[i]) kept.push_back(std::move(objects[i]));
    }
    kept.insert(kept.end(), std::make_move_iterator(merged.begin()), std::make_move_iterator(merged.end()));
    objects = std::move(kept);
}

}  // namespace citystream::tiles::layers
