// Packing by best fit on a skyline: the lowest gap between higher neighbours takes the rectangle that fits it best of
// all that are left; a gap that nothing fits is filled up to its lower neighbour and lost.
#include <algorithm>

#include "codec/atlas/rectangle_packing_methods.h"

namespace citystream::codec::atlas {

namespace {

struct Segment {
    uint32_t x, y, width;
};

/// The lowest place, and how far its neighbours (or the bin's top) rise above it.
struct Gap {
    size_t segment;
    uint32_t x, y, width;
    uint32_t left, right;  ///< rise of the neighbours
    uint32_t room;         ///< up to the bin's top
};

struct Choice {
    size_t column = RectanglePool::kNone, entry = 0;
    RectangleSize size;
    uint64_t score = 0;
};

/// Percent by which an exact width and a top flush with a neighbour's raise a score.
struct Bonus {
    uint64_t exact_width, flush;
};

class Skyline {
  public:
    explicit Skyline(RectangleSize bin) : height_(bin.height), segments_{{0, 0, bin.width}} {}

    Gap lowest_gap() const {
        size_t lowest = 0;
        for (size_t i = 1; i < segments_.size(); ++i) {
            if (segments_[i].y < segments_[lowest].y) lowest = i;
        }
        const Segment& at = segments_[lowest];
        const uint32_t room = height_ - at.y;
        const uint32_t left = lowest > 0 ? segments_[lowest - 1].y - at.y : room;
        const uint32_t right = lowest + 1 < segments_.size() ? segments_[lowest + 1].y - at.y : room;
        return {lowest, at.x, at.y, at.width, left, right, room};
    }

    /// Gives the gap up to its lower neighbour; the area lost.
    uint64_t raise(const Gap& gap) {
        const uint32_t rise = std::min(gap.left, gap.right);
        segments_[gap.segment].y += rise;
        join(gap.segment);
        return uint64_t{gap.width} * rise;
    }

    /// Places beside the neighbour that it is flush with, else beside the higher one.
    Rectangle place(const Gap& gap, RectangleSize size) {
        const bool at_right = size.height != gap.left && (size.height == gap.right || gap.right > gap.left);
        const uint32_t x = at_right ? gap.x + gap.width - size.width : gap.x;
        const Segment top = {x, gap.y + size.height, size.width};
        Segment& rest = segments_[gap.segment];
        size_t index = gap.segment;
        if (size.width == gap.width) {
            rest = top;
        } else {
            rest.width -= size.width;
            if (!at_right) rest.x += size.width;
            if (at_right) ++index;
            segments_.insert(segments_.begin() + static_cast<ptrdiff_t>(index), top);
        }
        join(index);
        return {x, gap.y, size.width, size.height};
    }

  private:
    /// Joins a segment with neighbours of its height.
    void join(size_t i) {
        if (i + 1 < segments_.size() && segments_[i + 1].y == segments_[i].y) {
            segments_[i].width += segments_[i + 1].width;
            segments_.erase(segments_.begin() + static_cast<ptrdiff_t>(i) + 1);
        }
        if (i > 0 && segments_[i - 1].y == segments_[i].y) {
            segments_[i - 1].width += segments_[i].width;
            segments_.erase(segments_.begin() + static_cast<ptrdiff_t>(i));
        }
    }

    uint32_t height_;
    std::vector<Segment> segments_;
};

/// Tastes 2 and 3 give larger bonuses.
Bonus bonus_of(uint32_t taste) {
    return taste >= 2 ? Bonus{250, 160} : Bonus{150, 120};
}

/// Even tastes weigh area, odd ones height before width.
uint64_t weight_of(RectangleSize size, uint32_t taste) {
    return taste % 2 == 0 ? size.area() : uint64_t{size.height} * kMaxBinSide + size.width;
}

uint64_t score_of(RectangleSize size, const Gap& gap, uint32_t least_width, uint32_t taste) {
    const Bonus bonus = bonus_of(taste);
    uint64_t score = weight_of(size, taste);
    score *= size.width == gap.width ? bonus.exact_width : 100;
    score *= size.height == gap.left || size.height == gap.right ? bonus.flush : 100;
    const uint32_t strip = gap.width - size.width;
    if (strip > 0 && strip < least_width) score = score * size.width / gap.width;  // nothing fits beside it
    return score;
}

void consider(const RectanglePool::Column& column, size_t index, size_t entry, const Gap& gap, uint32_t least_width,
              uint32_t taste, Choice& best) {
    const RectangleSize size = {column.width, column.entries[entry].height};
    const uint64_t score = score_of(size, gap, least_width, taste);
    if (score > best.score) best = {index, entry, size, score};
}

/// Of each width: the tallest that fits, and those flush with a neighbour. Of equal scores the widest.
Choice best_for(const RectanglePool& pool, const Gap& gap, uint32_t taste) {
    Choice best;
    const auto columns = pool.columns();
    const uint32_t height = std::min(gap.room, pool.most_height());
    for (size_t c = pool.columns_up_to(gap.width); c-- > 0;) {
        const RectangleSize most = {columns[c].width, height};
        if (most.width < gap.width && best.score >= weight_of(most, taste) * 100 * bonus_of(taste).flush) break;
        for (const uint32_t limit : {gap.room, gap.left, gap.right}) {
            const size_t entry = RectanglePool::tallest(columns[c], limit);
            if (entry == RectanglePool::kNone) continue;
            if (limit != gap.room && columns[c].entries[entry].height != limit) continue;
            consider(columns[c], c, entry, gap, columns.front().width, taste, best);
        }
    }
    return best;
}

}  // namespace

Packing pack_skyline(std::span<const RectangleSize> sizes, RectangleSize bin, uint32_t taste, PackWhole whole) {
    Packing packing;
    packing.places.resize(sizes.size());
    RectanglePool pool(sizes, bin);
    const bool all = whole == PackWhole::kAllOrNothing;
    if (all && pool.area() != total_area(sizes)) return packing;
    Skyline skyline(bin);
    uint64_t room = bin.area();  // above the skyline
    while (!pool.empty()) {
        const Gap gap = skyline.lowest_gap();
        if (gap.room == 0 || (all && pool.area() > room)) break;
        const Choice choice = best_for(pool, gap, taste);
        if (choice.column == RectanglePool::kNone) {
            room -= skyline.raise(gap);
            continue;
        }
        room -= choice.size.area();
        packing.places[pool.take(choice.column, choice.entry)] = skyline.place(gap, choice.size);
        ++packing.placed;
    }
    return packing;
}

}  // namespace citystream::codec::atlas
