#include "codec/mesh/mesh_content_make.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <map>
#include <utility>
#include <vector>

#include "codec/chart_word.h"
#include "codec/mesh/chart_texcoords.h"
#include "codec/mesh/content_constraint.h"
#include "codec/mesh/content_prisms.h"
#include "codec/mesh/flat_normals.h"
#include "codec/mesh/position_error.h"

namespace citystream::codec::mesh {

namespace {

GridPoint biased(const MeshVertex& vertex) {
    GridPoint point{};
    for (size_t c = 0; c < 3; ++c) point[c] = vertex.position[c] + kMeshBias;
    return point;
}

/// Bits of the largest distance from the corner of the step's cells that the lowest point lies in.
uint32_t extent_bits(const std::vector<GridPoint>& points, uint32_t dropped) {
    uint32_t bits = 0;
    for (size_t c = 0; c < 3; ++c) {
        const auto [low, high] = std::minmax_element(
            points.begin(), points.end(), [&](const GridPoint& a, const GridPoint& b) { return a[c] < b[c]; });
        if (low == points.end()) continue;
        const int64_t origin = (*low)[c] >> dropped << dropped;
        bits = std::max(bits, static_cast<uint32_t>(std::bit_width(static_cast<uint64_t>((*high)[c] - origin))));
    }
    return bits;
}

std::vector<uint32_t> choose_steps(const std::vector<GridPoint>& points, const MeshContentOptions& options) {
    const uint32_t finest = std::min(finest_dropped(options.finest_error_metres), options.most_dropped);
    std::vector<uint32_t> dropped = {finest};
    for (uint32_t s = 1; s < options.most_steps; ++s) {
        const uint32_t coarser = finest + s * kMeshStepBits;
        if (coarser > options.most_dropped || extent_bits(points, coarser) <= coarser) break;
        dropped.insert(dropped.begin(), coarser);
    }
    return dropped;
}

/// Numbers of places in order of first use.
class Welder {
  public:
    Welder(MeshContent& content, uint32_t dropped) : content_(content), dropped_(dropped) {}
    uint32_t number_of(GridPoint point) {
        for (int32_t& c : point) c = c >> dropped_ << dropped_;
        const auto [at, added] = numbers_.try_emplace(point, static_cast<uint32_t>(content_.points.size()));
        if (added) content_.points.push_back(point);
        return at->second;
    }

  private:
    MeshContent& content_;
    uint32_t dropped_;
    std::map<GridPoint, uint32_t> numbers_;
};

bool has_equal_corners(const std::array<GridPoint, 3>& places) {
    return places[0] == places[1] || places[1] == places[2] || places[2] == places[0];
}

/// Whether corners that are apart fall on one another where the lowest bits are cut off.
bool is_folded_by_cut(std::array<GridPoint, 3> places, uint32_t dropped) {
    if (has_equal_corners(places)) return false;
    for (GridPoint& place : places) {
        for (int32_t& c : place) c = c >> dropped << dropped;
    }
    return has_equal_corners(places);
}

/// Fills points and triangles; says of each triangle whether it may be part of a prism.
std::vector<uint8_t> add_triangles(MeshContent& content, const MeshTile& tile) {
    const ChartTexcoords texcoords(tile);
    Welder welder(content, content.dropped.back());
    std::vector<uint8_t> may_be_prism;
    for (uint32_t t = 0; t < tile.triangle_chart.size(); ++t) {
        MeshTriangle triangle;
        triangle.chart_word = tile.triangle_chart[t];
        triangle.dressed = t >= tile.dressed_begin;
        std::array<GridPoint, 3> places;
        std::array<Direction, 3> given;
        for (size_t k = 0; k < 3; ++k) {
            const MeshVertex& vertex = tile.vertices[tile.indices[3 * size_t{t} + k]];
            places[k] = biased(vertex);
            given[k] = {vertex.normal[0], vertex.normal[1], vertex.normal[2]};
            triangle.corners[k].texcoord = texcoords.rounded(triangle.chart_word, vertex.texcoord);
        }
        if (is_folded_by_cut(places, content.dropped.back())) continue;
        const TriangleNormals normals =
            triangle_normals(places, given, content.normal_bits, content.dropped.front(), content.dropped.back());
        for (size_t k = 0; k < 3; ++k) {
            triangle.corners[k].point = welder.number_of(places[k]);
            triangle.corners[k].normal = normals.codes[k];
        }
        content.triangles.push_back(triangle);
        may_be_prism.push_back(normals.of_plane && !triangle.dressed && names_colour(triangle.chart_word) ? 1 : 0);
    }
    return may_be_prism;
}

/// Points of prisms drop what the step says: triangles at points that may not stay in the surface.
void keep_constrained(const MeshContent& content, std::vector<uint8_t>& may_be_prism) {
    if (content.most_dropped.empty()) return;
    for (size_t t = 0; t < content.triangles.size(); ++t) {
        for (const MeshCorner& corner : content.triangles[t].corners) {
            if (content.most_dropped[corner.point] < content.dropped.front()) may_be_prism[t] = 0;
        }
    }
}

}  // namespace

MeshContent make_content(const MeshTile& tile, const MeshContentOptions& options) {
    assert(tile.indices.size() == 3 * tile.triangle_chart.size());
    assert(tile.dressed_begin <= tile.triangle_chart.size());
    assert(options.normal_bits >= kLeastMeshNormalBits && options.normal_bits <= kMostMeshNormalBits);
    assert(options.most_steps >= 1 && options.most_steps <= kMostMeshSteps);
    assert(options.most_dropped <= kMeshGridBits);
    MeshContent content;
    content.normal_bits = options.normal_bits;
    content.topology = options.topology;
    std::vector<GridPoint> used;
    for (const uint32_t index : tile.indices) used.push_back(biased(tile.vertices[index]));
    content.dropped = choose_steps(used, options);
    std::vector<uint8_t> may_be_prism = add_triangles(content, tile);
    if (options.constraint) constrain(content, *options.constraint);
    keep_constrained(content, may_be_prism);
    take_prisms(content, may_be_prism);
    return content;
}

}  // namespace citystream::codec::mesh
