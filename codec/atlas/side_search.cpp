#include "codec/atlas/side_search.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kPrecision = 32;    // of the least accepted size
constexpr uint32_t kLongestStep = 16;  // times smaller at once, when no size has been refused
constexpr uint32_t kLeastStep = 8;     // a guess takes this part of the bracket off, at least

}  // namespace

std::optional<uint32_t> SideSearch::next() const {
    const auto [low, high] = bracket_;
    if (!bracket_.open()) return std::nullopt;
    if (measured_.size() == 1) return (high + 1) / 2;
    if (low == 0) {
        const auto smallest = measured_.begin();
        return number_on_line(*smallest, *std::next(smallest), std::max(1u, high / kLongestStep));
    }
    if (uint64_t{sizes_.of(high) - sizes_.of(low)} * kPrecision < sizes_.of(high)) return std::nullopt;
    const Point refused{low, limit_ + (measured_.at(low) - limit_) * low_weight_};
    const Point accepted{high, limit_ + (measured_.at(high) - limit_) * high_weight_};
    const uint32_t step = (high - low) / kLeastStep;
    return std::clamp(number_on_line(refused, accepted, low + 1), low + std::max(1u, step), high - std::max(1u, step));
}

void SideSearch::note(uint32_t number, double error) {
    measured_[number] = error;
    const bool accepted = error <= limit_;
    const bool again = accepted ? low_weight_ < 1 || bracket_.high != sizes_.count() : bracket_.low != 0;
    (accepted ? low_weight_ : high_weight_) *= again ? 0.5 : 1;
    (accepted ? high_weight_ : low_weight_) = 1;
    bracket_.narrow(number, accepted);
}

double SideSearch::error(uint32_t number) const {
    auto above = measured_.lower_bound(number);
    if (above->first == number) return above->second;
    if (measured_.size() == 1) return std::numeric_limits<double>::infinity();
    if (above == measured_.begin()) ++above;
    return on_line(*std::prev(above), *above, number);
}

double SideSearch::on_line(Point a, Point b, uint32_t number) const {
    const auto log_size = [this](uint32_t i) {
        return static_cast<double>(fast_log2(static_cast<float>(sizes_.of(i))));
    };
    const double from = log_size(a.first);
    return a.second + (b.second - a.second) * (log_size(number) - from) / (log_size(b.first) - from);
}

/// The least number from `least` on, below the bracket's upper end, that the line says is accepted.
uint32_t SideSearch::number_on_line(Point a, Point b, uint32_t least) const {
    uint32_t most = bracket_.high - 1;
    while (least < most) {
        const uint32_t middle = least + (most - least) / 2;
        if (on_line(a, b, middle) <= limit_) {
            most = middle;
        } else {
            least = middle + 1;
        }
    }
    return least;
}

}  // namespace citystream::codec::atlas
