// What the first step of geometry_wire says before its triangles.
#pragma once

#include <array>
#include <cstdint>

#include "codec/mesh/geometry_wire.h"
#include "codec/mesh/surface_writer.h"

namespace citystream::codec::mesh {

inline constexpr uint32_t kGeometryVersion = 1;

struct GeometryHeader {
    uint32_t version = kGeometryVersion;
    uint32_t steps = 1;
    std::array<uint32_t, kMostGeometrySteps> dropped{};
    SurfaceBox box;
    bool has_prisms = false;  ///< they come before the walk over the rest
};

/// A number by its length and its bits.
template <typename Coder>
uint32_t code_plain_number(Coder& coder, uint32_t value = 0) {
    const uint32_t bits = coder.plain_bits(6, size_class(value));
    return coder.plain_bits(bits < 32 ? bits : 32, value);
}

/// Lowest coordinates and extent. False: outside the grid.
template <typename Coder>
bool code_extent(Coder& coder, SurfaceBox& box, uint32_t dropped) {
    const int32_t limit = (1 << 30) >> dropped;
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
bool code_header(Coder& coder, GeometryHeader& header) {
    header.version = coder.plain_bits(8, header.version);
    header.steps = coder.plain_bits(3, header.steps - 1) + 1;
    for (uint32_t s = 0; s < header.steps; ++s) {
        header.dropped[s] = coder.plain_bits(5, header.dropped[s]);
        if (header.dropped[s] > kMostDroppedBits || (s > 0 && header.dropped[s] >= header.dropped[s - 1])) return false;
    }
    SurfaceBox& box = header.box;
    box.cell_bits = coder.plain_bits(5, box.cell_bits);
    header.has_prisms = coder.plain_bits(1, header.has_prisms ? 1 : 0) != 0;
    return code_extent(coder, box, header.dropped[0]) && header.version == kGeometryVersion;
}

}  // namespace citystream::codec::mesh
