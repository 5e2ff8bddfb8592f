// What the first step of geometry_wire says before its triangles.
#pragma once

#include <array>
#include <cstdint>

#include "codec/mesh/geometry_wire.h"
#include "codec/mesh/surface_walk.h"

namespace citystream::codec::mesh {

inline constexpr uint32_t kGeometryVersion = 1, kMostCellBits = 30;

struct GeometryHeader {
    uint32_t version = kGeometryVersion;
    uint32_t steps = 1;
    std::array<uint32_t, kMostGeometrySteps> dropped{};
    GridPoint low{};     ///< of all points, shifted right by dropped[0]
    GridPoint extent{};  ///< highest - lowest, shifted
    uint32_t cell_bits = 1;
    bool has_prisms = false;  ///< they come before the walk over the rest

    WalkFrame frame(const GeometryLimits& limits) const { return {extent, cell_bits, limits.points, limits.triangles}; }
};

/// A number by its length and its bits.
template <typename Coder>
uint32_t code_plain_number(Coder& coder, uint32_t value = 0) {
    const uint32_t bits = coder.plain_bits(6, size_class(value));
    return coder.plain_bits(bits < 32 ? bits : 32, value);
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
    header.cell_bits = coder.plain_bits(5, header.cell_bits);
    header.has_prisms = coder.plain_bits(1, header.has_prisms ? 1 : 0) != 0;
    const int32_t limit = (1 << 30) >> header.dropped[0];
    for (size_t k = 0; k < 3; ++k) {
        header.low[k] = bits::unzigzag(code_plain_number(coder, bits::zigzag(header.low[k])));
        header.extent[k] = static_cast<int32_t>(code_plain_number(coder, static_cast<uint32_t>(header.extent[k])));
        if (header.low[k] < -limit || header.low[k] >= limit || header.extent[k] < 0 ||
            int64_t{header.low[k]} + header.extent[k] >= limit)
            return false;
    }
    return header.version == kGeometryVersion && header.cell_bits >= 1 && header.cell_bits <= kMostCellBits;
}

}  // namespace citystream::codec::mesh
