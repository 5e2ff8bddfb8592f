// Mesh layers' contents for tests: awkward ones, made-up towns, and what makes two of them the same.
#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "codec/chart_word.h"
#include "codec/mesh/mesh_content.h"
#include "codec/mesh/octahedral_residual.h"
#include "tests/codec/mesh/mesh_cases.h"
#include "tests/codec/mesh/prism_meshes.h"

namespace citystream::codec::mesh {

struct ContentCase {
    std::string name;
    MeshContent content;
};

/// Triangles of a mesh with attributes: some dressed, colours and charts in patches, texture coordinates by place, most
/// triangles of one normal.
inline MeshContent dressed_content(const GridMesh& mesh, uint32_t seed) {
    std::mt19937 random(seed);
    MeshContent content;
    content.points = mesh.points;
    uint32_t chart = 0, charts = 0;
    for (const auto& t : mesh.triangles) {
        MeshTriangle triangle;
        if (random() % 3 == 0) chart = random() % 2 == 0 ? charts++ : colour_word({200, uint8_t(random() % 3), 9});
        triangle.chart_word = chart;
        triangle.dressed = random() % 4 == 0;
        const auto normal = static_cast<uint32_t>(random());
        for (size_t c = 0; c < 3; ++c) {
            MeshCorner& corner = triangle.corners[c];
            corner.point = t[c];
            corner.normal = (random() % 8 == 0 ? static_cast<uint32_t>(random()) : normal) & 0xffff;
            if (names_colour(chart)) continue;
            const GridPoint& at = mesh.points[t[c]];
            corner.texcoord = {at[0] % 100000 * 64 + (random() % 9 == 0 ? 64 : 0), int32_t(random() % 2) << 16};
        }
        content.triangles.push_back(triangle);
    }
    return content;
}

/// Coloured prisms with and without floors, and a few triangles beside.
inline MeshContent prism_content(int count) {
    MeshContent content = dressed_content(town_mesh(2, 3), 7);
    for (int i = 0; i < count; ++i) {
        const bool floor = i % 3 == 0;
        std::vector<Ring> rings = {rectangle(20000 * i, 3000 * (i % 5), 9000 + 100 * i, 8000)};
        if (i % 4 == 1) rings.push_back(courtyard(20000 * i + 3000, 3000 * (i % 5) + 2000, 2000, 3000));
        content.prisms.push_back({make_prism(std::move(rings), -100 * i, 3000 + 700 * (i % 7), floor),
                                  colour_word({uint8_t(i % 3), 1, 2}), colour_word({9, 9, uint8_t(i / 4)}),
                                  floor ? colour_word({1, 1, 1}) : 0});
    }
    return content;
}

/// Limits of 0..most bits, the same for points at one place.
inline void limit_points(MeshContent& content, uint32_t most) {
    for (const GridPoint& p : content.points)
        content.most_dropped.push_back(
            static_cast<uint8_t>(static_cast<uint32_t>(p[0] * 7 + p[1] * 3 + p[2]) / 8 % (most + 1)));
}

inline std::vector<ContentCase> awkward_contents() {
    std::vector<ContentCase> cases;
    uint32_t seed = 0;
    for (const MeshCase& c : awkward_meshes()) {
        ContentCase one{c.name, dressed_content(c.mesh, ++seed)};
        one.content.dropped = {6, 3, 0};
        one.content.topology = static_cast<MeshTopology>(seed % 3);
        cases.push_back(std::move(one));
    }
    cases.push_back({"prisms", prism_content(30)});
    cases.back().content.dropped = {7, 4};
    cases.push_back({"prisms alone", prism_content(9)});
    cases.back().content.triangles.clear();
    cases.push_back({"limited points", dressed_content(town_mesh(5, 2), 5)});
    cases.back().content.dropped = {11, 8, 5, 2};
    limit_points(cases.back().content, 12);
    return cases;
}

/// One triangle of a content as what has to be kept of it.
using ToldTriangle = std::vector<int64_t>;

/// All triangles with the coordinates that are left after step `step`, each turned to its least form, sorted.
inline std::vector<ToldTriangle> told_triangles(const MeshContent& content, size_t step) {
    const uint32_t dropped = content.dropped[step];
    std::vector<ToldTriangle> triangles;
    for (const MeshTriangle& t : content.triangles) {
        std::array<ToldTriangle, 3> corners;
        for (size_t c = 0; c < 3; ++c) {
            const MeshCorner& corner = t.corners[c];
            const uint32_t most = content.most_dropped.empty() ? dropped : content.most_dropped[corner.point];
            for (const int32_t v : content.points[corner.point])
                corners[c].push_back((v >> std::min(dropped, most)) * (int64_t{1} << std::min(dropped, most)));
            corners[c].push_back(static_cast<int64_t>(canonical_octahedral(corner.normal, content.normal_bits)));
            for (const int32_t v : corner.texcoord) corners[c].push_back(names_colour(t.chart_word) ? 0 : v);
            if (!content.most_dropped.empty()) corners[c].push_back(most);
        }
        auto least = corners;
        for (int turn = 0; turn < 2; ++turn) {
            std::rotate(corners.begin(), corners.begin() + 1, corners.end());
            least = std::min(least, corners);
        }
        ToldTriangle told = {t.chart_word, t.dressed ? 1 : 0};
        for (const ToldTriangle& corner : least) told.insert(told.end(), corner.begin(), corner.end());
        triangles.push_back(std::move(told));
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

/// All triangles of prisms by their corners and colours, with the coordinates that are left after step `step`, sorted.
inline std::vector<ToldTriangle> told_prisms(const MeshContent& content, size_t step) {
    std::vector<ToldTriangle> triangles;
    for (const MeshPrism& prism : content.prisms) {
        PrismSplit one;
        one.prisms = {without_low_bits(prism.shape, content.dropped[step])};
        for (const Corners& corners : sorted_triangles(join(one))) {
            ToldTriangle told = {prism.wall_chart, prism.top_chart, prism.shape.has_floor ? prism.floor_chart : 0};
            for (const GridPoint& p : corners) told.insert(told.end(), p.begin(), p.end());
            triangles.push_back(std::move(told));
        }
    }
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

}  // namespace citystream::codec::mesh
