// From the builder's triangles to what a mesh layer says (mesh_content.h): steps are chosen, points cut and welded,
// normals and texture coordinates quantised, and prisms taken out. No triangle that any step can show is lost: those of
// which the cut folds two corners into one place are left out (of coarse tiles a third). Triangles outside prisms keep
// their order.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>

#include "codec/mesh/mesh_content.h"
#include "codec/mesh/mesh_tile.h"

namespace citystream::codec::mesh {

/// Constrained precision (constrained_precision.h): how far what is shaded may change where points move.
struct MeshConstraint {
    double texels = 0.5;  ///< a place on a picture, in texels of its finest level
    /// Width and height of a chart of the tile's atlas, in texels of a repeat.
    std::function<std::array<uint32_t, 2>(uint32_t chart)> chart_size;
    double shade = 1.0 / 255;    ///< intensity 0..1, where normals differ in a triangle
    double shading_slope = 0.3;  ///< of intensity over a unit normal: blinn_slope at most, pictures need less
    int32_t tile_side =
        1 << 30;  ///< grid units. Points on the tile's borders, which its neighbours have, too, are free
};

struct MeshContentOptions {
    float finest_error_metres = 0;  ///< of the geometry itself: positions leave out what lies far below it
    uint32_t normal_bits = 8;       ///< a parameter, kLeastMeshNormalBits..kMostMeshNormalBits
    MeshTopology topology = MeshTopology::kIndices;
    uint32_t most_steps = 3;                ///< 1..kMostMeshSteps
    uint32_t most_dropped = kMeshGridBits;  ///< the tile's corner and base height are multiples of 2^this
    std::optional<MeshConstraint> constraint = {};
};

/// The last step drops finest_dropped of the error, each step before it kMeshStepBits more, as many steps as are
/// allowed and leave positions bits to tell.
///
/// A triangle with one normal that is that of its plane to within the codes' greatest error gets the code of its plane
/// (at the positions of the first step if that is near enough, else of the last): decoders derive it. Texture
/// coordinates are exact while those of a chart in this tile span less than one repeat (2^16), else to within 2^-16 of
/// their span.
///
/// Preconditions: indices in range, arrays of matching size, coordinates below 2^29 less kMeshBias in magnitude,
/// numbers as above. Deterministic. O(n log n) for n triangles.
MeshContent make_content(const MeshTile& tile, const MeshContentOptions& options = {});

}  // namespace citystream::codec::mesh
