// Packing by straight cuts, place by place: the free rectangle at hand takes the rectangle that fits it best of all
// that are left, is cut at its two free sides, and the remainder beside it is filled before the one that stays whole.
// With hundreds of rectangles on a coarse grid there is nearly always one that fits a side exactly, so that one
// remainder vanishes; what is lost are ends that are smaller than all that is left.
#include <algorithm>

#include "codec/atlas/rectangle_packing_methods.h"

namespace citystream::codec::atlas {

namespace {

struct Choice {
    size_t column = RectanglePool::kNone, entry = 0;
    RectangleSize size;
    uint64_t score = 0;
};

/// What "best" weighs: even tastes, exact sides first and then area; odd ones, area times two per exact side, halved
/// where the strip beside is too narrow for anything left.
uint64_t score_of(RectangleSize size, RectangleSize free, uint32_t least_width, uint32_t taste) {
    const bool exact_width = size.width == free.width, exact_height = size.height == free.height;
    const uint32_t exact = (exact_width ? 1u : 0u) + (exact_height ? 1u : 0u);
    if (taste % 2 == 0) return uint64_t{exact} << 40 | size.area();
    const bool strip_is_lost = !exact_width && free.width - size.width < least_width;
    return (size.area() * 2 << exact) >> (strip_is_lost ? 1 : 0);
}

/// No rectangle of this width, narrower than the free one, scores more.
uint64_t most_score(uint32_t width, RectangleSize free, uint32_t taste) {
    return score_of({width, free.height}, {free.width, free.height}, 0, taste);
}

/// The best one for a free rectangle, by score; of equal ones the widest.
Choice best_for(const RectanglePool& pool, RectangleSize free, uint32_t taste) {
    Choice best;
    const auto columns = pool.columns();
    for (size_t c = pool.columns_up_to(free.width); c-- > 0;) {
        if (best.score >= most_score(columns[c].width, free, taste)) break;
        const size_t entry = RectanglePool::tallest(columns[c], free.height);
        if (entry == RectanglePool::kNone) continue;
        const RectangleSize size = {columns[c].width, columns[c].entries[entry].height};
        const uint64_t score = score_of(size, free, columns.front().width, taste);
        if (score > best.score) best = {c, entry, size, score};
    }
    return best;
}

class Guillotine {
  public:
    Guillotine(RectangleSize bin, size_t count, uint32_t taste) : taste_(taste) {
        packing_.places.resize(count);
        push({0, 0, bin.width, bin.height}, add_node());
    }

    bool has_free() const { return !free_.empty(); }
    RectangleSize next_free() const { return free_.back().region.size(); }
    void drop_free() { free_.pop_back(); }

    /// Puts a rectangle in the lower left corner of the next free one.
    void place(uint32_t rectangle, RectangleSize size) {
        const Free free = free_.back();
        free_.pop_back();
        packing_.places[rectangle] = {free.region.x, free.region.y, size.width, size.height};
        ++packing_.placed;
        const bool up_first = cut_up_first(free.region.size(), size);
        const uint32_t near = cut(free.node, free.region, size, up_first);
        Rectangle strip = free.region;  // what is left of the part with the rectangle
        (up_first ? strip.height : strip.width) = up_first ? size.height : size.width;
        packing_.tree.nodes[cut(near, strip, size, !up_first)].rectangle = rectangle;
    }

    Packing take() { return std::move(packing_); }

  private:
    struct Free {
        Rectangle region;
        uint32_t node;
    };

    uint32_t add_node() {
        packing_.tree.nodes.emplace_back();
        return static_cast<uint32_t>(packing_.tree.nodes.size() - 1);
    }

    void push(const Rectangle& region, uint32_t node) { free_.push_back({region, node}); }

    /// Tastes 0 and 1 keep the larger remainder in one piece; 2 and 3 cut the shorter way through the free rectangle.
    bool cut_up_first(RectangleSize free, RectangleSize size) const {
        if (taste_ >= 2) return free.width <= free.height;
        return uint64_t{free.height - size.height} * free.width >= uint64_t{free.width - size.width} * free.height;
    }

    /// Cuts a node's region at the rectangle's top (up) or right side; the far part becomes free. Gives the near part's
    /// node, the node itself when there is nothing to cut off.
    uint32_t cut(uint32_t node, const Rectangle& region, RectangleSize size, bool up) {
        Rectangle far = region;
        if (up) {
            far.y += size.height;
            far.height -= size.height;
        } else {
            far.x += size.width;
            far.width -= size.width;
        }
        if (far.area() == 0) return node;
        const uint32_t first = add_node(), second = add_node();
        packing_.tree.nodes[node] = {up ? SlicingNode::Cut::kUp : SlicingNode::Cut::kAcross, SlicingNode::kEmpty, first,
                                     second};
        push(far, second);
        return first;
    }

    uint32_t taste_;
    Packing packing_;
    std::vector<Free> free_;  ///< the last one is filled next: what lies beside a rectangle before what lies beyond
};

}  // namespace

Packing pack_guillotine(std::span<const RectangleSize> sizes, RectangleSize bin, uint32_t taste, PackWhole whole) {
    RectanglePool pool(sizes, bin);
    Guillotine guillotine(bin, sizes.size(), taste);
    const bool all = whole == PackWhole::kAllOrNothing;
    if (all && pool.area() != total_area(sizes)) return guillotine.take();
    uint64_t room = bin.area();  // of the free rectangles
    while (!pool.empty() && guillotine.has_free()) {
        if (all && pool.area() > room) break;
        const RectangleSize free = guillotine.next_free();
        const Choice choice = best_for(pool, free, taste);
        if (choice.column == RectanglePool::kNone) {
            room -= free.area();
            guillotine.drop_free();
            continue;
        }
        room -= choice.size.area();
        guillotine.place(pool.take(choice.column, choice.entry), choice.size);
    }
    return guillotine.take();
}

}  // namespace citystream::codec::atlas
