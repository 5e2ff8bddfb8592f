// Planar polygons with holes in space -> triangles (the SGI tessellator of GLU, wrapped).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tiles/city/city_model.h"

namespace citystream::tiles::city {

/// A point of a ring with its texture coordinate.
struct Corner {
    Vec3 position;
    Vec2 texcoord;
};

enum class PolygonFault : uint8_t {
    kNone,
    kDegenerate,  ///< no area: nothing to draw
    kTangled,     ///< crosses itself so often, or has so many points, that it is refused
    kFailed       ///< the tessellator gave up
};

struct PolygonOutcome {
    PolygonFault fault = PolygonFault::kNone;
    bool crosses_itself = false;  ///< triangulated by the odd-even rule all the same
    Vec3 normal;                  ///< Newell's, of the outer ring; its length is twice the area
};

/// Newell's normal of a ring: counter-clockwise seen from its tip, twice the area long.
Vec3 newell_normal(std::span<const Corner> ring);

/// Reusable; one per thread. Triangles are counter-clockwise about the outer ring's Newell normal, whatever way the
/// holes run.
class Triangulator {
  public:
    static constexpr size_t kMostCorners = 50000;

    Triangulator();
    ~Triangulator();
    Triangulator(const Triangulator&) = delete;
    Triangulator& operator=(const Triangulator&) = delete;

    /// `corners` holds all rings one after another (each at least 3 points, not closed, no equal neighbours, finite);
    /// ring i ends before ring_ends[i]; ring 0 is the outer one. Appends triangles that index `corners`. Where edges
    /// cross or touch, corners with interpolated texture coordinates are appended. Memory is O(n): polygons with more
    /// than about 2n crossings are refused (kTangled). Time is quadratic with a small constant for outlines of very
    /// many points (20,000: 1 s), so more than kMostCorners are refused too.
    PolygonOutcome triangulate(std::vector<Corner>& corners, std::span<const uint32_t> ring_ends,
                               std::vector<std::array<uint32_t, 3>>& triangles);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace citystream::tiles::city
