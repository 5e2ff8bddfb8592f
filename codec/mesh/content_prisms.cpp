#include "codec/mesh/content_prisms.h"

#include <algorithm>
#include <array>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "codec/mesh/mesh_triangles.h"

namespace citystream::codec::mesh {

namespace {

using Places = std::array<GridPoint, 3>;
constexpr uint32_t kNone = ~uint32_t{0};

/// The same for all turns of a triangle.
Places turned_to_least(const Places& places) {
    Places least = places, turned = places;
    for (int turn = 0; turn < 2; ++turn) {
        std::rotate(turned.begin(), turned.begin() + 1, turned.end());
        least = std::min(least, turned);
    }
    return least;
}

/// Triangles found by their places; each is handed out once, of those at the same places the least chart word first.
class TrianglesByPlace {
  public:
    TrianglesByPlace(const MeshContent& content, std::span<const uint32_t> triangles)
        : taken_(content.triangles.size()) {
        for (const uint32_t t : triangles) {
            Places places;
            for (size_t k = 0; k < places.size(); ++k)
                places[k] = content.points[content.triangles[t].corners[k].point];
            sorted_.emplace_back(turned_to_least(places), content.triangles[t].chart_word, t);
        }
        std::sort(sorted_.begin(), sorted_.end());
    }

    /// One that is not taken, of the colour if one is asked for.
    std::optional<uint32_t> take(const Places& places, std::optional<uint32_t> colour) {
        const Places key = turned_to_least(places);
        for (auto at = std::lower_bound(sorted_.begin(), sorted_.end(), Entry{key, colour.value_or(0), 0});
             at != sorted_.end() && std::get<Places>(*at) == key; ++at) {
            const auto& [at_places, chart, triangle] = *at;
            if (colour && chart != *colour) break;
            if (taken_[triangle]) continue;
            taken_[triangle] = true;
            return triangle;
        }
        return std::nullopt;
    }
    void put_back(std::span<const uint32_t> triangles) {
        for (const uint32_t t : triangles) taken_[t] = false;
    }
    bool taken(size_t triangle) const { return taken_[triangle]; }

  private:
    using Entry = std::tuple<Places, uint32_t, uint32_t>;  ///< chart word, number
    std::vector<Entry> sorted_;
    std::vector<bool> taken_;
};

/// The prism with its colours, if each kind of face has one; its triangles are taken then.
std::optional<MeshPrism> coloured(Prism shape, const MeshContent& content, TrianglesByPlace& triangles) {
    std::array<std::optional<uint32_t>, 3> colours;
    std::vector<uint32_t> taken;
    bool fits = true;
    for_each_prism_triangle(shape, [&](const Places& places, PrismFace face) {
        std::optional<uint32_t>& colour = colours[static_cast<size_t>(face)];
        const auto triangle = fits ? triangles.take(places, colour) : std::nullopt;
        fits = triangle.has_value();
        if (!fits) return;
        taken.push_back(*triangle);
        colour = content.triangles[*triangle].chart_word;
    });
    if (!fits || !colours[0] || !colours[1]) {
        triangles.put_back(taken);
        return std::nullopt;
    }
    return MeshPrism{std::move(shape), *colours[0], *colours[1], colours[2].value_or(0)};
}

/// Whether those of its walls that have a base of their own have one in the bits that the first step has, too: what a
/// layer in GPU memory consists of does not depend on how many steps are known.
bool has_clear_bases(const Prism& shape, uint32_t dropped) {
    return std::all_of(shape.walls.begin(), shape.walls.end(), [&](const PrismWall& wall) {
        return wall.base == shape.base || wall.base >> dropped != shape.base >> dropped;
    });
}

/// Of the given triangles.
PrismSplit split_of(const MeshContent& content, std::span<const uint32_t> triangles) {
    GridMesh mesh{content.points, {}};
    for (const uint32_t t : triangles) {
        const auto& corners = content.triangles[t].corners;
        mesh.triangles.push_back({corners[0].point, corners[1].point, corners[2].point});
    }
    return split_prisms(mesh);
}

/// Leaves out points that no triangle has; the others in order of first use.
void drop_unused_points(MeshContent& content) {
    std::vector<uint32_t> number(content.points.size(), kNone);
    std::vector<GridPoint> points;
    std::vector<uint8_t> most_dropped;
    for (MeshTriangle& triangle : content.triangles) {
        for (MeshCorner& corner : triangle.corners) {
            uint32_t& to = number[corner.point];
            if (to == kNone) {
                to = static_cast<uint32_t>(points.size());
                points.push_back(content.points[corner.point]);
                if (!content.most_dropped.empty()) most_dropped.push_back(content.most_dropped[corner.point]);
            }
            corner.point = to;
        }
    }
    content.points = std::move(points);
    content.most_dropped = std::move(most_dropped);
}

}  // namespace

void take_prisms(MeshContent& content, std::span<const uint8_t> may_be_prism) {
    std::vector<uint32_t> candidates;
    for (uint32_t t = 0; t < content.triangles.size(); ++t) {
        if (may_be_prism[t] != 0) candidates.push_back(t);
    }
    TrianglesByPlace triangles(content, candidates);
    for (Prism& shape : split_of(content, candidates).prisms) {
        if (!has_clear_bases(shape, content.dropped.front())) continue;
        if (auto prism = coloured(std::move(shape), content, triangles)) content.prisms.push_back(std::move(*prism));
    }
    std::vector<MeshTriangle> left;
    for (size_t t = 0; t < content.triangles.size(); ++t) {
        if (!triangles.taken(t)) left.push_back(content.triangles[t]);
    }
    content.triangles = std::move(left);
    drop_unused_points(content);
}

}  // namespace citystream::codec::mesh
