#include "codec/atlas/rectangle_packing_fill.h"

#include <algorithm>
#include <cassert>

namespace citystream::codec::atlas {

namespace {

using Cut = SlicingNode::Cut;

/// Along one axis: what a subtree needs, how far it grows with use, and how far it may grow.
struct Range {
    uint64_t least = 0, wanted_most = 0, most = 0;
};

/// Both of a cut's sides, one behind the other along the axis.
Range in_a_row(const Range& a, const Range& b) {
    return {a.least + b.least, a.wanted_most + b.wanted_most, a.most + b.most};
}

/// Both sides share the axis: they grow together, so the one that may grow less decides.
Range side_by_side(const Range& a, const Range& b) {
    const uint64_t least = std::max(a.least, b.least);
    const uint64_t wanted_most = std::max(least, std::min(a.wanted_most, b.wanted_most));
    return {least, wanted_most, std::max(wanted_most, std::min(a.most, b.most))};
}

struct Needs {
    bool empty = true;
    Range across, up;
};

Needs needs_of_leaf(const GrowthLimit& limit) {
    const auto range = [](uint32_t least, uint32_t wanted_most, uint32_t most) {
        const uint64_t wanted = std::max(least, wanted_most);
        return Range{least, wanted, std::max<uint64_t>(wanted, most)};
    };
    return {false, range(limit.least.width, limit.wanted_most.width, limit.most.width),
            range(limit.least.height, limit.wanted_most.height, limit.most.height)};
}

/// Needs of all subtrees, leaves first.
std::vector<Needs> gather_needs(const SlicingTree& tree, std::span<const GrowthLimit> limits) {
    std::vector<Needs> needs(tree.nodes.size());
    for (size_t i = tree.nodes.size(); i-- > 0;) {
        const SlicingNode& node = tree.nodes[i];
        if (node.cut == Cut::kNone) {
            if (node.rectangle != SlicingNode::kEmpty) needs[i] = needs_of_leaf(limits[node.rectangle]);
            continue;
        }
        const Needs& a = needs[node.first];
        const Needs& b = needs[node.second];
        if (a.empty || b.empty) {
            needs[i] = a.empty ? b : a;
        } else if (node.cut == Cut::kAcross) {
            needs[i] = {false, in_a_row(a.across, b.across), side_by_side(a.up, b.up)};
        } else {
            needs[i] = {false, side_by_side(a.across, b.across), in_a_row(a.up, b.up)};
        }
    }
    return needs;
}

/// The part of `space` (at most weight_a + weight_b, not 0) that a gets, in proportion, rounded half up.
uint64_t proportion(uint64_t space, uint64_t weight_a, uint64_t weight_b) {
    const uint64_t sum = weight_a + weight_b;
    return (2 * space * weight_a + sum) / (2 * sum);
}

/// Where to cut `length` (at least what both need): the first side's length.
uint64_t first_length(uint64_t length, const Range& a, const Range& b) {
    uint64_t own_a = a.least, own_b = b.least;
    uint64_t space = length - own_a - own_b;
    const auto share = [&](uint64_t room_a, uint64_t room_b) {
        const uint64_t given = std::min(space, room_a + room_b);
        if (given == 0) return;
        const uint64_t to_a = proportion(given, room_a, room_b);
        own_a += to_a;
        own_b += given - to_a;
        space -= given;
    };
    share(a.wanted_most - own_a, b.wanted_most - own_b);
    share(a.most - own_a, b.most - own_b);
    share(a.least * space, b.least * space);  // nobody may take it: spread, and cut off at the leaves
    return own_a;
}

Rectangle clipped(const Rectangle& region, RectangleSize most) {
    return {region.x, region.y, std::min(region.width, most.width), std::min(region.height, most.height)};
}

std::vector<Rectangle> fill_subtrees(const Packing& packing, RectangleSize bin, std::span<const GrowthLimit> limits) {
    const std::vector<SlicingNode>& nodes = packing.tree.nodes;
    const std::vector<Needs> needs = gather_needs(packing.tree, limits);
    std::vector<Rectangle> places = packing.places;
    std::vector<Rectangle> regions(nodes.size());
    regions[0] = {0, 0, bin.width, bin.height};
    for (size_t i = 0; i < nodes.size(); ++i) {
        const SlicingNode& node = nodes[i];
        if (needs[i].empty) continue;
        const Rectangle region = regions[i];
        if (node.cut == Cut::kNone) {
            const GrowthLimit& limit = limits[node.rectangle];
            places[node.rectangle] = clipped(region, {std::max(limit.least.width, limit.most.width),
                                                      std::max(limit.least.height, limit.most.height)});
            continue;
        }
        const Needs& a = needs[node.first];
        const Needs& b = needs[node.second];
        Rectangle& first = regions[node.first] = region;
        Rectangle& second = regions[node.second] = region;
        if (a.empty || b.empty) continue;
        if (node.cut == Cut::kAcross) {
            first.width = static_cast<uint32_t>(first_length(region.width, a.across, b.across));
            second.x += first.width;
            second.width -= first.width;
        } else {
            first.height = static_cast<uint32_t>(first_length(region.height, a.up, b.up));
            second.y += first.height;
            second.height -= first.height;
        }
    }
    return places;
}

/// The region of every node as the packer cut it: a leaf that is not empty is its rectangle, the others follow.
std::vector<Rectangle> regions_as_cut(const Packing& packing, RectangleSize bin) {
    const std::vector<SlicingNode>& nodes = packing.tree.nodes;
    std::vector<Rectangle> regions(nodes.size());
    // A first child's rectangle lies in its lower left corner with both sides exact, so the cut is at its far side.
    std::vector<RectangleSize> exact(nodes.size());
    for (size_t i = nodes.size(); i-- > 0;) {
        const SlicingNode& node = nodes[i];
        if (node.cut == Cut::kNone) {
            if (node.rectangle != SlicingNode::kEmpty) exact[i] = packing.places[node.rectangle].size();
        } else {
            exact[i] = exact[node.first];
        }
    }
    regions[0] = {0, 0, bin.width, bin.height};
    for (size_t i = 0; i < nodes.size(); ++i) {
        const SlicingNode& node = nodes[i];
        if (node.cut == Cut::kNone) continue;
        Rectangle& first = regions[node.first] = regions[i];
        Rectangle& second = regions[node.second] = regions[i];
        if (node.cut == Cut::kAcross) {
            first.width = exact[node.first].width;
            second.x += first.width;
            second.width -= first.width;
        } else {
            first.height = exact[node.first].height;
            second.y += first.height;
            second.height -= first.height;
        }
    }
    return regions;
}

std::vector<Rectangle> fill_sibling_leaves(const Packing& packing, RectangleSize bin,
                                           std::span<const GrowthLimit> limits) {
    const std::vector<SlicingNode>& nodes = packing.tree.nodes;
    const std::vector<Rectangle> regions = regions_as_cut(packing, bin);
    std::vector<Rectangle> places = packing.places;
    for (size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].cut == Cut::kNone) continue;
        const SlicingNode& a = nodes[nodes[i].first];
        const SlicingNode& b = nodes[nodes[i].second];
        if (a.cut != Cut::kNone || b.cut != Cut::kNone) continue;
        if ((a.rectangle == SlicingNode::kEmpty) == (b.rectangle == SlicingNode::kEmpty)) continue;
        const uint32_t filled = a.rectangle == SlicingNode::kEmpty ? b.rectangle : a.rectangle;
        places[filled] = clipped(regions[i], limits[filled].most);
    }
    return places;
}

/// Which units of a bin are taken.
class Cells {
  public:
    explicit Cells(RectangleSize bin) : bin_(bin), taken_(bin.area(), 0) {}

    void take(const Rectangle& area) {
        for (uint32_t y = area.y; y < area.y + area.height; ++y)
            std::fill_n(taken_.begin() + static_cast<ptrdiff_t>(index(area.x, y)), area.width, uint8_t{1});
    }

    bool are_free(const Rectangle& area) const {
        if (area.x >= bin_.width || area.y >= bin_.height) return false;  // also left of 0: the subtraction wraps
        for (uint32_t y = area.y; y < area.y + area.height; ++y) {
            const auto row = taken_.begin() + static_cast<ptrdiff_t>(index(area.x, y));
            if (std::find(row, row + area.width, uint8_t{1}) != row + area.width) return false;
        }
        return true;
    }

  private:
    uint64_t index(uint32_t x, uint32_t y) const { return uint64_t{y} * bin_.width + x; }
    RectangleSize bin_;
    std::vector<uint8_t> taken_;
};

/// Grows a place to all four sides, row by row and column by column, as far as cells are free.
void grow_place(Rectangle& place, RectangleSize most, Cells& cells) {
    const auto grow = [&](bool across, bool towards_zero) {
        for (;;) {
            if (across ? place.width >= most.width : place.height >= most.height) return;
            Rectangle strip = place;
            (across ? strip.width : strip.height) = 1;
            if (towards_zero)
                --(across ? strip.x : strip.y);
            else
                (across ? strip.x : strip.y) += across ? place.width : place.height;
            if (!cells.are_free(strip)) return;
            cells.take(strip);
            if (towards_zero) --(across ? place.x : place.y);
            ++(across ? place.width : place.height);
        }
    };
    for (const bool across : {true, false}) {
        grow(across, false);
        grow(across, true);
    }
}

/// Others' growth only takes room away, so one pass leaves nothing that could still grow.
std::vector<Rectangle> fill_in_place(const Packing& packing, RectangleSize bin, std::span<const GrowthLimit> limits) {
    std::vector<Rectangle> places = packing.places;
    if (bin.area() > kMostCells) return places;
    Cells cells(bin);
    for (const Rectangle& place : places) cells.take(place);
    for (size_t i = 0; i < places.size(); ++i) grow_place(places[i], limits[i].most, cells);
    return places;
}

}  // namespace

std::vector<Rectangle> fill_leaves(const Packing& packing, RectangleSize bin, std::span<const GrowthLimit> limits,
                                   FillMode mode) {
    assert(limits.size() == packing.places.size());
    if (mode == FillMode::kInPlace) return fill_in_place(packing, bin, limits);
    if (packing.tree.nodes.empty() || mode == FillMode::kNone) return packing.places;
    if (mode == FillMode::kSiblingLeaves) return fill_sibling_leaves(packing, bin, limits);
    return fill_subtrees(packing, bin, limits);
}

}  // namespace citystream::codec::atlas
