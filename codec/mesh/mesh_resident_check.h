// Whether words are a mesh layer that can be drawn (RESIDENT.md, "Reading words that nobody vouches for").
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/adaptive_precision.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

struct CheckedResident {
    PrecisionView positions;
    /// Of each range: the corners of its strip code; empty for the other kinds.
    std::vector<std::vector<std::array<uint32_t, 3>>> strips;
};

/// Every offset, count, index and chart. Linear time.
Result<CheckedResident> check_resident(std::span<const uint32_t> words, uint32_t atlas_chart_count);

}  // namespace citystream::codec::mesh
