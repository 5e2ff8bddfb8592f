// Vectors in the plane in integers, and the directions of a building: one and its quarter turns.
#pragma once

#include <array>
#include <cstdint>
#include <cstdlib>

namespace citystream::codec::mesh {

/// A difference of points: each part below 2^32 in magnitude.
struct PlaneVector {
    int64_t x = 0, y = 0;

    static PlaneVector of(const std::array<int32_t, 2>& point) { return {point[0], point[1]}; }
    /// Turned left by quarters.
    PlaneVector turned(uint32_t quarters) const {
        switch (quarters & 3) {
            case 0:
                return {x, y};
            case 1:
                return {-y, x};
            case 2:
                return {-x, -y};
            default:
                return {y, -x};
        }
    }
    friend PlaneVector operator+(PlaneVector a, PlaneVector b) { return {a.x + b.x, a.y + b.y}; }
    friend PlaneVector operator-(PlaneVector a, PlaneVector b) { return {a.x - b.x, a.y - b.y}; }
};
constexpr int64_t dot(PlaneVector a, PlaneVector b) {
    return a.x * b.x + a.y * b.y;
}
constexpr int64_t cross(PlaneVector a, PlaneVector b) {
    return a.x * b.y - a.y * b.x;
}

/// a / b (0 < b < 2^58, |a| < 2^61) rounded to the nearest, halves up; and where between two numbers it is, in eighths:
/// 4 is exact, 0 half below.
struct Rounded {
    int64_t whole = 0;
    uint32_t part = 4;

    constexpr Rounded(int64_t a, int64_t b) {
        const int64_t twice = 2 * a + b, width = 2 * b;
        whole = twice >= 0 ? twice / width : -((-twice + width - 1) / width);
        part = static_cast<uint32_t>((twice - whole * width) * 8 / width);
    }
};

/// Learned from edges. An edge is told as the quarter that it runs in and, turned into the first quarter (within 45
/// degrees of the axis, which is within about 45 degrees of x), its length along x and what it is off the axis in y.
class FootprintFrame {
  public:
    /// The quarter that an edge runs in.
    uint32_t quarter_of(PlaneVector edge) const {
        for (uint32_t quarter = 0; quarter < 4; ++quarter) {
            const PlaneVector e = edge.turned(4 - quarter);
            if (dot(axis_, e) > 0 && std::abs(cross(axis_, e)) <= dot(axis_, e)) return quarter;
        }
        return 0;
    }
    /// y of an edge along the axis that is `length` long in x.
    Rounded across(int64_t length) const { return {length * axis_.y, axis_.x}; }
    /// x of an edge along the axis that comes closest to a vector.
    Rounded along(PlaneVector v) const { return {dot(v, axis_), axis_.x + Rounded(axis_.y * axis_.y, axis_.x).whole}; }
    /// How long the axis is known: |axis| in x.
    int64_t length() const { return axis_.x; }

    /// Takes the direction of a first edge, turned into the first quarter.
    void start(PlaneVector edge) {
        if (edge.x <= 0 || std::abs(edge.y) > 2 * edge.x) return;
        axis_ = edge;
        keep_short();
    }
    /// Improves by an edge, turned into the first quarter, if it is about along the axis.
    void learn(PlaneVector edge) {
        if (edge.x <= 0 || std::abs(edge.y) > 2 * edge.x) return;
        if (std::abs(cross(axis_, edge)) * 8 > dot(axis_, edge)) return;
        axis_ = axis_ + edge;
        keep_short();
    }

  private:
    static constexpr int64_t kMostLength = int64_t{1} << 24;
    void keep_short() {
        while (axis_.x > kMostLength) axis_ = {axis_.x / 2, axis_.y / 2};
    }
    PlaneVector axis_{1, 0};
};

}  // namespace citystream::codec::mesh
