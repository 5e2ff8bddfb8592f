#include "codec/atlas/rectangle_packing_tight.h"

#include <algorithm>

namespace citystream::codec::atlas {

namespace {

constexpr uint64_t kWidthEighths[] = {8, 7, 9, 10, 12};

uint64_t square_root_up(uint64_t value) {
    uint64_t low = 0, high = uint64_t{1} << 32;
    while (low < high) {
        const uint64_t middle = (low + high) / 2;
        if (middle * middle >= value)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

class TightSearch {
  public:
    TightSearch(std::span<const RectangleSize> sizes, RectangleSize largest, PackEffort effort)
        : sizes_(sizes), largest_(largest), effort_(effort), area_(total_area(sizes)) {
        for (const RectangleSize size : sizes)
            least_ = {std::max(least_.width, size.width), std::max(least_.height, size.height)};
    }

    std::optional<TightPacking> run() {
        if (!least_.fits_in(largest_)) return std::nullopt;
        const uint64_t root = square_root_up(area_);
        for (const uint64_t eighths : kWidthEighths) {
            const uint64_t width = std::clamp<uint64_t>((root * eighths + 7) / 8, least_.width, largest_.width);
            try_width(static_cast<uint32_t>(width));
        }
        if (!best_) try_width(largest_.width);
        return std::move(best_);
    }

  private:
    /// Steps up in doubling strides from the height that the area alone asks for, then bisects.
    void try_width(uint32_t width) {
        const uint64_t by_area = (area_ + width - 1) / width;
        if (by_area > largest_.height) return;
        uint32_t fails = std::max(static_cast<uint32_t>(by_area), least_.height) - 1, fits = 0;
        for (uint32_t stride = 1; fits == 0; stride *= 2) {
            const uint32_t height = std::min(fails + stride, most_height(width));
            if (height <= fails) return;
            (try_bin({width, height}) ? fits : fails) = height;
        }
        while (fits - fails > 1) {
            const uint32_t height = (fits + fails) / 2;
            (try_bin({width, height}) ? fits : fails) = height;
        }
    }

    /// Higher bins would not be smaller than the best so far.
    uint32_t most_height(uint32_t width) const {
        if (!best_) return largest_.height;
        return static_cast<uint32_t>(std::min<uint64_t>(largest_.height, (best_->bin.area() - 1) / width));
    }

    bool try_bin(RectangleSize bin) {
        auto packing = pack_with_effort(sizes_, bin, effort_, hint_);
        if (!packing) return false;
        if (!best_ || bin.area() < best_->bin.area()) best_ = TightPacking{bin, std::move(*packing)};
        return true;
    }

    std::span<const RectangleSize> sizes_;
    RectangleSize largest_, least_ = {1, 1};
    PackEffort effort_;
    uint64_t area_;
    uint32_t hint_ = 0;
    std::optional<TightPacking> best_;
};

}  // namespace

std::optional<TightPacking> pack_tight(std::span<const RectangleSize> sizes, RectangleSize largest, PackEffort effort) {
    return TightSearch(sizes, largest, effort).run();
}

}  // namespace citystream::codec::atlas
