// Makes the triangles of a solid's shell face outwards.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "tiles/city/city_model.h"

namespace citystream::tiles::city {

enum class ShellRepair : uint8_t {
    kNone,         ///< was right, or is open so that nothing can be said
    kTurned,       ///< was inside out as a whole
    kStraightened  ///< some triangles faced the other way than their neighbours
};

/// Closed shells (every edge between two triangles): neighbours are made to agree, then each connected piece to enclose
/// a positive volume (a negative one for `cavity`). Shells with gaps or T-shaped contacts that still look closed (their
/// area vectors cancel) are turned as a whole by the sign of their volume; open ones stay. O(n log n).
ShellRepair orient_shell(const std::vector<Vec3>& vertices, std::span<Triangle> shell, bool cavity);

}  // namespace citystream::tiles::city
