// What the first step of mesh_wire says before everything else.
#pragma once

#include <cstdint>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/mesh/mesh_content.h"
#include "codec/mesh/surface_writer.h"

namespace citystream::codec::mesh {

inline constexpr uint32_t kMeshWireVersion = 1;

struct MeshWireHeader {
    std::vector<uint32_t> dropped = {0};  ///< by each step
    uint32_t normal_bits = 8;
    MeshTopology topology = MeshTopology::kIndices;
    bool has_prisms = false, has_surface = false;
    bool has_most_dropped = false;
    SurfaceBox box;  ///< where there is a surface
};

/// A number by its length and its bits.
template <typename Coder>
uint32_t code_plain_number(Coder& coder, uint32_t value = 0) {
    const uint32_t bits = coder.plain_bits(6, size_class(value));
    return coder.plain_bits(bits < 32 ? bits : 32, value);
}

/// Side of the cubes of NearPoints, lowest coordinates and extent. False: outside the grid.
template <typename Coder>
bool code_box(Coder& coder, SurfaceBox& box, uint32_t dropped) {
    const int32_t limit = (1 << 30) >> dropped;
    box.cell_bits = coder.plain_bits(5, box.cell_bits);
    for (size_t k = 0; k < 3; ++k) {
        box.low[k] = bits::unzigzag(code_plain_number(coder, bits::zigzag(box.low[k])));
        box.extent[k] = static_cast<int32_t>(code_plain_number(coder, static_cast<uint32_t>(box.extent[k])));
        if (box.low[k] < -limit || box.low[k] >= limit || box.extent[k] < 0 ||
            int64_t{box.low[k]} + box.extent[k] >= limit)
            return false;
    }
    return box.cell_bits >= 1 && box.cell_bits <= kMostCellBits;
}

/// False: no header of this version.
template <typename Coder>
bool code_header(Coder& coder, MeshWireHeader& header) {
    if (coder.plain_bits(8, kMeshWireVersion) != kMeshWireVersion) return false;
    header.dropped.resize(coder.plain_bits(2, static_cast<uint32_t>(header.dropped.size()) - 1) + 1);
    for (size_t s = 0; s < header.dropped.size(); ++s) {
        uint32_t& dropped = header.dropped[s];
        dropped = coder.plain_bits(5, dropped);
        if (dropped > kMeshGridBits || (s > 0 && dropped >= header.dropped[s - 1])) return false;
    }
    header.normal_bits = coder.plain_bits(4, header.normal_bits - 1) + 1;
    const uint32_t topology = coder.plain_bits(2, static_cast<uint32_t>(header.topology));
    header.topology = static_cast<MeshTopology>(topology);
    header.has_prisms = coder.plain_bits(1, header.has_prisms ? 1 : 0) != 0;
    header.has_surface = coder.plain_bits(1, header.has_surface ? 1 : 0) != 0;
    header.has_most_dropped = coder.plain_bits(1, header.has_most_dropped ? 1 : 0) != 0;
    if (header.normal_bits < kLeastMeshNormalBits || topology > static_cast<uint32_t>(MeshTopology::kStripCode))
        return false;
    return !header.has_surface || code_box(coder, header.box, header.dropped[0]);
}

}  // namespace citystream::codec::mesh
