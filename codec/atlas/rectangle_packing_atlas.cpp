#include "codec/atlas/rectangle_packing_atlas.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <numeric>
#include <string>

#include "codec/atlas/rectangle_packing_tight.h"

namespace citystream::codec::atlas {

namespace {

std::string size_text(RectangleSize size) {
    return std::to_string(size.width) + " x " + std::to_string(size.height);
}

/// A chart in cells of the alignment unit.
struct CellChart {
    StretchRange range;  ///< from wanted to source
    RectangleSize most;  ///< the largest that any chart may be
    ChartBorder border;
};

Status check_options(const AtlasPackingOptions& options, uint32_t unit) {
    if (options.max_page_side > kMaxBinSide || options.max_page_side < unit)
        return Error{"atlas pages of side " + std::to_string(options.max_page_side) + " cannot be packed"};
    if (options.max_chart_side < unit || options.max_chart_side > options.max_page_side)
        return Error{"charts of side " + std::to_string(options.max_chart_side) + " cannot be packed"};
    return Done{};
}

Result<CellChart> cell_chart(const ChartRequest& request, const AtlasPackingOptions& options, uint32_t unit) {
    if (request.wanted.area() == 0) return Error{"chart of " + size_text(request.wanted) + " texels"};
    if (!request.wanted.fits_in(request.source))
        return Error{"chart wants " + size_text(request.wanted) + " texels of " + size_text(request.source)};
    const ChartBorder border = border_of(options.border, options.mips, request.repeat_u, request.repeat_v);
    const uint32_t limit = options.max_chart_side / unit;
    const auto at_least = [unit](uint64_t side, uint32_t b) { return (side + 2 * uint64_t{b} + unit - 1) / unit; };
    const auto at_most = [&](uint64_t side, uint32_t b, uint64_t least) {
        return static_cast<uint32_t>(std::clamp<uint64_t>((side + 2 * uint64_t{b}) / unit, least, limit));
    };
    const uint64_t across = at_least(request.wanted.width, border.u), up = at_least(request.wanted.height, border.v);
    if (across > limit || up > limit) {
        return Error{"chart of " + size_text(request.wanted) + " texels is larger than " +
                     std::to_string(options.max_chart_side) + " with its border"};
    }
    const RectangleSize least = {static_cast<uint32_t>(across), static_cast<uint32_t>(up)};
    const RectangleSize most = {at_most(request.source.width, border.u, across),
                                at_most(request.source.height, border.v, up)};
    return CellChart{{least, most}, {limit, limit}, border};
}

/// Half the area: what next_bin() doubles.
RectangleSize half_bin(RectangleSize bin) {
    return bin.width > bin.height ? RectangleSize{bin.width / 2, bin.height} : RectangleSize{bin.width, bin.height / 2};
}

/// Packs pages until no chart is left.
class Pages {
  public:
    Pages(std::span<const ChartRequest> requests, std::vector<CellChart> charts, const AtlasPackingOptions& options,
          uint32_t unit)
        : requests_(requests), charts_(std::move(charts)), options_(options), unit_(unit) {
        const uint32_t side = options.max_page_side / unit;
        largest_ = options.shape == PageShape::kPowerOfTwo ? RectangleSize{std::bit_floor(side), std::bit_floor(side)}
                                                           : RectangleSize{side, side};
        const bool needs_tree = options.fill == FillMode::kSiblingLeaves || options.fill == FillMode::kSubtrees;
        if (needs_tree && options.effort == PackEffort::kStrongest) options_.effort = PackEffort::kStrongestTree;
        result_.unit = unit;
        result_.charts.resize(charts_.size());
    }

    AtlasPacking run() {
        std::vector<uint32_t> rest(charts_.size());
        std::iota(rest.begin(), rest.end(), 0u);
        while (!rest.empty()) rest = pack_page(rest);
        return std::move(result_);
    }

  private:
    struct Layout {
        RectangleSize bin;
        Packing packing;
        uint32_t stretch = 0;
    };

    std::vector<RectangleSize> least_sizes(std::span<const uint32_t> charts) const {
        std::vector<RectangleSize> sizes(charts.size());
        std::transform(charts.begin(), charts.end(), sizes.begin(),
                       [&](uint32_t chart) { return charts_[chart].range.least; });
        return sizes;
    }

    /// The smallest page that takes all, or the largest page with as many as fit.
    Layout lay_out(std::span<const RectangleSize> sizes) const {
        uint32_t hint = 0;
        if (options_.shape == PageShape::kTight) {
            if (auto tight = pack_tight(sizes, largest_, options_.effort))
                return {tight->bin, std::move(tight->packing)};
        } else {
            for (RectangleSize bin = smallest_bin(sizes); bin.fits_in(largest_); bin = next_bin(bin)) {
                if (auto packing = pack_with_effort(sizes, bin, options_.effort, hint))
                    return {bin, std::move(*packing)};
            }
        }
        return {largest_, pack_as_many_as_fit(sizes, largest_, options_.effort)};
    }

    /// A page with its places filled, and the charts that are not on it.
    struct FilledPage {
        Layout layout;
        std::vector<uint32_t> here, left;
        std::vector<Rectangle> places;
        uint64_t empty = 0;  ///< cells
        /// Whether a larger part of it is covered.
        bool is_fuller_than(const FilledPage& other) const {
            return empty * other.layout.bin.area() < other.empty * layout.bin.area();
        }
    };

    /// Charts that are on no page yet -> those still left. A page that its charts do not fill, because none may grow
    /// further, is halved, and what it then does not hold comes on others.
    std::vector<uint32_t> pack_page(std::span<const uint32_t> rest) {
        const auto sizes = least_sizes(rest);
        FilledPage page = fill_page(rest, lay_out(sizes));
        assert(!page.here.empty());
        const bool halves = options_.shape == PageShape::kPowerOfTwo && options_.fill == FillMode::kSubtrees &&
                            options_.fill_beyond_source;
        for (RectangleSize bin = page.layout.bin; halves && page.empty > 0 && bin.area() > 1;) {
            bin = half_bin(bin);
            FilledPage smaller = fill_page(rest, {bin, pack_as_many_as_fit(sizes, bin, options_.effort)});
            if (smaller.here.empty()) break;
            if (smaller.is_fuller_than(page)) page = std::move(smaller);
        }
        finish_page(page);
        return std::move(page.left);
    }

    FilledPage fill_page(std::span<const uint32_t> rest, Layout layout) const {
        FilledPage page;
        std::vector<Rectangle> places;
        std::vector<uint32_t> number(rest.size(), SlicingNode::kEmpty);
        for (size_t i = 0; i < rest.size(); ++i) {
            const bool placed = layout.packing.places[i].area() > 0;
            (placed ? page.here : page.left).push_back(rest[i]);
            if (!placed) continue;
            number[i] = static_cast<uint32_t>(places.size());
            places.push_back(layout.packing.places[i]);
        }
        for (SlicingNode& node : layout.packing.tree.nodes) {
            if (node.rectangle != SlicingNode::kEmpty) node.rectangle = number[node.rectangle];
        }
        layout.packing.places = std::move(places);
        if (options_.stretch) stretch(page.here, layout);
        std::vector<GrowthLimit> limits;
        for (size_t i = 0; i < page.here.size(); ++i) {
            const CellChart& chart = charts_[page.here[i]];
            limits.push_back({layout.packing.places[i].size(), chart.range.most,
                              options_.fill_beyond_source ? chart.most : chart.range.most});
        }
        page.places = fill_leaves(layout.packing, layout.bin, limits, options_.fill);
        page.empty = layout.bin.area();
        for (const Rectangle& place : page.places) page.empty -= place.area();
        page.layout = std::move(layout);
        return page;
    }

    void finish_page(const FilledPage& filled) {
        const RectangleSize bin = filled.layout.bin;
        AtlasPage page{bin.width * unit_, bin.height * unit_, filled.layout.stretch, {}};
        page.occupancy.texels = uint64_t{page.width} * page.height;
        page.occupancy.empty = page.occupancy.texels;
        for (size_t i = 0; i < filled.here.size(); ++i) place(filled.here[i], filled.places[i], page.occupancy);
        result_.pages.push_back(page);
    }

    /// A layout of as many as fit need not be found again for these charts alone; then it stays as it is.
    void stretch(std::span<const uint32_t> here, Layout& layout) const {
        std::vector<StretchRange> ranges;
        for (const uint32_t chart : here) ranges.push_back(charts_[chart].range);
        auto stretched = optimise_stretch(ranges, layout.bin, options_.effort);
        if (!stretched) return;
        layout.packing = std::move(stretched->packing);
        layout.stretch = stretched->stretch;
    }

    void place(uint32_t index, const Rectangle& cells, PageOccupancy& occupancy) {
        const ChartBorder border = charts_[index].border;
        PackedChart& chart = result_.charts[index];
        chart.page = static_cast<uint32_t>(result_.pages.size());
        chart.border = border;
        chart.padded = {cells.x * unit_, cells.y * unit_, cells.width * unit_, cells.height * unit_};
        chart.interior = {chart.padded.x + border.u, chart.padded.y + border.v, chart.padded.width - 2 * border.u,
                          chart.padded.height - 2 * border.v};
        const ChartRequest& request = requests_[index];
        const uint64_t shown = uint64_t{std::min(chart.interior.width, request.source.width)} *
                               std::min(chart.interior.height, request.source.height);
        occupancy.wanted += request.wanted.area();
        occupancy.grown += shown - request.wanted.area();
        occupancy.beyond_source += chart.interior.area() - shown;
        occupancy.border += chart.padded.area() - chart.interior.area();
        occupancy.empty -= chart.padded.area();
    }

    std::span<const ChartRequest> requests_;
    std::vector<CellChart> charts_;
    AtlasPackingOptions options_;
    uint32_t unit_;
    RectangleSize largest_;  ///< page, in cells
    AtlasPacking result_;
};

}  // namespace

double PageOccupancy::covered() const {
    return texels == 0 ? 0 : static_cast<double>(texels - empty) / static_cast<double>(texels);
}

double PageOccupancy::usable() const {
    return texels == 0 ? 0 : static_cast<double>(wanted + grown + border) / static_cast<double>(texels);
}

PageOccupancy total_occupancy(const AtlasPacking& packing) {
    PageOccupancy sum;
    for (const AtlasPage& page : packing.pages) {
        sum.texels += page.occupancy.texels;
        sum.wanted += page.occupancy.wanted;
        sum.grown += page.occupancy.grown;
        sum.beyond_source += page.occupancy.beyond_source;
        sum.border += page.occupancy.border;
        sum.empty += page.occupancy.empty;
    }
    return sum;
}

Result<AtlasPacking> pack_atlas(std::span<const ChartRequest> requests, const AtlasPackingOptions& options) {
    if (options.mips > kMostMips) return Error{"atlas pages with " + std::to_string(options.mips) + " mips"};
    if (requests.size() > kMostRectangles) return Error{std::to_string(requests.size()) + " charts are too many"};
    const uint32_t unit = alignment_unit(options.mips, options.blocks, options.packed_coordinates);
    if (Status checked = check_options(options, unit); !checked) return checked.error();
    std::vector<CellChart> charts;
    for (const ChartRequest& request : requests) {
        auto chart = cell_chart(request, options, unit);
        if (!chart) return chart.error();
        charts.push_back(*chart);
    }
    return Pages(requests, std::move(charts), options, unit).run();
}

}  // namespace citystream::codec::atlas
