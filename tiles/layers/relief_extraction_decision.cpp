#include "tiles/layers/relief_extraction_decision.h"

#include <algorithm>
#include <cmath>

namespace citystream::tiles::layers::relief {
namespace {

constexpr double kOpenStepMetres = 0.3;                   // of a step down to nothing: what is looked at
constexpr double kAlongMetres = 0.2, kDownMetres = 0.08;  // between samples of a side
constexpr int kMostSamples = 12;
constexpr double kMostUntrue = 0.25;    // share of a patch's sides
constexpr double kLeastUntrue = 0.002;  // square metres
constexpr double kSampleMetres = 0.1;
constexpr int kMostRounds = 24;
constexpr double kSamePlaneMetres = 0.003;
constexpr double kEdgeOn = 0.05;
constexpr double kEdgeMetres = 0.04;  // from the rectangle's edge: walls beside it are not quite perpendicular

int sample_count(double size, double spacing) {
    return std::clamp(static_cast<int>(std::ceil(size / spacing)), 1, kMostSamples);
}

}  // namespace

/// A side of the relief: along u at a fixed v, or along v at a fixed u, from `low` up to `high`.
struct Decider::Step {
    bool along_u = false;
    double at = 0, begin = 0, end = 0;
    double low = 0, high = 0;
    double veil = kOpen;     ///< depth of what stays mesh before the lower cell, below `high`
    double outwards = 1;     ///< the side's normal points up the fixed axis (+1) or down (-1)
    uint32_t patch = kNone;  ///< of the higher cell
    bool same_sort(const Step& o) const {
        return patch == o.patch && low == o.low && high == o.high && outwards == o.outwards &&
               std::abs(veil - o.veil) < 0.01;
    }
};

Decider::Decider(const CellGrid& grid, const LayerStack& stack, const Surroundings& surroundings, FacadeParts& facade,
                 double tolerance)
    : grid_(grid),
      stack_(stack),
      surroundings_(surroundings),
      facade_(facade),
      tolerance_(tolerance),
      lateral_(1.5 * std::max(grid.u.texel(), grid.v.texel()) + 0.001) {}

double Decider::depth_of(size_t cell) const {
    return top_[cell] == kNone ? kOpen : facade_.patches[facade_.parts[top_[cell]].patch].level_mm * 0.001;
}

bool Decider::is_beyond(double u, double v) const {
    return u < 0 || v < 0 || u > grid_.u.length || v > grid_.v.length;
}

uint32_t Decider::top_at(double u, double v) const {
    if (is_beyond(u, v)) return kNone;
    return top_[size_t{grid_.v.cell_of(v)} * grid_.u.cells() + grid_.u.cell_of(u)];
}

double Decider::depth_at(double u, double v) const {
    const uint32_t top = top_at(u, v);
    return top == kNone ? kOpen : facade_.patches[facade_.parts[top].patch].level_mm * 0.001;
}

void Decider::find_tops() {
    top_.assign(grid_.cells(), kNone);
    for (size_t cell = 0; cell < top_.size(); ++cell) {
        for (const Layer& layer : stack_.at(cell)) {
            const Part& part = facade_.parts[layer.part];
            if (part.kind != PartKind::kFlat || facade_.patches[part.patch].kept) continue;
            top_[cell] = layer.part;
            break;
        }
    }
}

Decider::Step Decider::step_between(size_t first, size_t second) const {
    Step step;
    const double a = depth_of(first), b = depth_of(second);
    const size_t higher = a > b ? first : second, lower = a > b ? second : first;
    step.high = std::max(a, b);
    step.low = std::min(a, b);
    step.outwards = a > b ? 1 : -1;
    step.patch = facade_.parts[top_[higher]].patch;
    for (const Layer& layer : stack_.at(lower)) {
        if (layer.w <= step.low + tolerance_) break;
        if (layer.w > step.high + tolerance_) continue;
        const Part& part = facade_.parts[layer.part];
        if (part.kind == PartKind::kFlat && !facade_.patches[part.patch].kept) continue;
        step.veil = layer.w;
        break;
    }
    return step;
}

template <typename Use>
void Decider::for_each_step(const Use& use) const {
    const uint32_t columns = grid_.u.cells(), rows = grid_.v.cells();
    const auto line = [&](bool along_u, uint32_t fixed, uint32_t count, size_t first, size_t second, size_t stride) {
        const Axis &across = along_u ? grid_.v : grid_.u, &along = along_u ? grid_.u : grid_.v;
        Step current;
        bool open = false;
        for (uint32_t i = 0; i < count; ++i, first += stride, second += stride) {
            const bool is_step =
                top_[first] != top_[second] && std::abs(depth_of(first) - depth_of(second)) > 1.5 * tolerance_;
            if (open && !is_step) use(current);
            if (!is_step) {
                open = false;
                continue;
            }
            Step step = step_between(first, second);
            step.along_u = along_u;
            step.at = across.at[fixed];
            step.begin = along.at[i];
            step.end = along.at[i + 1];
            if (open && step.same_sort(current)) {
                current.end = step.end;
            } else {
                if (open) use(current);
                current = step;
            }
            open = true;
        }
        if (open) use(current);
    };
    for (uint32_t column = 1; column < columns; ++column) line(false, column, rows, column - 1, column, columns);
    for (uint32_t row = 1; row < rows; ++row)
        line(true, row, columns, size_t{row - 1} * columns, size_t{row} * columns, 1);
}

/// Of a side between `deepest` and its top the area without a triangle of the model; where the lower cell is open, what
/// nobody can see is true (with `seen_only`, for all sides).
double Decider::untrue_area(const Step& step, double deepest, bool seen_only) const {
    const double low = std::max({step.low, step.veil, deepest});
    const double depth = step.high - low, along = step.end - step.begin;
    if (depth <= 1.5 * tolerance_) return 0;
    const bool is_open = step.low == kOpen || seen_only;
    const int n = sample_count(along, kAlongMetres), m = sample_count(depth, kDownMetres);
    const Point out = step.along_u ? Point{0, step.outwards, 0} : Point{step.outwards, 0, 0};
    int missing = 0;
    for (int i = 0; i < n; ++i) {
        const double s = step.begin + along * (i + 0.5) / n;
        for (int k = 0; k < m; ++k) {
            const double w = low + depth * (k + 0.5) / m;
            const Point p = step.along_u ? Point{s, step.at, w} : Point{step.at, s, w};
            if (surroundings_.covers(p)) continue;
            if (is_open && surroundings_.encloses(p + out * 0.01, !step.along_u, step.outwards)) continue;
            ++missing;
        }
    }
    return depth * along * missing / (n * m);
}

/// Marks patches whose sides are not the model's. True when there were any.
bool Decider::keep_floating_patches() {
    std::vector<Blame> blame(facade_.patches.size());
    for_each_step([&](const Step& step) {
        const double deepest = step.low == kOpen ? step.high - kOpenStepMetres : step.low;
        const double low = std::max({step.low, step.veil, deepest});
        blame[step.patch].drawn += std::max(0.0, step.high - low) * (step.end - step.begin);
        blame[step.patch].untrue += untrue_area(step, deepest, false);
    });
    bool any = false;
    for (size_t i = 0; i < blame.size(); ++i) {
        if (blame[i].untrue <= kLeastUntrue || blame[i].untrue <= kMostUntrue * blame[i].drawn) continue;
        facade_.patches[i].kept = any = true;
    }
    return any;
}

/// The same for the rectangle's edges but the lower one, and for sides down to open cells below what was looked at.
double Decider::untrue_rim(double deepest) const {
    double area = 0;
    const auto edge = [&](bool along_u, double at, double outwards, size_t first, size_t stride, const Axis& along) {
        for (uint32_t i = 0; i < along.cells(); ++i) {
            const double high = depth_of(first + i * stride);
            if (high == kOpen || high <= deepest) continue;
            Step step{along_u, at, along.at[i], along.at[i + 1], kOpen, high, kOpen, outwards, kNone};
            area += untrue_area(step, deepest, true);
        }
    };
    const size_t columns = grid_.u.cells(), rows = grid_.v.cells();
    edge(false, 0, -1, 0, columns, grid_.v);
    edge(false, grid_.u.length, 1, columns - 1, columns, grid_.v);
    edge(true, grid_.v.length, 1, (rows - 1) * columns, 1, grid_.u);
    for_each_step([&](const Step& step) {
        if (step.low == kOpen) area += untrue_area(step, deepest, true);
    });
    return area;
}

std::vector<Point> sample_points(const Part& part, double spacing) {
    const auto& [a, b, c] = part.corner;
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    const int n = sample_count(longest, spacing) + 1;
    std::vector<Point> points;
    for (int i = 0; i < n; ++i) {
        for (int k = 0; i + k < n; ++k) {
            const double s = (i + 1.0 / 3) / n, t = (k + 1.0 / 3) / n;
            points.push_back(a + (b - a) * s + (c - a) * t);
        }
    }
    return points;
}

/// Whether the relief is nowhere lower than the level over a flat part (one too narrow for the cells may not be in it).
bool Decider::is_below(const Part& part, double level) const {
    const std::vector<Point> points = sample_points(part, kSampleMetres);
    return std::all_of(points.begin(), points.end(),
                       [&](const Point& p) { return depth_at(p.u, p.v) >= level - tolerance_; });
}

/// A side is shown or hidden where the relief beside it is as high as the side's points.
void Decider::judge_sides(Decision& decision) const {
    for (size_t i = 0; i < facade_.parts.size(); ++i) {
        const Part& part = facade_.parts[i];
        if (part.kind != PartKind::kSide || part.patterned) continue;
        const bool axial = std::max(std::abs(part.normal.u), std::abs(part.normal.v)) > 0.9995;
        const double beside = axial ? lateral_ : lateral_ + grid_.stair;
        bool all = true, seen = false;
        for (const Point& p : sample_points(part, kSampleMetres)) {
            const double in = depth_at(p.u - part.normal.u * beside, p.v - part.normal.v * beside);
            const double out = depth_at(p.u + part.normal.u * beside, p.v + part.normal.v * beside);
            // The relief's own edge yields to the walls beside it: they stay what they are.
            const double aside = beside + kEdgeMetres;
            const bool at_edge = is_beyond(p.u + part.normal.u * aside, p.v + part.normal.v * aside);
            all = all && !at_edge && std::max(in, out) >= p.w - tolerance_ && p.w >= decision.deepest - tolerance_;
            seen = seen || std::min(in, out) < p.w - tolerance_;
            if (!all) break;
        }
        decision.replaced[i] = all ? 1 : 0;
        decision.shown[i] = all && seen ? 1 : 0;
    }
}

/// Sides of the model on sides that the relief draws, whatever becomes of them: one looks as the other. Not floors: a
/// ledge in their colour would be seen from the front.
void Decider::find_beside(Decision& decision) const {
    decision.beside.assign(facade_.parts.size(), 0);
    for (size_t i = 0; i < facade_.parts.size(); ++i) {
        const Part& part = facade_.parts[i];
        if (part.kind == PartKind::kSpeck || part.ground || std::abs(part.normal.w) > kEdgeOn) continue;
        if (part.high.w < decision.deepest + tolerance_) continue;
        const std::vector<Point> points = sample_points(part, kSampleMetres);
        decision.beside[i] = std::any_of(points.begin(), points.end(), [&](const Point& p) {
            const double in = depth_at(p.u - part.normal.u * lateral_, p.v - part.normal.v * lateral_);
            const double out = depth_at(p.u + part.normal.u * lateral_, p.v + part.normal.v * lateral_);
            return in > p.w && out < p.w;
        });
    }
}

/// What is neither front nor side goes only where it is inside the solid: in all cells that it covers, or, where it is
/// too small to cover one, in some points.
void Decider::judge_others(Decision& decision) const {
    // Of two panes in one plane that face in and out, the relief shows the latter.
    const auto is_hidden = [&](const Part& part, double w, double depth) {
        const double margin = part.normal.w < 0 ? -kSamePlaneMetres : 0.25 * tolerance_;
        return w >= decision.deepest - kSamePlaneMetres && depth > w + margin;
    };
    std::vector<uint8_t> covers(facade_.parts.size(), 0), seen(facade_.parts.size(), 0);
    for (size_t cell = 0; cell < top_.size(); ++cell) {
        const double depth = depth_of(cell);
        for (const Layer& layer : stack_.at(cell)) {
            covers[layer.part] = 1;
            if (!is_hidden(facade_.parts[layer.part], layer.w, depth)) seen[layer.part] = 1;
        }
    }
    for (size_t i = 0; i < facade_.parts.size(); ++i) {
        const Part& part = facade_.parts[i];
        if (part.kind == PartKind::kSpeck) decision.replaced[i] = 1;
        const bool may_hide =
            part.kind == PartKind::kOther || (part.kind == PartKind::kFlat && facade_.patches[part.patch].kept);
        const bool at_edge =
            is_beyond(part.low.u - kEdgeMetres, part.low.v) || is_beyond(part.high.u + kEdgeMetres, part.high.v);
        if (!may_hide || at_edge || seen[i] != 0) continue;
        const std::vector<Point> points = sample_points(part, kSampleMetres);
        // Walls seen edge-on are in no cell: the solid has to be on both sides of them.
        const double aside = kEdgeMetres * std::hypot(part.normal.u, part.normal.v);
        decision.replaced[i] = covers[i] != 0 || std::all_of(points.begin(), points.end(), [&](const Point& p) {
                                   const Point d = part.normal * aside;
                                   return is_hidden(part, p.w, depth_at(p.u - d.u, p.v - d.v)) &&
                                          is_hidden(part, p.w, depth_at(p.u + d.u, p.v + d.v));
                               });
    }
}

Decision Decider::decide() {
    for (int round = 0; round < kMostRounds; ++round) {
        find_tops();
        if (!keep_floating_patches()) break;
    }
    Decision decision;
    find_tops();
    decision.top = top_;
    decision.replaced.assign(facade_.parts.size(), 0);
    decision.shown.assign(facade_.parts.size(), 0);
    decision.deepest = 1e300;
    for (size_t cell = 0; cell < top_.size(); ++cell) {
        if (top_[cell] == kNone) continue;
        decision.shown[top_[cell]] = 1;
        decision.deepest = std::min(decision.deepest, depth_of(cell));
    }
    for (size_t i = 0; i < facade_.parts.size(); ++i) {
        const Part& part = facade_.parts[i];
        if (part.kind != PartKind::kFlat || facade_.patches[part.patch].kept) continue;
        // Below the relief's volume nothing was looked at: it may be seen from the side.
        const double level = facade_.patches[part.patch].level_mm * 0.001;
        decision.replaced[i] =
            decision.shown[i] != 0 || (level >= decision.deepest - tolerance_ && is_below(part, level)) ? 1 : 0;
    }
    judge_sides(decision);
    find_beside(decision);
    judge_others(decision);
    decision.false_sides = untrue_rim(decision.deepest);
    return decision;
}

}  // namespace citystream::tiles::layers::relief
