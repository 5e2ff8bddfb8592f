#include "codec/atlas/rectangle_packing_stretch.h"

#include <algorithm>
#include <cassert>

namespace citystream::codec::atlas {

namespace {

constexpr uint32_t kProbes = 8, kProbeStep = kStretchSteps / 512;
/// Rounds of growing: at least so many, more for small sets, and none after so many in a row that gained nothing.
constexpr size_t kGrowthRounds = 4, kGrowthBudget = 8192, kIdleRounds = 4;

struct Packer {
    PackMethod method;
    uint32_t taste;
};

constexpr Packer kBinaryTreePackers[] = {{PackMethod::kBinaryTree, 0}};
constexpr Packer kTreePackers[] = {{PackMethod::kGuillotine, 0},
                                   {PackMethod::kGuillotine, 1},
                                   {PackMethod::kGuillotine, 2},
                                   {PackMethod::kGuillotine, 3},
                                   {PackMethod::kBinaryTree, 0}};
constexpr Packer kAllPackers[] = {
    {PackMethod::kSkyline, 1},    {PackMethod::kSkyline, 0},    {PackMethod::kSkyline, 3},
    {PackMethod::kGuillotine, 0}, {PackMethod::kSkyline, 2},    {PackMethod::kGuillotine, 1},
    {PackMethod::kGuillotine, 2}, {PackMethod::kGuillotine, 3}, {PackMethod::kBinaryTree, 0}};

std::span<const Packer> packers_of(PackEffort effort) {
    switch (effort) {
        case PackEffort::kBinaryTree:
            return kBinaryTreePackers;
        case PackEffort::kStrongestTree:
            return kTreePackers;
        default:
            return kAllPackers;
    }
}

/// The next larger size: one unit on the side that has come less far; as it is where both are at their most.
RectangleSize grown(RectangleSize size, const StretchRange& range) {
    const uint64_t across = size.width - range.least.width, across_most = range.most.width - range.least.width;
    const uint64_t up = size.height - range.least.height, up_most = range.most.height - range.least.height;
    const bool can_across = across < across_most, can_up = up < up_most;
    if (can_across && (!can_up || across * up_most <= up * across_most)) return {size.width + 1, size.height};
    if (can_up) return {size.width, size.height + 1};
    return size;
}

class Search {
  public:
    Search(std::span<const StretchRange> ranges, RectangleSize bin, PackEffort effort)
        : ranges_(ranges), bin_(bin), effort_(effort) {}

    /// Keeps the layout when the sizes fit and use more than the best so far.
    bool try_sizes(std::vector<RectangleSize> sizes) {
        ++layouts_;
        auto packing = pack_with_effort(sizes, bin_, effort_, hint_);
        if (!packing) return false;
        const uint64_t area = total_area(sizes);
        if (!best_ || area > best_area_) {
            best_area_ = area;
            best_ = StretchResult{std::move(*packing), std::move(sizes), 0, 0};
        }
        return true;
    }

    std::vector<RectangleSize> sizes_at(uint32_t stretch) const {
        std::vector<RectangleSize> sizes(ranges_.size());
        std::transform(ranges_.begin(), ranges_.end(), sizes.begin(),
                       [stretch](const StretchRange& range) { return stretched(range, stretch); });
        return sizes;
    }

    /// Algorithm 6, with a few probes above where it ended. The least sizes are known to fit.
    void bisect() {
        uint32_t fits = 0, fails = kStretchSteps + 1;
        while (fails - fits > 1) {
            const uint32_t middle = fails == kStretchSteps + 1 && fits == 0 ? kStretchSteps : (fits + fails) / 2;
            (try_sizes(sizes_at(middle)) ? fits : fails) = middle;
        }
        stretch_ = fits;
        for (uint32_t i = 1; i <= kProbes && fits + i * kProbeStep <= kStretchSteps; ++i) {
            if (try_sizes(sizes_at(fits + i * kProbeStep))) stretch_ = fits + i * kProbeStep;
        }
    }

    /// One unit more for `count` rectangles from `begin` on (cyclic), as large a count as fits. Whether it gained.
    bool grow_once(size_t begin) {
        const std::vector<RectangleSize> sizes = best_->sizes;
        const uint64_t before = best_area_;
        size_t fits = 0, fails = sizes.size() + 1;
        while (fails - fits > 1) {
            const size_t count = (fits + fails) / 2;
            std::vector<RectangleSize> larger = sizes;
            for (size_t i = 0; i < count; ++i) {
                const size_t at = (begin + i) % sizes.size();
                larger[at] = grown(sizes[at], ranges_[at]);
            }
            (try_sizes(std::move(larger)) ? fits : fails) = count;
        }
        return best_area_ > before;
    }

    /// Each round begins elsewhere, by the golden section, so that all rectangles get their turn.
    void grow() {
        const size_t count = ranges_.size(), rounds = std::max(kGrowthRounds, kGrowthBudget / count);
        size_t idle = 0;
        for (size_t round = 0; round < rounds && idle < kIdleRounds; ++round)
            idle = grow_once(round * 2654435769u % count) ? 0 : idle + 1;
    }

    std::optional<StretchResult> run() {
        if (ranges_.empty() || !try_sizes(sizes_at(0))) return std::nullopt;
        bisect();
        grow();
        best_->stretch = stretch_;
        best_->layouts = layouts_;
        return std::move(best_);
    }

  private:
    std::span<const StretchRange> ranges_;
    RectangleSize bin_;
    PackEffort effort_;
    uint32_t hint_ = 0, layouts_ = 0, stretch_ = 0;
    uint64_t best_area_ = 0;
    std::optional<StretchResult> best_;
};

}  // namespace

std::optional<Packing> pack_with_effort(std::span<const RectangleSize> sizes, RectangleSize bin, PackEffort effort,
                                        uint32_t& hint) {
    if (total_area(sizes) > bin.area()) return std::nullopt;
    const auto packers = packers_of(effort);
    const auto first = static_cast<uint32_t>(hint % packers.size());
    for (uint32_t i = 0; i < packers.size(); ++i) {
        const uint32_t at = (first + i) % static_cast<uint32_t>(packers.size());
        Packing packing = pack_rectangles(sizes, bin, packers[at].method, packers[at].taste);
        if (!packing.complete()) continue;
        hint = at;
        return packing;
    }
    return std::nullopt;
}

Packing pack_as_many_as_fit(std::span<const RectangleSize> sizes, RectangleSize bin, PackEffort effort) {
    Packing best;
    uint64_t best_area = 0;
    for (const Packer packer : packers_of(effort)) {
        Packing packing = pack_rectangles(sizes, bin, packer.method, packer.taste, PackWhole::kAsManyAsFit);
        uint64_t area = 0;
        for (const Rectangle& place : packing.places) area += place.area();
        if (area > best_area || best.places.empty()) {
            best_area = area;
            best = std::move(packing);
        }
    }
    return best;
}

RectangleSize stretched(const StretchRange& range, uint32_t stretch) {
    assert(range.least.fits_in(range.most) && stretch <= kStretchSteps);
    const auto between = [stretch](uint64_t least, uint64_t most) {
        return static_cast<uint32_t>(least + (most - least) * stretch / kStretchSteps);
    };
    return {between(range.least.width, range.most.width), between(range.least.height, range.most.height)};
}

std::optional<StretchResult> optimise_stretch(std::span<const StretchRange> ranges, RectangleSize bin,
                                              PackEffort effort) {
    return Search(ranges, bin, effort).run();
}

}  // namespace citystream::codec::atlas
