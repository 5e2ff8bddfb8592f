// Algorithms 3 and 4 of the paper: a binary tree of free rectangles, largest first, first fit.
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "codec/atlas/rectangle_packing_methods.h"

namespace citystream::codec::atlas {

namespace {

/// Largest area first; equal ones by their longer side, then by index (the paper does not say how it sorts).
std::vector<uint32_t> largest_first(std::span<const RectangleSize> sizes) {
    std::vector<uint32_t> order(sizes.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto longer_side = [&](uint32_t i) { return std::max(sizes[i].width, sizes[i].height); };
    std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
        if (sizes[a].area() != sizes[b].area()) return sizes[a].area() > sizes[b].area();
        if (longer_side(a) != longer_side(b)) return longer_side(a) > longer_side(b);
        return a < b;
    });
    return order;
}

/// What is known of the empty leaves below a node: for each power of two, how high the highest of those at least that
/// wide is. Decides without looking below whether one may be large enough; only widths within a factor of two deceive
/// it.
class FreeSpace {
  public:
    FreeSpace() = default;
    explicit FreeSpace(RectangleSize leaf) {
        for (uint32_t c = 0; c <= class_of(leaf.width); ++c) height_[c] = leaf.height;
    }
    bool may_fit(RectangleSize size) const { return height_[class_of(size.width)] >= size.height; }
    static FreeSpace joined(const FreeSpace& a, const FreeSpace& b) {
        FreeSpace both;
        for (size_t c = 0; c < both.height_.size(); ++c) both.height_[c] = std::max(a.height_[c], b.height_[c]);
        return both;
    }
    bool operator==(const FreeSpace&) const = default;

  private:
    static uint32_t class_of(uint32_t width) { return static_cast<uint32_t>(std::bit_width(width)) - 1; }
    std::array<uint32_t, std::bit_width(kMaxBinSide)> height_{};
};

class BinaryTree {
  public:
    explicit BinaryTree(RectangleSize bin) { add({0, 0, bin.width, bin.height}, 0); }

    /// Algorithm 4. False: no leaf is large enough.
    bool insert(uint32_t rectangle, RectangleSize size, Rectangle& place) {
        const uint32_t leaf = first_fit(size);
        if (leaf == SlicingNode::kEmpty) return false;
        const uint32_t exact = split_to(leaf, size);
        tree_.nodes[exact].rectangle = rectangle;
        place = room_[exact].region;
        room_[exact].free = FreeSpace();
        update_free(exact);
        return true;
    }

    SlicingTree take() { return std::move(tree_); }

  private:
    struct Room {
        Rectangle region;
        FreeSpace free;
        uint32_t parent;
    };

    uint32_t add(const Rectangle& region, uint32_t parent) {
        tree_.nodes.emplace_back();
        room_.push_back({region, FreeSpace(region.size()), parent});
        return static_cast<uint32_t>(room_.size() - 1);
    }

    /// The first empty leaf, left before right, that the size fits in.
    uint32_t first_fit(RectangleSize size) {
        stack_.assign(1, 0);
        while (!stack_.empty()) {
            const uint32_t node = stack_.back();
            stack_.pop_back();
            if (!room_[node].free.may_fit(size)) continue;
            if (tree_.nodes[node].cut == SlicingNode::Cut::kNone) {
                if (size.fits_in(room_[node].region.size())) return node;
                continue;
            }
            stack_.push_back(tree_.nodes[node].second);
            stack_.push_back(tree_.nodes[node].first);
        }
        return SlicingNode::kEmpty;
    }

    /// Cuts a leaf, at most twice, until one of exactly this size lies at its lower left corner.
    uint32_t split_to(uint32_t leaf, RectangleSize size) {
        while (room_[leaf].region.size() != size) {
            const Rectangle region = room_[leaf].region;
            Rectangle near = region, far = region;
            const bool across = region.width - size.width > region.height - size.height;
            if (across) {
                near.width = size.width;
                far.x += size.width;
                far.width -= size.width;
            } else {
                near.height = size.height;
                far.y += size.height;
                far.height -= size.height;
            }
            const uint32_t first = add(near, leaf), second = add(far, leaf);
            tree_.nodes[leaf] = {across ? SlicingNode::Cut::kAcross : SlicingNode::Cut::kUp, SlicingNode::kEmpty, first,
                                 second};
            leaf = first;
        }
        return leaf;
    }

    void update_free(uint32_t node) {
        while (node != 0) {
            node = room_[node].parent;
            const FreeSpace free =
                FreeSpace::joined(room_[tree_.nodes[node].first].free, room_[tree_.nodes[node].second].free);
            if (free == room_[node].free) return;
            room_[node].free = free;
        }
    }

    SlicingTree tree_;
    std::vector<Room> room_;  ///< like the nodes
    std::vector<uint32_t> stack_;
};

}  // namespace

Packing pack_binary_tree(std::span<const RectangleSize> sizes, RectangleSize bin, PackWhole whole) {
    Packing packing;
    packing.places.resize(sizes.size());
    BinaryTree tree(bin);
    for (const uint32_t i : largest_first(sizes)) {
        if (tree.insert(i, sizes[i], packing.places[i])) {
            ++packing.placed;
        } else if (whole == PackWhole::kAllOrNothing) {
            break;
        }
    }
    packing.tree = tree.take();
    return packing;
}

}  // namespace citystream::codec::atlas
