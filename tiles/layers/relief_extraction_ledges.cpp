#include "tiles/layers/relief_extraction_ledges.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <map>

namespace citystream::tiles::layers::relief {
namespace {

using codec::facade::displacement_of;
using codec::facade::kOpenDisplacement;
using codec::facade::make_label;
using codec::facade::RunGrid;

constexpr double kAxial = 0.9995;
constexpr uint32_t kMostLedges = 4;
constexpr int32_t kLeastDepth =
    80;  // millimetres: a ledge is seen from the front too, as a line that shallow sides lack
constexpr double kShownWeight = 1e6;  // what the mesh still shows gives way to what the relief alone does

/// A side of the relief: the line x (or y) in texels between a higher and a lower cell, along one run of the other
/// axis, and whether it looks towards greater coordinates.
struct Line {
    bool across_u = false, rising = false;
    uint32_t run = 0, at = 0;
    auto operator<=>(const Line&) const = default;
};

/// A side of the model on it: texels along it, millimetres of depth.
struct Side {
    uint32_t begin = 0, end = 0;
    int32_t low = 0, high = 0;
    uint32_t slot = 0;
    double weight = 0;  ///< of two sides in one place the heavier one shows
};

/// What is painted over the grid.
struct Ledge {
    uint32_t x0 = 0, x1 = 0, y0 = 0, y1 = 0, label = 0;
};

uint32_t cell_at(const std::vector<uint32_t>& breaks, uint32_t texel) {
    return static_cast<uint32_t>(std::upper_bound(breaks.begin(), breaks.end() - 1, texel) - breaks.begin()) - 1;
}

class LedgeMaker {
  public:
    LedgeMaker(const RunGrid& grid, double tolerance)
        : grid_(grid), least_(static_cast<int32_t>(std::lround(tolerance * 1000))) {}

    /// A side about `at`, at most `reach` texels away: on the nearest side of the relief, run by run.
    void note(bool across_u, bool rising, uint32_t at, uint32_t reach, const Side& side) {
        const std::vector<uint32_t>& runs = across_u ? grid_.y_breaks : grid_.x_breaks;
        for (uint32_t run = cell_at(runs, side.begin); run + 1 < runs.size() && runs[run] < side.end; ++run) {
            Line line{across_u, rising, run, at};
            if (!find_step(line, reach)) continue;
            Side piece = side;
            piece.begin = std::max(piece.begin, runs[run]);
            piece.end = std::min(piece.end, runs[run + 1]);
            lines_[line].push_back(piece);
        }
    }

    RunGrid paint() {
        for (auto& [line, sides] : lines_) follow(line, sides);
        if (ledges_.empty()) return grid_;
        std::vector<uint32_t> xs = grid_.x_breaks, ys = grid_.y_breaks;
        for (const Ledge& ledge : ledges_) {
            xs.insert(xs.end(), {ledge.x0, ledge.x1});
            ys.insert(ys.end(), {ledge.y0, ledge.y1});
        }
        RunGrid finer = cut(xs, ys);
        for (const Ledge& ledge : ledges_) {
            for (uint32_t row = cell_at(finer.y_breaks, ledge.y0); finer.y_breaks[row] < ledge.y1; ++row) {
                for (uint32_t column = cell_at(finer.x_breaks, ledge.x0); finer.x_breaks[column] < ledge.x1; ++column)
                    finer.labels[size_t{row} * finer.columns() + column] = ledge.label;
            }
        }
        return finer;
    }

  private:
    /// Of the line's run, next to it on the solid's side and `steps` further in; on the other side for -1.
    uint32_t label_at(const Line& line, int steps) const {
        const auto across = static_cast<uint32_t>(static_cast<int>(line.at) + (line.rising ? -1 - steps : steps));
        const uint32_t cell = cell_at(line.across_u ? grid_.x_breaks : grid_.y_breaks, across);
        return line.across_u ? grid_.label(cell, line.run) : grid_.label(line.run, cell);
    }

    uint32_t size_across(const Line& line) const { return line.across_u ? grid_.width() : grid_.height(); }

    bool is_step(const Line& line) const {
        if (line.at == 0 || line.at >= size_across(line)) return false;
        const int32_t solid = displacement_of(label_at(line, 0)), beyond = displacement_of(label_at(line, -1));
        return solid != kOpenDisplacement && solid - beyond > least_;
    }

    bool find_step(Line& line, uint32_t reach) const {
        const uint32_t middle = line.at;
        for (uint32_t aside = 0; aside <= reach; ++aside) {
            for (const bool up : {false, true}) {
                if (up ? aside == 0 : aside > middle) continue;
                line.at = up ? middle + aside : middle - aside;
                if (is_step(line)) return true;
            }
        }
        return false;
    }

    /// Cuts the line where sides begin and end: in between nothing changes.
    void follow(const Line& line, const std::vector<Side>& sides) {
        std::vector<uint32_t> cuts;
        for (const Side& side : sides) cuts.insert(cuts.end(), {side.begin, side.end});
        std::sort(cuts.begin(), cuts.end());
        cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
        for (size_t i = 0; i + 1 < cuts.size(); ++i) {
            std::vector<Side> here;
            for (const Side& side : sides) {
                if (side.begin <= cuts[i] && side.end >= cuts[i + 1]) here.push_back(side);
            }
            if (!here.empty()) step(line, cuts[i], cuts[i + 1], here);
        }
    }

    /// The sides of one step, from below.
    void step(const Line& line, uint32_t begin, uint32_t end, std::vector<Side>& sides) {
        const uint32_t solid = label_at(line, 0);
        const int32_t top = displacement_of(solid), bottom = displacement_of(label_at(line, -1));  // open: below all
        std::vector<int32_t> cuts;
        for (Side& side : sides) {
            side.low = std::max(side.low, bottom);
            side.high = side.high + least_ >= top ? top : side.high;
            if (side.low < side.high) cuts.insert(cuts.end(), {side.low, side.high});
        }
        std::sort(cuts.begin(), cuts.end());
        std::vector<Side> parts;
        for (size_t i = 0; i + 1 < cuts.size(); ++i) {
            if (cuts[i + 1] - cuts[i] < kLeastDepth) continue;
            const Side* shown = nullptr;
            for (const Side& side : sides) {
                const bool covers = side.low <= cuts[i] && side.high >= cuts[i + 1];
                if (covers && (shown == nullptr || side.weight > shown->weight)) shown = &side;
            }
            if (shown == nullptr) continue;
            if (parts.empty() || parts.back().slot != shown->slot) parts.push_back(*shown);
            parts.back().high = cuts[i + 1];
        }
        if (parts.empty()) return;
        if (parts.back().slot == codec::facade::material_of(solid)) parts.pop_back();
        if (parts.size() > kMostLedges) parts.erase(parts.begin(), parts.end() - kMostLedges);
        for (uint32_t i = 0; i < parts.size(); ++i) add(line, begin, end, i, solid, parts[i]);
    }

    void add(const Line& line, uint32_t begin, uint32_t end, uint32_t place, uint32_t solid, const Side& side) {
        if (line.rising ? line.at < place + 1 : line.at + place >= size_across(line)) return;
        const uint32_t at = line.rising ? line.at - 1 - place : line.at + place;
        if (label_at(line, static_cast<int>(place)) != solid) return;  // a front narrower than its ledges
        const uint32_t label = make_label(side.high, side.slot);
        ledges_.push_back(line.across_u ? Ledge{at, at + 1, begin, end, label} : Ledge{begin, end, at, at + 1, label});
    }

    RunGrid cut(std::vector<uint32_t>& xs, std::vector<uint32_t>& ys) const {
        for (std::vector<uint32_t>* breaks : {&xs, &ys}) {
            std::sort(breaks->begin(), breaks->end());
            breaks->erase(std::unique(breaks->begin(), breaks->end()), breaks->end());
        }
        RunGrid finer{xs, ys, {}};
        finer.labels.reserve(size_t{finer.columns()} * finer.rows());
        std::vector<uint32_t> from;
        for (size_t i = 0; i + 1 < xs.size(); ++i) from.push_back(cell_at(grid_.x_breaks, xs[i]));
        for (size_t i = 0; i + 1 < ys.size(); ++i) {
            const uint32_t row = cell_at(grid_.y_breaks, ys[i]);
            for (const uint32_t column : from) finer.labels.push_back(grid_.label(column, row));
        }
        return finer;
    }

    const RunGrid& grid_;
    int32_t least_;
    std::map<Line, std::vector<Side>> lines_;
    std::vector<Ledge> ledges_;
};

/// Texels of the map that a coordinate of the wall is at.
uint32_t texel_of(double at, const Axis& axis, double begin, uint32_t size) {
    const long texel = std::lround(at / axis.texel()) - std::lround(begin / axis.texel());
    return static_cast<uint32_t>(std::clamp(texel, 0L, static_cast<long>(size)));
}

}  // namespace

RunGrid add_ledges(const RunGrid& grid, const CellGrid& cells, double left, double bottom, const FacadeParts& facade,
                   const Decision& decision, const SlotTable& slots, double tolerance) {
    LedgeMaker maker(grid, tolerance);
    for (size_t i = 0; i < facade.parts.size(); ++i) {
        const Part& part = facade.parts[i];
        if (decision.beside[i] == 0) continue;
        const bool across_u = std::abs(part.normal.u) > kAxial;
        if (!across_u && std::abs(part.normal.v) <= kAxial) continue;
        const bool rising = (across_u ? part.normal.u : part.normal.v) > 0;
        const auto u = [&](double at) { return texel_of(at, cells.u, left, grid.width()); };
        const auto v = [&](double at) { return texel_of(at, cells.v, bottom, grid.height()); };
        const uint32_t low = across_u ? u(part.low.u) : v(part.low.v),
                       high = across_u ? u(part.high.u) : v(part.high.v);
        const auto millimetres = [](double w) { return static_cast<int32_t>(std::lround(w * 1000)); };
        Side side;
        side.begin = across_u ? v(part.low.v) : u(part.low.u);
        side.end = across_u ? v(part.high.v) : u(part.high.u);
        side.low = millimetres(part.low.w);
        side.high = millimetres(part.high.w);
        side.slot = slots.slot_of.at(part.look);
        side.weight = decision.shown[i] != 0 ? kShownWeight + part.area : part.area;
        if (side.begin < side.end) maker.note(across_u, rising, (low + high) / 2, (high - low + 1) / 2 + 2, side);
    }
    return maker.paint();
}

}  // namespace citystream::tiles::layers::relief
