// A tile's mesh layer in GPU memory: words that shaders/mesh_corner.glsl draws as they are. RESIDENT.md has the format.
//
// Triangles lie in *ranges*, each drawn by one call: prisms with the same number of points, and the other triangles by
// what their vertices hold: nothing but places where all that is shown belongs to faces, texture coordinates, normals.
// All positions of all ranges are one precision buffer (adaptive_precision.h) at the end of the layer, so that a step
// more is one run of planes, whatever the positions are of.
//
// Nothing of a layer but that buffer's payload depends on how many steps are known. So a client that got only the first
// has the words that the builder counted.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/adaptive_precision.h"
#include "codec/mesh/mesh_content.h"
#include "codec/mesh/mesh_resident_layout.h"
#include "codec/mesh/precision.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

/// Triangles that are drawn together.
struct MeshRange {
    uint32_t triangles = 0;
    uint32_t kind = 0;  ///< RESIDENT_KIND_*
    bool dressed = false;
    /// Words of the layer. Of strip code a whole stream (strip_code.h), whose vertices are those of the range.
    uint32_t topology_begin = 0, topology_words = 0;
    uint32_t flags = 0;  ///< RESIDENT_FLAG_*
    friend bool operator==(const MeshRange&, const MeshRange&) = default;
};

/// One layer: `words`, then the positions as a precision buffer at the level of a step.
struct ResidentMesh {
    std::vector<uint32_t> words;           ///< the same whatever the number of steps that are known
    std::vector<MeshRange> ranges;         ///< as a view of the words has them
    PrecisionShape shape;                  ///< of the positions
    std::vector<uint32_t> position_words;  ///< one a component, bits that are not known 0
    std::vector<uint32_t> levels;          ///< of each step that the content announces

    /// All words with the positions of the first `steps` >= 1 steps.
    std::vector<uint32_t> with_steps(uint32_t steps) const;
    /// Planes that take the positions from `from` >= 1 steps to `to` steps.
    std::vector<uint32_t> planes(uint32_t from, uint32_t to) const;
    /// Words that a step adds to the layer.
    uint64_t added_words(uint32_t step) const;
};

/// Whether prisms show colours, and triangles colours or charts that the tile's atlas layer has: to be asked of content
/// that nobody vouches for before it is made resident.
Status check_charts(const MeshContent& content, uint32_t atlas_chart_count);

/// Preconditions: check_charts; indices in range; coordinates below 2^29 in magnitude (others come out wrong); of a
/// prism, a wall's base is the prism's or differs from it in the bits that the first step has; texture coordinates of a
/// chart span at most 16 bits less common trailing zeros (else the lowest are lost). Deterministic. O(n log n). Content
/// that is larger than a layer can be, 2^27 position words or 2^32 bits of anything, gives a layer without words.
ResidentMesh make_resident(const MeshContent& content);

/// A corner as the vertex shader has it.
struct ResidentCorner {
    std::array<int32_t, 3> position{};  ///< grid units from the tile's corner and base height
    std::array<int32_t, 3> normal{};    ///< direction, any length but 0
    uint32_t chart_entry = 0;           ///< word of its chart table entry
    uint32_t texcoord = 0;              ///< q_u | q_v << 16; 0 where its chart is a colour
    friend bool operator==(const ResidentCorner&, const ResidentCorner&) = default;
};

/// Where the camera is and what it grants: a vertex drops max(what its distance grants, least_dropped), no more than
/// its own limit, and in any case what is not known.
struct PositionView {
    /// Grid units from the camera's grid cell to the tile's corner, which is a multiple of 2^RESIDENT_CELL_BITS; below
    /// 2^30 in magnitude.
    std::array<int32_t, 3> from_camera{};
    DropRule rule;               ///< common_dropped is RESIDENT_CELL_BITS
    uint32_t least_dropped = 0;  ///< bits that the step on show leaves out, at most kMeshGridBits
};

/// A checked view: neither it nor the shader can read outside the words, whatever they are.
class ResidentMeshView {
  public:
    /// `atlas_chart_count`: charts in the tile's atlas layer. Looks at everything, in linear time.
    static Result<ResidentMeshView> create(std::span<const uint32_t> words, uint32_t atlas_chart_count);

    uint32_t triangle_count() const;
    const std::vector<MeshRange>& ranges() const { return ranges_; }
    uint32_t position_begin() const;  ///< word of the precision buffer
    const PrecisionView& positions() const { return positions_; }

    /// The arguments below are in range: corner k (0..2) of a triangle in the order of the ranges.
    ResidentCorner corner(uint32_t triangle, uint32_t k, const PositionView& view) const;
    uint32_t chart_word(uint32_t triangle) const;
    bool dressed(uint32_t triangle) const;
    /// Where the texture coordinates of the triangle's chart begin, 2^-16 repeats, and a corner's place; 0 for colours.
    void texcoord_base(uint32_t triangle, int32_t out[2]) const;
    void texcoord(uint32_t triangle, uint32_t k, int32_t out[2]) const;

  private:
    uint32_t vertex(uint32_t range, uint32_t triangle, uint32_t k) const;
    uint32_t chart_entry(uint32_t chart) const;
    bool has_own_frames() const;
    /// RESIDENT_FRAME_* of an image.
    std::span<const uint32_t> frame_of(uint32_t chart_entry) const;
    uint32_t entry_of(uint32_t triangle) const;
    /// 0: chart, 1: normal.
    uint32_t face_field(uint32_t face, uint32_t part) const;
    ResidentCorner prism_corner_of(uint32_t triangle, uint32_t k, const PositionView& view) const;

    std::span<const uint32_t> words_;
    std::vector<MeshRange> ranges_;
    /// Of the ranges of strip code: corners, as the GPU decodes them.
    std::vector<std::vector<std::array<uint32_t, 3>>> strips_;
    PrecisionView positions_;
};

}  // namespace citystream::codec::mesh
