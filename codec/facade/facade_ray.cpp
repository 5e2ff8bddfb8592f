#include "codec/facade/facade_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace citystream::codec::facade {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

double depth_of(uint32_t label) {
    return displacement_of(label);
}
bool is_open(uint32_t label) {
    return displacement_of(label) == kOpenDisplacement;
}

/// The part of a ray inside the volume, and the face by which it comes in (axis -1: it starts inside).
struct Span {
    double enter = 0, leave = kNever;
    int axis = -1;
    bool empty = false;
};

Span clip_to_volume(const double high_u, double high_v, const DepthRange& depths, const double origin[3],
                    const double direction[3]) {
    const double low[3] = {0, 0, static_cast<double>(depths.min_mm)};
    const double high[3] = {high_u, high_v, static_cast<double>(depths.max_mm)};
    Span span;
    for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0) {
            if (origin[axis] < low[axis] || origin[axis] > high[axis]) span.empty = true;
            continue;
        }
        const double to_low = (low[axis] - origin[axis]) / direction[axis];
        const double to_high = (high[axis] - origin[axis]) / direction[axis];
        const double near = std::min(to_low, to_high);
        if (near > span.enter) {
            span.enter = near;
            span.axis = axis;
        }
        span.leave = std::min(span.leave, std::max(to_low, to_high));
    }
    // A direction component next to zero can put the entry at infinity.
    span.empty = span.empty || span.enter > span.leave || span.enter == kNever;
    return span;
}

/// One axis of the walk over the non-uniform grid.
struct Walk {
    const std::vector<uint32_t>& breaks;
    uint32_t cells;
    double origin, direction;
    uint32_t cell = 0;

    double at_break(uint32_t i) const { return breaks[i]; }

    /// The cell of a coordinate. On a break, the one that the ray goes into.
    void start(double coordinate) {
        uint32_t low = 0;
        uint32_t high = cells - 1;
        while (low < high) {
            const uint32_t middle = (low + high + 1) / 2;
            const bool beyond = direction < 0 ? at_break(middle) < coordinate : at_break(middle) <= coordinate;
            if (beyond)
                low = middle;
            else
                high = middle - 1;
        }
        cell = low;
    }

    /// Where the ray leaves the current cell. From the ray's origin each time, so that errors do not add up.
    double next() const {
        if (direction == 0) return kNever;
        return (at_break(direction > 0 ? cell + 1 : cell) - origin) / direction;
    }

    /// False when the ray leaves the facade.
    bool step() {
        if (direction > 0 ? cell + 1 == cells : cell == 0) return false;
        cell = direction > 0 ? cell + 1 : cell - 1;
        return true;
    }
};

FacadeRayHit make_hit(double t, uint32_t label, int axis, double direction) {
    return {true, t, label, axis, direction > 0 ? -1 : 1};
}

/// What the ray meets where it comes into the first cell: a whole surface, the back or top of the volume (rounding must
/// not put the ray below it), or an edge.
FacadeRayHit hit_on_entry(const Span& span, const DepthRange& depths, const double origin[3], const double direction[3],
                          uint32_t label) {
    if (is_open(label)) return {};
    if (span.axis == 2) {
        const bool solid = direction[2] > 0 || depth_of(label) >= depths.max_mm;
        return solid ? make_hit(span.enter, label, 2, direction[2]) : FacadeRayHit{};
    }
    if (origin[2] + span.enter * direction[2] >= depth_of(label)) return {};
    return span.axis < 0 ? FacadeRayHit{true, span.enter, label, 2, 1}
                         : make_hit(span.enter, label, span.axis, direction[span.axis]);
}

/// From the place where the ray comes in: over the cells until it meets a side or a front, or leaves.
FacadeRayHit walk_cells(const RunGrid& grid, const DepthRange& depths, const double origin[3],
                        const double direction[3], const Span& span) {
    Walk walks[2] = {{grid.x_breaks, grid.columns(), origin[0], direction[0]},
                     {grid.y_breaks, grid.rows(), origin[1], direction[1]}};
    for (Walk& walk : walks) walk.start(walk.origin + span.enter * walk.direction);
    const auto depth_at = [&](double t) { return origin[2] + t * direction[2]; };
    uint32_t label = grid.label(walks[0].cell, walks[1].cell);
    if (const FacadeRayHit hit = hit_on_entry(span, depths, origin, direction, label); hit.hit) return hit;
    double t = span.enter;
    const uint32_t most_steps = grid.columns() + grid.rows() + 2;
    for (uint32_t step = 0; step < most_steps; ++step) {
        const int axis = walks[1].next() < walks[0].next() ? 1 : 0;
        const double until = std::max(t, walks[axis].next());
        if (direction[2] < 0 && !is_open(label) && depth_at(until) <= depth_of(label)) {
            const double front = (depth_of(label) - origin[2]) / direction[2];
            return make_hit(std::clamp(front, t, until), label, 2, direction[2]);
        }
        // Through an edge, the top, or down an open cell through the back.
        if (until >= span.leave || !walks[axis].step()) return {};
        label = grid.label(walks[0].cell, walks[1].cell);
        t = until;
        if (!is_open(label) && depth_at(t) < depth_of(label)) return make_hit(t, label, axis, direction[axis]);
    }
    return {};
}

bool is_finite(const double origin[3], const double direction[3]) {
    return std::all_of(origin, origin + 3, [](double x) { return std::isfinite(x); }) &&
           std::all_of(direction, direction + 3, [](double x) { return std::isfinite(x); });
}

}  // namespace

FacadeRayHit cast_facade_ray(const RunGrid& grid, const DepthRange& depths, const double origin[3],
                             const double direction[3]) {
    if (!is_finite(origin, direction)) return {};
    const Span span = clip_to_volume(grid.width(), grid.height(), depths, origin, direction);
    return span.empty ? FacadeRayHit{} : walk_cells(grid, depths, origin, direction, span);
}

}  // namespace citystream::codec::facade
