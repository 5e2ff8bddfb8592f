// The part of a triangle that is near a column of the lattice: where a receiver on it may stand.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tiles/radiance/clipped_polygon.h"
#include "tiles/radiance/receiver_lattice.h"

namespace citystream::tiles::radiance {

/// A triangle seen along a class: corners as (column axes, depth), the least corner first, so that the same triangle
/// is reckoned with in the same way wherever it comes from.
struct ClassTriangle {
    uint32_t surface_class = 0;
    std::array<std::array<int64_t, 3>, 3> corners;
    std::array<double, 2> slope{};  ///< of depth along the column's axes
    std::array<int8_t, 2> tilt{};

    /// Where its plane is at a column: grid units.
    int64_t depth_at(const std::array<int64_t, 2>& column_at) const;
};

/// The triangle as each class it is of sees it: one or two, none where it is thinner than kThinnest.
std::vector<ClassTriangle> seen_along_classes(const SurfaceTriangle& triangle);

/// A triangle within the square around a column.
class LatticePiece {
  public:
    /// `column_at`: grid coordinates of the column. Nothing where they have no area in common.
    static std::optional<LatticePiece> create(const ClassTriangle& triangle, const std::array<int64_t, 2>& column_at,
                                              int64_t spacing);

    /// The point nearest to the column, a 32nd of the spacing away from the piece's border (or its middle).
    GridPoint nearest() const;
    /// Others, nearest first: 8 x 8 places of the piece's bounds as far as they are on it, and its middle. So of a wall
    /// that is mostly under the ground the strip above is found.
    std::vector<GridPoint> others() const;
    /// The point of the piece at a place of the square, relative to the column and in spacings (-1..1); nothing where
    /// the piece does not go.
    std::optional<GridPoint> at(const std::array<double, 2>& place) const;
    /// Least and greatest places of the piece, relative to the column and in spacings.
    std::array<std::array<double, 2>, 2> bounds() const;
    /// Squared distance from the column to `nearest`, grid units, seen along the class.
    int64_t squared_distance() const { return squared_distance_; }
    /// What the column means to the piece: its bilinear weight, integrated over the piece, seen along the class; grid
    /// units squared. A surface that goes on all around has the spacing squared.
    double share() const;

  private:
    LatticePiece(const ClassTriangle& triangle, const std::array<int64_t, 2>& column_at, int64_t spacing);
    void find_nearest();
    std::array<std::array<double, 2>, 2> polygon_bounds() const;
    bool holds(const std::array<double, 2>& place) const;
    /// Of a place in the square, relative to the column, rounded to the grid.
    GridPoint point_at(const std::array<double, 2>& place) const;

    const ClassTriangle& triangle_;
    std::array<int64_t, 2> column_at_;
    int64_t spacing_;
    ClippedPolygon polygon_;  ///< relative to the column
    std::array<double, 2> middle_{}, nearest_{};
    double turn_ = 1;  ///< 1: corners go round counter-clockwise, else -1
    int64_t squared_distance_ = 0;
};

}  // namespace citystream::tiles::radiance
