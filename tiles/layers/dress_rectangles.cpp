#include "tiles/layers/dress_rectangles.h"

#include <algorithm>
#include <cmath>

namespace citystream::tiles::layers {
namespace {

constexpr size_t kMostColumns = 96;
constexpr int64_t kClearance = 10;  // grid units between a free corner and a sloping edge

struct Span {
    int64_t bottom = 0, top = 0;
};
using Strip = std::vector<Span>;  // rising, apart from each other

/// What is level in a slice. A sloping edge limits at its corner; where it has none there, the span keeps off it.
Span level_part(const WallSlice& slice) {
    const size_t low = slice.bottom[0] >= slice.bottom[1] ? 0 : 1, high = slice.top[0] <= slice.top[1] ? 0 : 1;
    Span span{static_cast<int64_t>(std::ceil(slice.bottom[low])), static_cast<int64_t>(std::floor(slice.top[high]))};
    if (slice.bottom[0] != slice.bottom[1] && !slice.bottom_corner[low]) span.bottom += kClearance;
    if (slice.top[0] != slice.top[1] && !slice.top_corner[high]) span.top -= kClearance;
    return span;
}

void cut_out(Strip& strip, int64_t bottom, int64_t top) {
    Strip left;
    for (const Span& span : strip) {
        if (span.bottom < std::min(span.top, bottom)) left.push_back({span.bottom, std::min(span.top, bottom)});
        if (std::max(span.bottom, top) < span.top) left.push_back({std::max(span.bottom, top), span.top});
    }
    strip = std::move(left);
}

/// Finds the greatest rectangle over neighbouring strips again and again.
class Packing {
  public:
    Packing(const WallRegion& wall, const RectangleLimits& limits, std::vector<Strip> strips)
        : wall_(wall), limits_(limits), strips_(std::move(strips)) {}

    std::vector<LevelRectangle> run() {
        std::vector<LevelRectangle> found;
        while (true) {
            const LevelRectangle best = greatest();
            if (best.left == best.right) return found;
            found.push_back(best);
            for (uint32_t s = best.left; s < best.right; ++s) cut_out(strips_[s], best.bottom, best.top);
        }
    }

  private:
    LevelRectangle greatest() const {
        LevelRectangle best;
        double best_area = 0;
        for (uint32_t first = 0; first < strips_.size(); ++first) {
            for (Span span : strips_[first]) {
                for (uint32_t end = first + 1; end <= strips_.size(); ++end) {
                    if (end > first + 1 && !narrow(span, strips_[end - 1])) break;
                    const double width = wall_.along[end] - wall_.along[first],
                                 height = static_cast<double>(span.top - span.bottom) * kMetresPerGridUnit;
                    if (height < limits_.least_height) break;
                    if (width < limits_.least_width || width * height <= best_area) continue;
                    best_area = width * height;
                    best = {first, end, span.bottom, span.top};
                }
            }
        }
        return best;
    }

    /// Cuts the span down to what it shares with the strip; false when that is nothing.
    static bool narrow(Span& span, const Strip& strip) {
        Span best{0, 0};
        for (const Span& other : strip) {
            const Span both{std::max(span.bottom, other.bottom), std::min(span.top, other.top)};
            if (both.top - both.bottom > best.top - best.bottom) best = both;
        }
        span = best;
        return best.top > best.bottom;
    }

    const WallRegion& wall_;
    const RectangleLimits& limits_;
    std::vector<Strip> strips_;
};

}  // namespace

bool level_rectangles(WallRegion& wall, const RectangleLimits& limits, std::vector<LevelRectangle>& rectangles) {
    rectangles.clear();
    if (wall.columns.size() + 2 * wall.hidden.size() > kMostColumns) return false;
    for (const HiddenPart& part : wall.hidden) {
        add_column(wall, part.left);
        add_column(wall, part.right);
    }
    std::vector<std::vector<WallSlice>> slices;
    if (!slice_wall(wall, slices)) return false;
    std::vector<Strip> strips(slices.size());
    for (size_t s = 0; s < slices.size(); ++s) {
        for (const WallSlice& slice : slices[s]) {
            const Span span = level_part(slice);
            if (span.top > span.bottom) strips[s].push_back(span);
        }
        const double middle = (wall.along[s] + wall.along[s + 1]) / 2;
        for (const HiddenPart& part : wall.hidden)
            if (part.left < middle && middle < part.right) cut_out(strips[s], part.bottom, part.top);
    }
    rectangles = Packing(wall, limits, std::move(strips)).run();
    return true;
}

}  // namespace citystream::tiles::layers
