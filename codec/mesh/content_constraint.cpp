#include "codec/mesh/content_constraint.h"

#include <algorithm>
#include <array>
#include <map>
#include <vector>

#include "codec/chart_word.h"
#include "codec/mesh/constrained_precision.h"
#include "codec/mesh/octahedral.h"

namespace citystream::codec::mesh {

namespace {

constexpr double kOneRepeat = 65536;  // of texture coordinates

/// u, v of all corners, in texels of the longer side; 0 of colours.
std::vector<double> texel_places(const MeshContent& content, const MeshConstraint& constraint) {
    std::map<uint32_t, double> texels;
    std::vector<double> places;
    places.reserve(6 * content.triangles.size());
    for (const MeshTriangle& triangle : content.triangles) {
        double scale = 0;
        if (!names_colour(triangle.chart_word)) {
            const auto [at, added] = texels.try_emplace(triangle.chart_word, 0);
            if (added) {
                const auto [width, height] = constraint.chart_size(triangle.chart_word);
                at->second = texture_slope(width, height) / kOneRepeat;
            }
            scale = at->second;
        }
        for (const MeshCorner& corner : triangle.corners) {
            for (const int32_t part : corner.texcoord) places.push_back(scale * part);
        }
    }
    return places;
}

std::vector<double> normals_of(const MeshContent& content) {
    std::vector<double> normals;
    normals.reserve(9 * content.triangles.size());
    for (const MeshTriangle& triangle : content.triangles) {
        for (const MeshCorner& corner : triangle.corners) {
            const Direction normal = unpack_octahedral(corner.normal, content.normal_bits);
            normals.insert(normals.end(), normal.begin(), normal.end());
        }
    }
    return normals;
}

std::vector<uint8_t> border_points(const MeshContent& content, int32_t tile_side) {
    std::vector<uint8_t> on_border;
    on_border.reserve(content.points.size());
    for (const GridPoint& point : content.points) {
        const auto outside = [&](int32_t word) { return word - kMeshBias <= 0 || word - kMeshBias >= tile_side; };
        on_border.push_back(outside(point[0]) || outside(point[1]) ? 1 : 0);
    }
    return on_border;
}

}  // namespace

void constrain(MeshContent& content, const MeshConstraint& constraint) {
    const std::vector<double> texels = texel_places(content, constraint), normals = normals_of(content);
    const std::array<AttributeLimit, 2> limits = {
        {{texels, 2, constraint.texels, 1.0}, {normals, 3, constraint.shade, constraint.shading_slope}}};
    std::vector<std::array<uint32_t, 3>> triangles;
    for (const MeshTriangle& t : content.triangles)
        triangles.push_back({t.corners[0].point, t.corners[1].point, t.corners[2].point});
    const auto most = constrained_dropped(content.points, triangles, limits,
                                          border_points(content, constraint.tile_side), content.dropped.front());
    if (std::all_of(most.begin(), most.end(), [&](uint32_t bits) { return bits == content.dropped.front(); })) return;
    for (const uint32_t bits : most)
        content.most_dropped.push_back(static_cast<uint8_t>(std::max(bits, content.dropped.back())));
}

}  // namespace citystream::codec::mesh
