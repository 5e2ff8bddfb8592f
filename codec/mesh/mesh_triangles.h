// All triangles of a mesh layer one by one, prisms too: for whoever looks at surfaces and not at the layer's form.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "codec/mesh/mesh_content.h"
#include "codec/mesh/mesh_tile.h"

namespace citystream::codec::mesh {

enum class PrismFace : uint8_t { kWall, kTop, kFloor };

/// The triangles of a prism in the order of join (prisms.h): walls along the rings, top, floor.
void for_each_prism_triangle(const Prism& prism,
                             const std::function<void(const std::array<GridPoint, 3>&, PrismFace)>& visit);

/// What a face shows.
uint32_t chart_of(const MeshPrism& prism, PrismFace face);

/// Where a word of mesh_content.h is shown when its lowest `dropped` bits are not known: grid units from the tile's
/// corner and base height.
GridPoint shown_place(const GridPoint& word, uint32_t dropped);

struct PlacedTriangle {
    std::array<GridPoint, 3> places;  ///< grid units from the tile's corner and base height
    uint32_t chart_word = 0;
    bool dressed = false;
};

/// Prisms first, then the surface, as they are shown with the first `steps` steps of the content (1..dropped.size(),
/// as many as it was decoded from, or fewer).
void for_each_triangle(const MeshContent& content, uint32_t steps,
                       const std::function<void(const PlacedTriangle&)>& visit);
inline void for_each_triangle(const MeshContent& content, const std::function<void(const PlacedTriangle&)>& visit) {
    for_each_triangle(content, static_cast<uint32_t>(content.dropped.size()), visit);
}

/// How many triangles for_each_triangle visits. O(prisms).
uint64_t triangle_count(const MeshContent& content);

/// The same as arrays, for tests and tools: dressed triangles last, three vertices a triangle, normals as decoded,
/// those of prisms as their planes have them.
MeshTile to_tile(const MeshContent& content, uint32_t steps);
inline MeshTile to_tile(const MeshContent& content) {
    return to_tile(content, static_cast<uint32_t>(content.dropped.size()));
}

}  // namespace citystream::codec::mesh
