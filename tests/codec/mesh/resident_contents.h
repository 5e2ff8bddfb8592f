// Contents of mesh layers with everything that their form in GPU memory tells apart, and what must come out of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <tuple>
#include <utility>
#include <vector>

#include "codec/chart_word.h"
#include "codec/mesh/mesh_resident.h"
#include "codec/mesh/octahedral.h"
#include "tests/codec/mesh/mesh_cases.h"
#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {

/// What the triangles of a random content are like.
struct ContentKind {
    bool textured = true, smooth = true, dressed = true, prisms = true;
    MeshTopology topology = MeshTopology::kIndices;
    bool constrained = false;
    uint32_t charts = 5, normal_bits = 8;
    std::vector<uint32_t> dropped = {6, 3, 0};
};

inline GridPoint biased(GridPoint point, uint32_t dropped) {
    for (int32_t& c : point) c = (c + kMeshBias) >> dropped << dropped;
    return point;
}

/// Houses with courtyards, floors, walls of other bases and walls that are not there.
inline std::vector<Prism> mixed_prisms(std::mt19937& random, uint32_t houses) {
    std::vector<Prism> prisms;
    for (uint32_t i = 0; i < houses; ++i) {
        const auto x = static_cast<int32_t>(random() % 300000), y = static_cast<int32_t>(random() % 300000);
        std::vector<Ring> rings = {turned_footprint(x, y, 9000, 7000, 0.3 * (i % 7), i % 5)};
        if (i % 11 == 3) rings = {rectangle(x, y, 9000, 8000), courtyard(x + 2000, y + 2000, 3000, 2000)};
        const auto base = static_cast<int32_t>(random() % 5000);
        Prism prism = make_prism(rings, base, base + 3000 + static_cast<int32_t>(random() % 20000), i % 9 == 5);
        for (size_t w = 0; w < prism.walls.size(); ++w) {
            if (w % 2 == 1) prism.walls[w].kind = WallKind::kFalling;
            if (i % 6 == 2 && w == 1) prism.walls[w].base = base + 1500;
            if (i % 8 == 4 && w == 2) prism.walls[w] = {WallKind::kOpen, base};
        }
        prisms.push_back(std::move(prism));
    }
    return prisms;
}

inline Prism with_bias(Prism prism, uint32_t dropped) {
    const auto move = [&](int32_t& c) { c = (c + kMeshBias) >> dropped << dropped; };
    move(prism.base);
    move(prism.top);
    for (PrismWall& wall : prism.walls) move(wall.base);
    for (Ring& ring : prism.rings)
        for (auto& point : ring.points)
            for (int32_t& c : point) move(c);
    return prism;
}

/// `mesh` with attributes of all kinds, and some houses.
inline MeshContent random_content(const GridMesh& mesh, const ContentKind& kind, uint32_t seed) {
    std::mt19937 random(seed);
    MeshContent content;
    content.dropped = kind.dropped;
    content.normal_bits = kind.normal_bits;
    content.topology = kind.topology;
    const auto code = [&] {
        const uint32_t side = 2 * static_cast<uint32_t>(octahedral_side(kind.normal_bits)) + 1;
        const auto u = static_cast<uint32_t>(random() % side), v = static_cast<uint32_t>(random() % side);
        return u | v << kind.normal_bits;
    };
    std::vector<uint32_t> codes;
    for (int i = 0; i < 40; ++i) codes.push_back(code());
    for (const GridPoint& point : mesh.points) content.points.push_back(biased(point, kind.dropped.back()));
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        MeshTriangle& triangle = content.triangles.emplace_back();
        const bool textured = kind.textured && t % 4 != 1;
        triangle.chart_word =
            textured ? static_cast<uint32_t>(t / 9) % kind.charts : colour_word({static_cast<uint8_t>(t / 50), 7, 9});
        triangle.dressed = kind.dressed && t % 5 == 2;
        for (size_t k = 0; k < 3; ++k) {
            MeshCorner& corner = triangle.corners[k];
            corner.point = mesh.triangles[t][k];
            corner.normal = codes[(kind.smooth && t % 3 == 0 ? corner.point : t / 6) % codes.size()];
            const GridPoint& at = mesh.points[corner.point];
            if (textured) corner.texcoord = {at[0] % 30000 - 700, (at[1] + at[2]) % 20000 + 70000};
        }
    }
    if (kind.constrained) {
        for (size_t p = 0; p < content.points.size(); ++p)
            content.most_dropped.push_back(static_cast<uint8_t>(p % 7 == 0 ? 3 + p % 3 : kMeshGridBits));
    }
    if (!kind.prisms) return content;
    for (const Prism& prism : mixed_prisms(random, 60)) {
        const auto i = static_cast<uint8_t>(content.prisms.size() % 3);
        content.prisms.push_back({with_bias(prism, kind.dropped.back()), colour_word({i, 1, 1}),
                                  colour_word({200, i, 1}), prism.has_floor ? colour_word({3, 3, i}) : 0});
    }
    return content;
}

/// What is known of the content with its first `steps` steps.
inline MeshContent with_first_steps(MeshContent content, uint32_t steps) {
    const uint32_t dropped = content.dropped[steps - 1];
    for (size_t p = 0; p < content.points.size(); ++p) {
        const uint32_t own =
            content.most_dropped.empty() ? dropped : std::min<uint32_t>(dropped, content.most_dropped[p]);
        for (int32_t& c : content.points[p]) c = c >> own << own;
    }
    for (MeshPrism& prism : content.prisms) {
        Prism cut = without_low_bits(prism.shape, dropped);
        cut.base = cut.base << dropped;
        cut.top = cut.top << dropped;
        for (PrismWall& wall : cut.walls) wall.base = wall.base << dropped;
        for (Ring& ring : cut.rings)
            for (auto& point : ring.points)
                for (int32_t& c : point) c = c << dropped;
        prism.shape = std::move(cut);
    }
    return content;
}

/// A triangle by all that is drawn of it, turned to its least form; directions as unit vectors cut to 2^-12.
using DrawnCorner = std::tuple<GridPoint, std::array<int32_t, 3>, std::array<int32_t, 2>>;
using DrawnTriangle = std::tuple<std::array<DrawnCorner, 3>, uint32_t, bool>;

inline std::array<int32_t, 3> rounded_direction(const std::array<int32_t, 3>& d) {
    const double length = std::sqrt(double(d[0]) * d[0] + double(d[1]) * d[1] + double(d[2]) * d[2]);
    std::array<int32_t, 3> rounded{};
    for (size_t c = 0; c < 3; ++c) rounded[c] = static_cast<int32_t>(std::lround(d[c] / length * 1024));
    return rounded;
}

inline void add_drawn(std::vector<DrawnTriangle>& list, std::array<DrawnCorner, 3> corners, uint32_t chart,
                      bool dressed) {
    const auto place = [&](size_t k) { return std::get<0>(corners[k]); };
    if (place(0) == place(1) || place(1) == place(2) || place(2) == place(0)) return;
    auto least = corners;
    for (int turn = 0; turn < 2; ++turn) {
        std::rotate(corners.begin(), corners.begin() + 1, corners.end());
        least = std::min(least, corners);
    }
    list.emplace_back(least, chart, dressed);
}

/// What the content means: positions of all bits, triangles without area left out.
inline std::vector<DrawnTriangle> drawn_of(const MeshContent& content) {
    std::vector<DrawnTriangle> list;
    const auto place = [](GridPoint point) {
        for (int32_t& c : point) c -= kMeshBias;
        return point;
    };
    for (const MeshTriangle& triangle : content.triangles) {
        std::array<DrawnCorner, 3> corners;
        for (size_t k = 0; k < 3; ++k) {
            const MeshCorner& corner = triangle.corners[k];
            corners[k] = {place(content.points[corner.point]),
                          rounded_direction(unfold_octahedral(corner.normal, content.normal_bits)), corner.texcoord};
        }
        add_drawn(list, corners, triangle.chart_word, triangle.dressed);
    }
    for (const MeshPrism& prism : content.prisms) {
        // A flat wall shows the same whichever way it is cut, and so does a floor.
        Prism shape = prism.shape;
        for (PrismWall& wall : shape.walls)
            if (wall.kind == WallKind::kFalling) wall.kind = WallKind::kRising;
        for (size_t t = 0; t < shape.floor_triangles.size(); ++t) {
            const auto& top = shape.top_triangles[t];
            shape.floor_triangles[t] = {top[0], top[2], top[1]};
        }
        const GridMesh mesh = join({{shape}, {}});
        for (const auto& t : mesh.triangles) {
            const GridPoint &a = mesh.points[t[0]], &b = mesh.points[t[1]], &c = mesh.points[t[2]];
            const bool level = a[2] == b[2] && b[2] == c[2];
            const std::array<int32_t, 3> normal = level ? std::array<int32_t, 3>{0, 0, a[2] == shape.top ? 1 : -1}
                                                        : std::array<int32_t, 3>{b[1] - a[1], a[0] - b[0], 0};
            const uint32_t chart = !level ? prism.wall_chart : a[2] == shape.top ? prism.top_chart : prism.floor_chart;
            std::array<DrawnCorner, 3> corners;
            for (size_t k = 0; k < 3; ++k) corners[k] = {place(mesh.points[t[k]]), rounded_direction(normal), {0, 0}};
            add_drawn(list, corners, chart, false);
        }
    }
    std::sort(list.begin(), list.end());
    return list;
}

/// A camera that grants no vertex anything.
inline PositionView near_view(uint32_t least_dropped = 0) {
    return {{0, 0, 0}, {0xffffffffu, RESIDENT_CELL_BITS}, least_dropped};
}

inline std::vector<DrawnTriangle> drawn_of(const ResidentMeshView& mesh, const PositionView& view) {
    std::vector<DrawnTriangle> list;
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        std::array<DrawnCorner, 3> corners;
        for (uint32_t k = 0; k < 3; ++k) {
            const ResidentCorner corner = mesh.corner(t, k, view);
            std::array<int32_t, 2> texcoord{};
            mesh.texcoord(t, k, texcoord.data());
            corners[k] = {corner.position, rounded_direction(corner.normal), texcoord};
        }
        add_drawn(list, corners, mesh.chart_word(t), mesh.dressed(t));
    }
    std::sort(list.begin(), list.end());
    return list;
}

}  // namespace citystream::codec::mesh
