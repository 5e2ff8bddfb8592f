#include "codec/atlas/chart_search.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

namespace citystream::codec::atlas {

namespace {

/// The sizes that one axis may have: multiples of a step, and its full length. Numbered from 1.
struct Sizes {
    uint32_t full, step;

    uint32_t count() const { return (full + step - 1) / step; }
    uint32_t of(uint32_t i) const { return i == count() ? full : i * step; }
};

/// A bracket of one axis: size number `high` is accepted, `low` is not (or is 0).
struct Bracket {
    uint32_t low, high;

    bool open() const { return high - low > 1; }
    uint32_t middle() const { return low + (high - low) / 2; }
    void narrow(uint32_t at, bool accepted) { (accepted ? high : low) = at; }
};

/// Which axis is shrunk first; the first one's result is kept for the next candidate.
enum class First : uint8_t { kWidth, kHeight };

class Search {
  public:
    Search(const Image& original, const SearchSettings& settings)
        : settings_(settings),
          original_(original),
          metric_(original_, settings.metric.kind, settings.view),
          widths_{original.width, settings.multiple},
          heights_{original.height, settings.multiple},
          best_{original, 0, 0} {}

    SearchResult run() {
        const SearchOrder order = settings_.order;
        const bool all = order == SearchOrder::kBest, both = order == SearchOrder::kBoth || all;
        // What a side cannot be at the other's full size it is not at a smaller one: the second phase starts there.
        Bracket width{0, widths_.count()}, height{0, heights_.count()};
        if (both || order == SearchOrder::kWidthFirst) search_width(width, heights_.count(), First::kWidth);
        if (both || order == SearchOrder::kHeightFirst) search_height(height, widths_.count(), First::kHeight);
        if (both || order == SearchOrder::kWidthFirst) {
            Bracket second{height.low, heights_.count()};
            search_height(second, width.high, First::kWidth);
        }
        if (both || order == SearchOrder::kHeightFirst) {
            Bracket second{width.low, widths_.count()};
            search_width(second, height.high, First::kHeight);
        }
        if (all || order == SearchOrder::kAlternate)
            search_alternately({width.low, widths_.count()}, {height.low, heights_.count()});
        return std::move(best_);
    }

  private:
    void search_width(Bracket& width, uint32_t height, First first) {
        while (width.open() && can_win(width.low + 1, height)) try_width(width, height, first);
    }

    void search_height(Bracket& height, uint32_t width, First first) {
        while (height.open() && can_win(width, height.low + 1)) try_height(height, width, first);
    }

    void search_alternately(Bracket width, Bracket height) {
        while ((width.open() || height.open()) && can_win(width.low + 1, height.low + 1)) {
            if (width.open()) try_width(width, height.high, First::kWidth);
            if (height.open()) try_height(height, width.high, First::kWidth);
        }
    }

    void try_width(Bracket& width, uint32_t height, First first) {
        const uint32_t at = width.middle();
        width.narrow(at, accepts(at, height, first));
    }

    void try_height(Bracket& height, uint32_t width, First first) {
        const uint32_t at = height.middle();
        height.narrow(at, accepts(width, at, first));
    }

    /// Whether this size would be smaller than what has been found.
    bool can_win(uint32_t width, uint32_t height) const {
        return uint64_t{widths_.of(width)} * heights_.of(height) < best_.image.area();
    }

    bool accepts(uint32_t width, uint32_t height, First first) {
        const auto [known, is_new] = tried_.try_emplace({width, height}, false);
        if (!is_new) return known->second;
        Image small = shrink(widths_.of(width), heights_.of(height), first);
        quantise(small);
        const double most = settings_.metric.largest_error();
        const double error =
            metric_.error(enlarged_rows(small, original_.width, original_.height, settings_.edges), most);
        ++best_.calls;
        known->second = error <= most;
        if (known->second && small.area() < best_.image.area()) {
            best_.image = std::move(small);
            best_.error = error;
        }
        return known->second;
    }

    Image shrink(uint32_t width, uint32_t height, First first) {
        const bool by_width = first == First::kWidth;
        const std::pair<First, uint32_t> key(first, by_width ? width : height);
        if (half_shrunk_.empty() || key != half_shrunk_key_) {
            half_shrunk_ = by_width ? shrink_width(original_, width) : shrink_height(original_, height);
            half_shrunk_key_ = key;
        }
        return by_width ? shrink_height(half_shrunk_, height) : shrink_width(half_shrunk_, width);
    }

    Image shrink_width(const Image& image, uint32_t width) const {
        return resample_width(image, width, settings_.filter, settings_.edges.repeat_u);
    }
    Image shrink_height(const Image& image, uint32_t height) const {
        return resample_height(image, height, settings_.filter, settings_.edges.repeat_v);
    }

    const SearchSettings& settings_;
    const Image& original_;
    MetricReference metric_;
    Sizes widths_, heights_;
    SearchResult best_;
    std::map<std::pair<uint32_t, uint32_t>, bool> tried_;  // by size numbers
    Image half_shrunk_;
    std::pair<First, uint32_t> half_shrunk_key_{};
};

constexpr std::array<std::string_view, 5> kOrderNames = {"width", "height", "both", "alternate", "best"};

}  // namespace

SearchResult search_chart(const Image& original, const SearchSettings& settings) {
    assert(!original.empty() && settings.multiple > 0);
    Image stored = original;
    quantise(stored);
    if (settings.metric.kind == MetricKind::kNone) return {std::move(stored), 0, 0};
    return Search(stored, settings).run();
}

std::optional<SearchOrder> parse_search_order(std::string_view text) {
    const auto found = std::find(kOrderNames.begin(), kOrderNames.end(), text);
    if (found == kOrderNames.end()) return std::nullopt;
    return static_cast<SearchOrder>(found - kOrderNames.begin());
}

std::string_view name_of(SearchOrder order) {
    return kOrderNames[static_cast<size_t>(order)];
}

}  // namespace citystream::codec::atlas
