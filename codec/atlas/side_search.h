// One side of a chart made smaller while the other keeps its size: which size a metric should still accept, and what
// the errors in between are like. A bracket as bisection has it, but the errors say where in it to look next.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

namespace citystream::codec::atlas {

/// The sizes that one side may have: multiples of a step, and its full length. Numbered from 1.
struct Sizes {
    uint32_t full, step;

    uint32_t count() const { return (full + step - 1) / step; }
    uint32_t of(uint32_t number) const { return number == count() ? full : number * step; }
};

/// A bracket of one side: size number `high` is accepted, `low` is not (or is 0).
struct Bracket {
    uint32_t low, high;

    bool open() const { return high - low > 1; }
    uint32_t middle() const { return low + (high - low) / 2; }
    void narrow(uint32_t at, bool accepted) { (accepted ? high : low) = at; }
};

class SideSearch {
  public:
    /// `limit`: the largest error that is accepted; not negative.
    SideSearch(Sizes sizes, double limit) : sizes_(sizes), limit_(limit), measured_{{sizes.count(), 0.0}} {}

    /// The size number to measure next; nothing once the least accepted one is known to 1 / 32 of its size.
    std::optional<uint32_t> next() const;
    void note(uint32_t number, double error);

    /// The error of a size: between those that were measured, and below, on a line over the logarithm of the size.
    /// Infinite where nothing but the full size was measured.
    double error(uint32_t number) const;
    /// The least number that has not been refused.
    uint32_t least() const { return bracket_.low + 1; }

  private:
    using Point = std::pair<uint32_t, double>;  // size number, error

    double on_line(Point a, Point b, uint32_t number) const;
    uint32_t number_on_line(Point a, Point b, uint32_t least) const;

    Sizes sizes_;
    double limit_;
    std::map<uint32_t, double> measured_;
    Bracket bracket_{0, sizes_.count()};
    // How much the error of either end counts less because that end stays: else a curve is approached from one side.
    double low_weight_ = 1, high_weight_ = 1;
};

}  // namespace citystream::codec::atlas
