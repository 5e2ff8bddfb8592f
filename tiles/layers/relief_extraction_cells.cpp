#include "tiles/layers/relief_extraction_cells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "codec/facade/run_grid.h"

namespace citystream::tiles::layers::relief {
namespace {

constexpr double kTouching = 1e-7;  // metres: a centre on an edge belongs to both sides

void add_cuts_along(const OutlineEdge& edge, double texel, double stair, std::vector<double>& us,
                    std::vector<double>& vs) {
    const Point d = edge.to - edge.from;
    const double least = std::min(std::abs(d.u), std::abs(d.v));
    if (least <= texel) return;
    const bool u_is_minor = std::abs(d.u) < std::abs(d.v);
    const int steps = static_cast<int>(std::ceil(least / stair));
    for (int i = 0; i < steps; ++i) {
        // The stairs' risers in the middle of their treads: the outline is crossed, not followed on one side.
        const Point riser = edge.from + d * ((i + 0.5) / steps), tread = edge.from + d * (double{1} * i / steps);
        (u_is_minor ? vs : us).push_back(u_is_minor ? riser.v : riser.u);
        (u_is_minor ? us : vs).push_back(u_is_minor ? tread.u : tread.v);
    }
}

Axis make_axis(double length, double texel, uint32_t least_gap, const std::vector<double>& wanted) {
    Axis axis;
    axis.length = length;
    axis.texels = static_cast<uint32_t>(
        std::clamp(std::lround(length / texel), 1L, static_cast<long>(codec::facade::kMaxFacadeSide)));
    std::vector<uint32_t> cuts;
    for (const double at : wanted) {
        const long cut = std::lround(at / axis.texel());
        if (cut > 0 && cut < static_cast<long>(axis.texels)) cuts.push_back(static_cast<uint32_t>(cut));
    }
    std::sort(cuts.begin(), cuts.end());
    axis.cut = {0};
    for (const uint32_t cut : cuts) {
        if (cut >= axis.cut.back() + least_gap && cut + least_gap <= axis.texels) axis.cut.push_back(cut);
    }
    axis.cut.push_back(axis.texels);
    for (const uint32_t cut : axis.cut) axis.at.push_back(cut * axis.texel());
    for (size_t i = 1; i < axis.at.size(); ++i) axis.centre.push_back((axis.at[i - 1] + axis.at[i]) / 2);
    return axis;
}

/// Calls `cell(index, w)` for the cells whose centre the part covers.
template <typename Cell>
void draw(const CellGrid& grid, const Part& part, const Cell& cell) {
    const auto first_from = [](const Axis& axis, double at) {
        return static_cast<uint32_t>(std::lower_bound(axis.centre.begin(), axis.centre.end(), at) -
                                     axis.centre.begin());
    };
    const Point& a = part.corner[0];
    for (uint32_t row = first_from(grid.v, part.low.v - kTouching);
         row < grid.v.cells() && grid.v.centre[row] <= part.high.v + kTouching; ++row) {
        const double v = std::clamp(grid.v.centre[row], part.low.v, part.high.v);
        double left = 1e300, right = -1e300;
        for (size_t k = 0; k < 3; ++k) {
            const Point &p = part.corner[k], &q = part.corner[(k + 1) % 3];
            if (v < std::min(p.v, q.v) || v > std::max(p.v, q.v)) continue;
            const double share = p.v == q.v ? 0 : (v - p.v) / (q.v - p.v);
            for (const double u : {p.u + share * (q.u - p.u), p.v == q.v ? q.u : p.u + share * (q.u - p.u)}) {
                left = std::min(left, u);
                right = std::max(right, u);
            }
        }
        for (uint32_t column = first_from(grid.u, left - kTouching);
             column < grid.u.cells() && grid.u.centre[column] <= right + kTouching; ++column) {
            const double w =
                a.w - ((grid.u.centre[column] - a.u) * part.normal.u + (v - a.v) * part.normal.v) / part.normal.w;
            cell(size_t{row} * grid.u.cells() + column, w);
        }
    }
}

constexpr double kEdgeOn = 0.05;  // parts steeper than this against the view are not drawn

}  // namespace

uint32_t Axis::cell_of(double coordinate) const {
    const auto above = std::upper_bound(at.begin() + 1, at.end() - 1, coordinate);
    return static_cast<uint32_t>(above - at.begin()) - 1;
}

CellGrid make_cell_grid(const WallFrame& frame, const FacadeParts& facade, double texel, double stair,
                        size_t most_cells) {
    const std::vector<OutlineEdge> edges = outlines(facade);
    for (uint32_t coarser = 1;; coarser *= 2) {
        std::vector<double> us, vs;
        for (const Part& part : facade.parts) {
            if (part.kind != PartKind::kFlat) continue;
            for (const Point& p : part.corner) {
                us.push_back(p.u);
                vs.push_back(p.v);
            }
        }
        for (const OutlineEdge& edge : edges) add_cuts_along(edge, texel, stair * coarser, us, vs);
        CellGrid grid{make_axis(frame.width, texel, coarser, us), make_axis(frame.height, texel, coarser, vs),
                      stair * coarser};
        if (grid.cells() <= most_cells || coarser > 64) return grid;
    }
}

LayerStack::LayerStack(const CellGrid& grid, const FacadeParts& facade, double deepest) {
    const auto each = [&](const auto& use) {
        for (uint32_t i = 0; i < facade.parts.size(); ++i) {
            const Part& part = facade.parts[i];
            if (part.kind == PartKind::kSpeck || std::abs(part.normal.w) < kEdgeOn) continue;
            const bool flat = part.kind == PartKind::kFlat;
            draw(grid, part, [&](size_t cell, double w) {
                if (flat) w = facade.patches[part.patch].depth;
                if (w >= deepest) use(cell, Layer{w, i});
            });
        }
    };
    begin_.assign(grid.cells() + 1, 0);
    each([&](size_t cell, const Layer&) { ++begin_[cell + 1]; });
    for (size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
    layers_.resize(begin_.back());
    std::vector<uint32_t> next(begin_.begin(), begin_.end() - 1);
    each([&](size_t cell, const Layer& layer) { layers_[next[cell]++] = layer; });
    // Of patches in one plane the smaller one shows: a detail that lies on a pane or a wall.
    const auto rank = [&](const Layer& layer) {
        const Part& part = facade.parts[layer.part];
        return std::pair(part.kind == PartKind::kFlat ? facade.patches[part.patch].area : part.area, layer.part);
    };
    for (size_t cell = 0; cell < grid.cells(); ++cell) {
        std::sort(layers_.begin() + begin_[cell], layers_.begin() + begin_[cell + 1],
                  [&](const Layer& a, const Layer& b) { return a.w != b.w ? a.w > b.w : rank(a) < rank(b); });
    }
}

}  // namespace citystream::tiles::layers::relief
