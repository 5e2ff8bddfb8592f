// How near each chart of a tile is: boxes around the triangles that show it. A tile may be a street long and the camera
// inside it; then its nearest point says little of most of its walls.
#pragma once

#include <array>
#include <vector>

#include "client/cache/directory_cache.h"
#include "client/select/city_knowledge.h"
#include "codec/mesh/mesh_content.h"

namespace citystream::client {

/// Whether the boxes of a tile's charts are of use: the city has shared charts, and nothing but triangles shows charts
/// of this tile.
bool learns_chart_boxes(const DirectoryCache& directory, NodeIndex node);

/// Where a tile's mesh counts from: metres, as TileRecord::bounds.
std::array<double, 3> tile_corner(const DirectoryCache& directory, NodeIndex node);

/// Of every chart that a triangle shows with the first `steps` steps of a mesh, ascending, each `margin` metres larger
/// than its triangles: by how much finer steps of the mesh may move them. Memory and time: O(triangles), whatever the
/// charts' numbers.
std::vector<ChartBox> chart_boxes_of(const codec::mesh::MeshContent& mesh, uint32_t steps,
                                     const std::array<double, 3>& corner, double margin);

}  // namespace citystream::client
