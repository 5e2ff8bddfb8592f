// Triangles with integers at their corners as Draco's bytes and back, losslessly. All that is known of libdraco is in
// draco_corners.cpp.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "codec/result.h"

namespace citystream::codec::mesh {

struct DracoCorner {
    std::array<int32_t, 3> place{};  ///< a range below 2^31 on each axis
    std::array<int32_t, 2> texcoord{};
    std::array<int32_t, 2> normal{};
    int32_t face = 0;  ///< the same at the three corners of a triangle
    friend auto operator<=>(const DracoCorner&, const DracoCorner&) = default;
};

enum class DracoMethod : uint8_t {
    kEdgebreaker,  ///< smaller; leaves out triangles with two corners at one place
    kSequential    ///< keeps anything
};

/// Three corners a triangle, at least one triangle; at the highest compression level. Nothing where libdraco declines.
/// Triangles may come back in another order and turned.
std::optional<std::vector<std::byte>> encode_draco_corners(std::span<const DracoCorner> corners, DracoMethod method);

/// For untrusted bytes: an error, or `triangles` triangles. Header, counts and attributes are checked before libdraco
/// makes room for them: memory is in proportion to `triangles`, which the caller has bounded.
Result<std::vector<DracoCorner>> decode_draco_corners(std::span<const std::byte> bytes, uint32_t triangles);

}  // namespace citystream::codec::mesh
