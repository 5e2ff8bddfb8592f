#include "codec/atlas/chart_search.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "codec/atlas/alpha_mask.h"
#include "codec/atlas/side_search.h"
#include "codec/atlas/wide_loops.h"

namespace citystream::codec::atlas {

namespace {

/// Of the metric calls that both orders have together: what each side may take alone.
constexpr double kSideShare = 0.3;
/// A guess is worth a call if it is smaller than what has been found by this part of it.
constexpr uint64_t kLeastGain = 128;

/// How the errors of two sides make that of a chart: the norm of some power. 1: their sum, 2: as if independent, large:
/// the greater one.
class SideNorm {
  public:
    /// The error that one side may have beside the other's `a`; negative: none.
    double rest(double limit, double a) const {
        if (a > limit) return -1;
        return power(power(limit, power_) - power(a, power_), 1 / power_);
    }
    /// Takes the power by which two sides have an error, where these say something of it.
    void learn(double a, double b, double error) {
        if (std::min(a, b) <= kLeastShare * std::max(a, b)) return;
        double low = kLeastPower, high = kMostPower;
        for (int step = 0; step < 12; ++step) {
            const double middle = (low + high) / 2;
            (norm(a, b, middle) > error ? low : high) = middle;
        }
        power_ = high;
    }

  private:
    static constexpr double kLeastPower = 0.5, kMostPower = 16, kLeastShare = 0.02;
    static double power(double base, double exponent) {
        return base > 0 ? static_cast<double>(fast_pow(static_cast<float>(base), static_cast<float>(exponent))) : 0;
    }
    static double norm(double a, double b, double p) {
        const double most = std::max(a, b);
        return most > 0 ? most * power(1 + power(std::min(a, b) / most, p), 1 / p) : 0;
    }

    double power_ = 2;
};

Image tested(Image image) {
    test_alpha(image);
    return image;
}

/// Which axis is shrunk first; the first one's result is kept for the next candidate.
enum class First : uint8_t { kWidth, kHeight };

class Search {
  public:
    Search(const Image& original, const SearchSettings& settings)
        : settings_(settings),
          original_(original),
          metric_(settings.there ? tested(original_) : original_, settings.metric.kind, settings.view),
          widths_{original.width, settings.multiple},
          heights_{original.height, settings.multiple},
          best_{original, 0, 0} {}

    SearchResult run() {
        const SearchOrder order = settings_.order;
        const bool all = order == SearchOrder::kBest;
        // What a side cannot be at the other's full size it is not at a smaller one: the second phase starts there.
        Bracket width{0, widths_.count()}, height{0, heights_.count()};
        if (all || order == SearchOrder::kWidthFirst) search_width(width, heights_.count(), First::kWidth);
        if (all || order == SearchOrder::kHeightFirst) search_height(height, widths_.count(), First::kHeight);
        if (all || order == SearchOrder::kWidthFirst) {
            Bracket second{height.low, heights_.count()};
            search_height(second, width.high, First::kWidth);
        }
        if (all || order == SearchOrder::kHeightFirst) {
            Bracket second{width.low, widths_.count()};
            search_width(second, height.high, First::kHeight);
        }
        if (all || order == SearchOrder::kAlternate)
            search_alternately({width.low, widths_.count()}, {height.low, heights_.count()});
        if (all || order == SearchOrder::kBoth) search_both();
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

    /// Both orders at once. Each side is first made smaller alone, as the orders begin; what that says of the errors
    /// then tells which sizes of both sides, from one order's to the other's, may be the smallest, and what is found
    /// there corrects the next guess.
    void search_both() {
        // floor(log2(width) + log2(height) + 2)
        const uint32_t most = best_.calls + static_cast<uint32_t>(std::bit_width(original_.area())) + 1;
        const double limit = settings_.metric.largest_error();
        SideSearch width(widths_, limit), height(heights_, limit);
        const bool two_sides = widths_.count() > 1 && heights_.count() > 1;
        const auto share = two_sides ? static_cast<uint32_t>(kSideShare * (most - best_.calls)) : most - best_.calls;
        search_side(width, best_.calls + share,
                    [&](uint32_t at) { return error_of(at, heights_.count(), First::kWidth, 1); });
        search_side(height, best_.calls + share,
                    [&](uint32_t at) { return error_of(widths_.count(), at, First::kHeight, 1); });
        SideNorm norm;
        while (best_.calls < most) {
            const auto [w, h] = smallest_guess(width, height, norm);
            if (w == 0) return;
            const double error = error_of(w, h, First::kWidth, 1);
            norm.learn(width.error(w), height.error(h), error);
        }
    }

    template <typename ErrorAt>
    void search_side(SideSearch& side, uint32_t last_call, const ErrorAt& error_at) const {
        while (best_.calls < last_call) {
            const auto at = side.next();
            if (!at) return;
            side.note(*at, error_at(*at));
        }
    }

    /// The numbers of the smallest chart whose sides' errors should make no more than is allowed, unless it is hardly
    /// smaller than what has been found, or smaller both ways than what was refused; {0, 0}: there is none.
    std::pair<uint32_t, uint32_t> smallest_guess(const SideSearch& width, const SideSearch& height,
                                                 const SideNorm& norm) const {
        const double limit = settings_.metric.largest_error();
        std::pair<uint32_t, uint32_t> found{0, 0};
        uint64_t least = best_.image.area() - best_.image.area() / kLeastGain;
        uint32_t h = heights_.count();
        for (uint32_t w = width.least(); w <= widths_.count(); ++w) {
            const double rest = norm.rest(limit, width.error(w));
            if (rest < 0) continue;
            while (h > height.least() && height.error(h - 1) <= rest) --h;
            const uint32_t own = least_not_refused(w, h);
            if (own > heights_.count()) continue;
            const uint64_t area = uint64_t{widths_.of(w)} * heights_.of(own);
            if (area >= least) continue;
            least = area;
            found = {w, own};
        }
        return found;
    }

    /// The least height number from `height` on that nothing refused speaks against, at a width.
    uint32_t least_not_refused(uint32_t width, uint32_t height) const {
        for (const auto& [size, error] : tried_) {
            if (size.first >= width && size.second >= height && error > settings_.metric.largest_error())
                height = size.second + 1;
        }
        return height;
    }

    bool accepts(uint32_t width, uint32_t height, First first) {
        const double most = settings_.metric.largest_error();
        return error_of(width, height, first, most) <= most;
    }

    /// Of the chart of that size; above `limit` any number above it. Charts that are accepted and smaller than any
    /// other are kept.
    double error_of(uint32_t width, uint32_t height, First first, double limit) {
        const auto [known, is_new] = tried_.try_emplace({width, height}, 0);
        if (!is_new) return known->second;
        Image small = shrink(widths_.of(width), heights_.of(height), first);
        make_stored(small);
        const double error = metric_.error(shown_rows(small, original_.width, original_.height, settings_), limit);
        ++best_.calls;
        known->second = error;
        if (error <= settings_.metric.largest_error() && small.area() < best_.image.area()) {
            best_.image = std::move(small);
            best_.error = error;
        }
        return error;
    }

    /// What the stored bytes will show.
    void make_stored(Image& small) const {
        if (!settings_.there || small.channels < 4) return quantise(small);
        ChartImage chart = chart_image(small);
        chart.repeat_u = settings_.edges.repeat_u;
        chart.repeat_v = settings_.edges.repeat_v;
        keep_share(chart, *settings_.there);
        small = linear_image(chart);
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
    std::map<std::pair<uint32_t, uint32_t>, double> tried_;  // errors by size numbers
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

ImageRows shown_rows(const Image& chart, uint32_t width, uint32_t height, const SearchSettings& settings) {
    ImageRows rows = enlarged_rows(chart, width, height, settings.edges);
    if (settings.there) {
        rows.read = [enlarge = std::move(rows.read)](uint32_t y, Image& strip) {
            enlarge(y, strip);
            test_alpha(strip);
        };
    }
    return rows;
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
