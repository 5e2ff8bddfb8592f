#include <algorithm>
#include <cmath>
#include <limits>

#include "codec/facade/facade_map.h"

namespace citystream::codec::facade {

namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

double depth_of(uint32_t label) {
    return static_cast<int16_t>(label & 0xffffu);
}

/// The part of a ray inside the volume, and the face by which it comes in (axis -1: it starts inside).
struct Span {
    double enter = 0, leave = kNever;
    int axis = -1;
    bool empty = false;
};

Span clip_to_volume(const FacadeMapView& map, const double origin[3], const double direction[3]) {
    const double low[3] = {0, 0, static_cast<double>(map.depth_min_mm())};
    const double high[3] = {static_cast<double>(map.width()), static_cast<double>(map.height()),
                            static_cast<double>(map.depth_max_mm())};
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
    const FacadeMapView& map;
    int axis;
    uint32_t cells;
    double origin, direction;
    uint32_t cell = 0;

    double at_break(uint32_t i) const { return axis == 0 ? map.x_break(i) : map.y_break(i); }

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

/// From the place where the ray comes in: over the cells until it meets a side or a front, or leaves.
FacadeRayHit walk_cells(const FacadeMapView& map, const double origin[3], const double direction[3], const Span& span) {
    Walk walks[2] = {{map, 0, map.columns(), origin[0], direction[0]}, {map, 1, map.rows(), origin[1], direction[1]}};
    for (Walk& walk : walks) walk.start(walk.origin + span.enter * walk.direction);
    const auto depth_at = [&](double t) { return origin[2] + t * direction[2]; };
    uint32_t label = map.label(walks[0].cell, walks[1].cell);
    double t = span.enter;
    if (span.axis == 2) {
        // The top and bottom of the volume are whole surfaces: do not let rounding put the ray below them.
        if (direction[2] > 0 || depth_of(label) >= map.depth_max_mm()) return make_hit(t, label, 2, direction[2]);
    } else if (depth_at(t) < depth_of(label)) {
        return span.axis < 0 ? FacadeRayHit{true, t, label, 2, 1} : make_hit(t, label, span.axis, direction[span.axis]);
    }
    const uint32_t most_steps = map.columns() + map.rows() + 2;
    for (uint32_t step = 0; step < most_steps; ++step) {
        const int axis = walks[1].next() < walks[0].next() ? 1 : 0;
        const double until = std::max(t, walks[axis].next());
        if (direction[2] < 0 && depth_at(until) <= depth_of(label)) {
            const double front = (depth_of(label) - origin[2]) / direction[2];
            return make_hit(std::clamp(front, t, until), label, 2, direction[2]);
        }
        if (until == kNever || !walks[axis].step()) return {};
        if (direction[2] > 0 && depth_at(until) > map.depth_max_mm()) return {};
        label = map.label(walks[0].cell, walks[1].cell);
        t = until;
        if (depth_at(t) < depth_of(label)) return make_hit(t, label, axis, direction[axis]);
    }
    return {};
}

}  // namespace

FacadeRayHit cast_facade_ray(const FacadeMapView& map, const double origin[3], const double direction[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(origin[axis]) || !std::isfinite(direction[axis])) return {};
    }
    const Span span = clip_to_volume(map, origin, direction);
    return span.empty ? FacadeRayHit{} : walk_cells(map, origin, direction, span);
}

}  // namespace citystream::codec::facade
