// A triangle cut to a rectangle, seen along one axis, without allocation.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace citystream::tiles::radiance {

/// Points are (a, b, depth); what is cut is decided by (a, b) alone.
class ClippedPolygon {
  public:
    using Point = std::array<double, 3>;
    /// A triangle cut four times has seven; rounding may add a few that lie on its edges. Further ones are left out.
    static constexpr size_t kMostPoints = 12;

    void add(const Point& point) {
        if (count_ < kMostPoints) points_[count_++] = point;
    }

    /// Keeps what has direction . (a, b) + offset >= 0 (Sutherland and Hodgman 1974).
    void clip(const std::array<double, 2>& direction, double offset) {
        const ClippedPolygon before = *this;
        count_ = 0;
        for (size_t i = 0; i < before.count_; ++i) {
            const Point& from = before.points_[i];
            const Point& to = before.points_[(i + 1) % before.count_];
            const double from_side = direction[0] * from[0] + direction[1] * from[1] + offset;
            const double to_side = direction[0] * to[0] + direction[1] * to[1] + offset;
            if (from_side >= 0) add(from);
            if ((from_side >= 0) != (to_side >= 0)) add(between(from, to, from_side, to_side));
        }
    }

    std::span<const Point> points() const { return {points_.data(), count_}; }

  private:
    /// Where the edge crosses. From the end that is kept, so that both neighbours of an edge cut it at one place.
    static Point between(const Point& from, const Point& to, double from_side, double to_side) {
        if (from_side < 0) return between(to, from, to_side, from_side);
        const double t = from_side / (from_side - to_side);
        return {from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]), from[2] + t * (to[2] - from[2])};
    }

    std::array<Point, kMostPoints> points_{};
    size_t count_ = 0;
};

}  // namespace citystream::tiles::radiance
