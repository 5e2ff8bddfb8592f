// Claim: charts fill their page: Table 14 of the atlas paper, with its packer and with ours, against stb_rect_pack.
#include <algorithm>
#include <cmath>

#include "tests/bench/bench_program.h"
#include "tests/bench/chart_sets.h"
#include "tests/bench/stb_packer.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::codec::atlas;

constexpr const char* kClaim =
    "Occupancy of atlas pages, percent, for the five sets of Table 14 (counts and page sizes as printed, see "
    "chart_sets.h for what the charts are),\n"
    "with block and mip alignment and borders for 0 and for 2 mips. `printed`: the paper's figures for its own "
    "charts.\n"
    "`covered`: texels in charts; `usable`: without what alignment and fill add beyond a chart's source image; borders "
    "count in both.\n"
    "`paper` modes: binary tree, plain / leaf fill as printed / stretch optimisation / stretch and corrected fill; "
    "`ours`: "
    "strongest packers\n"
    "with stretch (grown: and each chart into what is empty beside it, up to its source's size; tree: layouts that can "
    "be "
    "filled;\n"
    "within_source: and scaled within subtrees up to the source's size; filled: to the end).\n"
    "`tight`: a page that need not be a power of two, nothing stretched. seconds: median of one whole packing.\n"
    "Lines `peers`: the same padded charts at the page's width; density: area over that of the lowest page that takes "
    "all; stretched: covered\n"
    "percent after bisecting one common stretch; time_to_stb: one packing of the page over stb_rect_pack's (bottom "
    "left). FILEs: images or\n"
    "folders to take sizes from instead of ../shared/data.";
constexpr double kGoalUsable = 98;

double percent(double part) {
    return std::round(part * 1e4) / 100;
}

struct Mode {
    const char* name;
    PackEffort effort;
    bool stretch;
    FillMode fill;
    bool beyond_source;
    PageShape shape;
};

constexpr Mode kPaperModes[] = {
    {"plain", PackEffort::kBinaryTree, false, FillMode::kNone, false, PageShape::kPowerOfTwo},
    {"fill", PackEffort::kBinaryTree, false, FillMode::kSiblingLeaves, true, PageShape::kPowerOfTwo},
    {"optimised", PackEffort::kBinaryTree, true, FillMode::kNone, false, PageShape::kPowerOfTwo},
    {"both", PackEffort::kBinaryTree, true, FillMode::kSubtrees, true, PageShape::kPowerOfTwo}};
constexpr Mode kOurModes[] = {
    {"stretched", PackEffort::kStrongest, true, FillMode::kNone, false, PageShape::kPowerOfTwo},
    {"grown", PackEffort::kStrongest, true, FillMode::kInPlace, false, PageShape::kPowerOfTwo},
    {"stretched_tree", PackEffort::kStrongestTree, true, FillMode::kNone, false, PageShape::kPowerOfTwo},
    {"within_source", PackEffort::kStrongestTree, true, FillMode::kSubtrees, false, PageShape::kPowerOfTwo},
    {"filled", PackEffort::kStrongestTree, true, FillMode::kSubtrees, true, PageShape::kPowerOfTwo},
    {"tight", PackEffort::kStrongest, false, FillMode::kNone, false, PageShape::kTight}};

bool pages_are_valid(const AtlasPacking& packing) {
    for (uint32_t p = 0; p < packing.pages.size(); ++p) {
        std::vector<Rectangle> places;
        for (const PackedChart& chart : packing.charts) {
            if (chart.page == p) places.push_back(chart.padded);
        }
        if (!layout_is_valid(places, {packing.pages[p].width, packing.pages[p].height})) return false;
    }
    return true;
}

struct Set {
    PrintedPacking printed;
    AtlasPackingOptions options;
    std::vector<ChartRequest> charts;
};

Json mode_line(const Set& set, const Mode& mode, int repetitions, PageOccupancy& occupancy, BenchProgram& program) {
    AtlasPackingOptions options = set.options;
    options.effort = mode.effort;
    options.stretch = mode.stretch;
    options.fill = mode.fill;
    options.fill_beyond_source = mode.beyond_source;
    options.shape = mode.shape;
    const auto packing = pack_atlas(set.charts, options);
    if (!program.check(packing.ok(), packing.ok() ? "" : packing.error().text())) return {};
    program.check(pages_are_valid(*packing), "no chart overlaps another");
    std::vector<double> seconds;
    for (int i = 0; i < repetitions; ++i) seconds.push_back(seconds_of([&] { keep(pack_atlas(set.charts, options)); }));
    occupancy = total_occupancy(*packing);
    Json line{{"covered", percent(occupancy.covered())}, {"usable", percent(occupancy.usable())}};
    if (mode.beyond_source) {
        line["beyond_source"] =
            percent(static_cast<double>(occupancy.beyond_source) / static_cast<double>(occupancy.texels));
    }
    if (mode.stretch) line["stretch"] = rounded(packing->pages[0].stretch / double{kStretchSteps});
    if (packing->pages.size() != 1 || packing->pages[0].width != set.printed.side ||
        packing->pages[0].height != set.printed.side) {
        line["pages"] = Json::array();
        for (const AtlasPage& page : packing->pages) line["pages"].push_back({page.width, page.height});
    }
    line["seconds"] = rounded(spread_of(seconds).median);
    return line;
}

void measure_modes(size_t number, const Set& set, const std::string& source, int repetitions, BenchProgram& program) {
    const PrintedPacking& printed = set.printed;
    Json line{
        {"set", number},
        {"charts", printed.charts},
        {"from", source},
        {"page", {printed.side, printed.side}},
        {"mips", set.options.mips},
        {"unit", alignment_unit(set.options.mips, true, true)},
        {"border", border_of(set.options.border, set.options.mips, true, true).u},
        {"printed",
         {{"plain", printed.plain}, {"fill", printed.fill}, {"optimised", printed.optimised}, {"both", printed.both}}}};
    PageOccupancy paper[std::size(kPaperModes)], ours[std::size(kOurModes)];
    for (size_t i = 0; i < std::size(kPaperModes); ++i)
        line["paper"][kPaperModes[i].name] = mode_line(set, kPaperModes[i], repetitions, paper[i], program);
    for (size_t i = 0; i < std::size(kOurModes); ++i)
        line["ours"][kOurModes[i].name] = mode_line(set, kOurModes[i], repetitions, ours[i], program);
    program.print(line);
    program.check(paper[0].covered() < paper[1].covered() && paper[0].covered() < paper[2].covered() &&
                      paper[2].covered() < paper[3].covered(),
                  "Table 14: plain < fill, plain < optimised < both");
    program.check(paper[3].empty == 0 && ours[4].empty == 0, "100.00 % after fill");
    program.check(100 * ours[1].usable() >= kGoalUsable, "98 % usable before fill");
}

struct Peer {
    const char* name;
    std::function<std::vector<Rectangle>(std::span<const RectangleSize>, RectangleSize)> pack;
};

/// Best of all tastes.
Peer our_peer(const char* name, PackEffort effort) {
    return {name, [effort](std::span<const RectangleSize> sizes, RectangleSize bin) {
                uint32_t hint = 0;
                auto packing = pack_with_effort(sizes, bin, effort, hint);
                return packing ? packing->places : std::vector<Rectangle>(sizes.size());
            }};
}

Peer one_packer(const char* name, PackMethod method) {
    return {name, [method](std::span<const RectangleSize> sizes, RectangleSize bin) {
                return pack_rectangles(sizes, bin, method).places;
            }};
}

Peer stb_peer(const char* name, StbHeuristic heuristic) {
    return {name, [heuristic](std::span<const RectangleSize> sizes, RectangleSize bin) {
                return pack_with_stb(sizes, bin, heuristic);
            }};
}

bool fits(const Peer& peer, std::span<const RectangleSize> sizes, RectangleSize bin) {
    if (total_area(sizes) > bin.area()) return false;
    const auto places = peer.pack(sizes, bin);
    return std::all_of(places.begin(), places.end(), [](const Rectangle& place) { return place.area() > 0; });
}

/// Area over that of the lowest bin of this width that takes all.
double density(const Peer& peer, std::span<const RectangleSize> sizes, uint32_t width) {
    const uint64_t area = total_area(sizes);
    auto fails = static_cast<uint32_t>((area - 1) / width), most = fails * 2;
    while (most - fails > 1) {
        const uint32_t middle = (fails + most) / 2;
        (fits(peer, sizes, {width, middle}) ? most : fails) = middle;
    }
    return static_cast<double>(area) / (static_cast<double>(width) * most);
}

/// Algorithm 6 as printed: one common stretch, bisected; the part of the bin covered.
double stretched_part(const Peer& peer, std::span<const StretchRange> ranges, RectangleSize bin) {
    uint32_t last = 0, fails = kStretchSteps + 1;
    double part = 0;
    std::vector<RectangleSize> sizes(ranges.size());
    while (fails - last > 1) {
        const uint32_t middle = (last + fails) / 2;
        for (size_t i = 0; i < ranges.size(); ++i) sizes[i] = stretched(ranges[i], middle);
        const bool fit = fits(peer, sizes, bin);
        if (fit) part = static_cast<double>(total_area(sizes)) / static_cast<double>(bin.area());
        (fit ? last : fails) = middle;
    }
    return part;
}

/// Charts in cells, with borders, from wanted to source.
std::vector<StretchRange> cell_ranges(const Set& set, uint32_t unit) {
    std::vector<StretchRange> ranges;
    const uint32_t limit = set.options.max_chart_side / unit;
    for (const ChartRequest& chart : set.charts) {
        const auto border = border_of(set.options.border, set.options.mips, chart.repeat_u, chart.repeat_v);
        const auto least = [&](uint32_t side, uint32_t b) { return (side + 2 * b + unit - 1) / unit; };
        const auto most = [&](uint32_t side, uint32_t b) { return std::min((side + 2 * b) / unit, limit); };
        const RectangleSize low = {least(chart.wanted.width, border.u), least(chart.wanted.height, border.v)};
        ranges.push_back({low,
                          {std::max(low.width, most(chart.source.width, border.u)),
                           std::max(low.height, most(chart.source.height, border.v))}});
    }
    return ranges;
}

void measure_peers(size_t number, const Set& set, int repetitions, BenchProgram& program) {
    const uint32_t unit = alignment_unit(set.options.mips, true, true);
    const RectangleSize bin = {set.printed.side / unit, set.printed.side / unit};
    const auto ranges = cell_ranges(set, unit);
    std::vector<RectangleSize> sizes;
    for (const StretchRange& range : ranges) sizes.push_back(range.least);
    const std::vector<Peer> peers = {stb_peer("stb_bottom_left", StbHeuristic::kBottomLeft),
                                     stb_peer("stb_best_fit", StbHeuristic::kBestFit),
                                     one_packer("binary_tree", PackMethod::kBinaryTree),
                                     one_packer("guillotine", PackMethod::kGuillotine),
                                     one_packer("skyline", PackMethod::kSkyline),
                                     our_peer("strongest_tree", PackEffort::kStrongestTree),
                                     our_peer("strongest", PackEffort::kStrongest)};
    std::vector<std::function<void()>> work;
    for (const Peer& peer : peers) work.push_back([&] { keep(peer.pack(sizes, bin)); });
    const auto seconds = time_in_turn(work, repetitions);
    Json line{{"set", number}, {"charts", sizes.size()}, {"mips", set.options.mips}, {"unit", unit}};
    double best_stb = 0, ours = 0;
    for (size_t i = 0; i < peers.size(); ++i) {
        const double packed = density(peers[i], sizes, bin.width);
        if (i < 2) best_stb = std::max(best_stb, packed);
        ours = packed;
        line["peers"][peers[i].name] = {{"density", percent(packed)},
                                        {"stretched", percent(stretched_part(peers[i], ranges, bin))},
                                        {"time_to_stb", to_json(ratio_of(seconds[i], seconds[0]))}};
    }
    program.print(line);
    program.check(ours > best_stb, "our packers are denser than stb_rect_pack");
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_packing", kClaim, "images or folders of images", false});
    BenchOptions options;
    options.repetitions = 3;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const auto images = image_sizes(options.files.empty() ? texture_folders() : options.files);
    const std::string source = images.empty() ? "generated" : std::to_string(images.size()) + " textures";
    for (const uint32_t mips : {0u, 2u}) {
        for (size_t i = 0; i < kTable14.size(); ++i) {
            Set set{kTable14[i], {}, {}};
            set.options.mips = mips;
            set.charts = table_14_set(set.printed, images, set.options);
            measure_modes(i + 1, set, source, options.repetitions, program);
            measure_peers(i + 1, set, options.repetitions, program);
        }
    }
    return program.exit_code();
}
