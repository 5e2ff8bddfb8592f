// Mesh layer of a tile: triangles with grid positions, octahedral normals, chart indices and texture coordinates,
// written coarse to fine as bit planes of the positions. The decoded words are drawn as they are by
// shaders/mesh_fetch.glsl, the twin of MeshLayerView.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/layer_steps.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

/// A coordinate, and the extent of a tile, must be below 2^30 grid units (1,048 km).
inline constexpr uint32_t kMaxCoordinateBits = 30;

/// One vertex as the encoder takes it and the decoder gives it back.
struct MeshVertex {
    int32_t position[3];  ///< grid units (2^-10 m) from the tile's minimum corner (x, y) and base height (z)
    float normal[3];      ///< unit length (the encoder takes any length; zero and non-finite mean +z)
    int32_t texcoord[2];  ///< 2^-16 repeats of the chart's image, v upwards
    friend bool operator==(const MeshVertex&, const MeshVertex&) = default;
};

/// A tile's triangles. Triangles [dressed_begin, count) are the flat stand-ins of walls that the facade layer can
/// replace.
struct MeshTile {
    std::vector<MeshVertex> vertices;
    std::vector<uint32_t> indices;         ///< 3 a triangle, counter-clockwise from outside
    std::vector<uint32_t> triangle_chart;  ///< chart word (codec/chart_word.h), one a triangle
    uint32_t dressed_begin = 0;            ///< in triangles
};

/// Encodes a tile. `finest_error_metres` is the error of the geometry itself (0 for full detail): positions drop the
/// low bits that lie far below it. Vertices are welded (when all that is written of them is equal) and re-ordered by
/// first use, unused ones are left out; triangle order is kept. Deterministic. Every step rounds positions to
/// the nearest multiple of 2^dropped grid units: a coordinate on a tile border is a multiple of a large power of two,
/// hence exact in every step, and neighbours stay closed. Each step's `error` = finest_error + sqrt(3) (2^dropped - 1)
/// grid units, which bounds how far two vertices can move against each other (one alone moves about half of it).
/// Texture coordinates are exact while a chart's coordinates in this tile span less than one repeat (2^16), else to
/// within 1 / 32,768 of their span. Precondition (programming error): indices in range, arrays of matching size,
/// extents as kMaxCoordinateBits says. Time: O(vertices + triangles).
LayerSteps encode_mesh(const MeshTile& tile, float finest_error_metres);

/// A checked view of the concatenated words of a prefix of steps. Creation validates every offset, width, index and
/// chart, so that neither the accessors nor the shader can read outside the words, whatever the bytes were.
class MeshLayerView {
  public:
    /// `step_words[i]`: number of words of step i; their sum is words.size(). `atlas_chart_count`: charts in the tile's
    /// atlas layer.
    static Result<MeshLayerView> create(std::span<const uint32_t> words, std::span<const uint32_t> step_words,
                                        uint32_t atlas_chart_count);

    uint32_t vertex_count() const;
    uint32_t triangle_count() const;
    uint32_t dressed_begin() const;
    uint32_t step_count() const;
    /// The accessors' arguments must be below the counts above.
    uint32_t index(uint32_t corner) const;         ///< corner = 3 * triangle + 0..2
    uint32_t chart_word(uint32_t triangle) const;  ///< codec/chart_word.h
    /// Position (tile-relative grid units) as the shader computes it: the known high bits, rounded.
    void position(uint32_t vertex, int32_t out[3]) const;
    uint32_t packed_normal(uint32_t vertex) const;  ///< 16 bits
    /// Where the texture coordinates of the triangle's chart begin in this tile, 2^-16 repeats: shaders leave its whole
    /// repeats out.
    void texcoord_base(uint32_t triangle, int32_t out[2]) const;
    /// Texture coordinate in 2^-16 repeats of a corner of `triangle` (the chart decides the scale).
    void texcoord(uint32_t vertex, uint32_t triangle, int32_t out[2]) const;

  private:
    uint32_t chart_entry(uint32_t triangle) const;  ///< offset of the chart table entry

    std::span<const uint32_t> words_;
    uint32_t plane_offset_[4] = {};
    uint32_t plane_bits_[4] = {};
    uint32_t steps_ = 0;
    uint32_t dropped_ = 0;
};

/// The whole prefix back as arrays (tests, CPU consumers). Normals are decoded octahedral vectors.
Result<MeshTile> decode_mesh(std::span<const uint32_t> words, std::span<const uint32_t> step_words,
                             uint32_t atlas_chart_count);

}  // namespace citystream::codec::mesh
