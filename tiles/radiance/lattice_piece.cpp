#include "tiles/radiance/lattice_piece.h"

#include <algorithm>
#include <cmath>

namespace citystream::tiles::radiance {

namespace {

using Place = std::array<double, 2>;

constexpr double kInset = 1.0 / 32;   ///< of the spacing
constexpr double kLeastArea = 1;      ///< grid units squared
constexpr int32_t kPlacesAcross = 8;  ///< of a piece's bounds

std::array<int64_t, 3> coordinates(const GridPoint& point) {
    return {point.x, point.y, point.z};
}

double squared(double value) {
    return value * value;
}

/// Whether the least altitude is below kThinnest: twice the area over the longest edge.
bool thin(const SurfaceTriangle& triangle, const std::array<int64_t, 3>& normal) {
    double longest = 0, area = 0;
    for (uint32_t i = 0; i < 3; ++i) {
        const GridPoint &p = triangle.corners[i], &q = triangle.corners[(i + 1) % 3];
        longest = std::max(longest, squared(static_cast<double>(q.x - p.x)) + squared(static_cast<double>(q.y - p.y)) +
                                        squared(static_cast<double>(q.z - p.z)));
        area += squared(static_cast<double>(normal[i]));
    }
    return area < longest * squared(kThinnest);
}

int8_t tilt_of(int64_t lesser, int64_t greatest) {
    const double tilt = std::round(static_cast<double>(lesser) / static_cast<double>(greatest) * kTiltOne);
    return static_cast<int8_t>(std::clamp<double>(tilt, -kTiltOne, kTiltOne));
}

ClassTriangle seen_along(const SurfaceTriangle& triangle, const std::array<int64_t, 3>& normal,
                         uint32_t surface_class) {
    const auto [own, a, b] = class_axes(surface_class);
    ClassTriangle result;
    result.surface_class = surface_class;
    for (uint32_t i = 0; i < 3; ++i) {
        const auto corner = coordinates(triangle.corners[i]);
        result.corners[i] = {corner[a], corner[b], corner[own]};
    }
    std::rotate(result.corners.begin(), std::min_element(result.corners.begin(), result.corners.end()),
                result.corners.end());
    const auto greatest = static_cast<double>(normal[own]);
    result.slope = {-static_cast<double>(normal[a]) / greatest, -static_cast<double>(normal[b]) / greatest};
    const int64_t magnitude = std::abs(normal[own]);
    result.tilt = {tilt_of(normal[a], magnitude), tilt_of(normal[b], magnitude)};
    return result;
}

}  // namespace

int64_t ClassTriangle::depth_at(const std::array<int64_t, 2>& column_at) const {
    const auto& first = corners[0];
    return first[2] + std::llround(slope[0] * static_cast<double>(column_at[0] - first[0]) +
                                   slope[1] * static_cast<double>(column_at[1] - first[1]));
}

std::vector<ClassTriangle> seen_along_classes(const SurfaceTriangle& triangle) {
    const auto normal = exact_normal(triangle);
    std::vector<ClassTriangle> result;
    if (thin(triangle, normal)) return result;
    const int64_t greatest = std::max({std::abs(normal[0]), std::abs(normal[1]), std::abs(normal[2])});
    for (uint32_t axis = 0; axis < 3; ++axis) {
        if (std::abs(normal[axis]) < greatest - greatest / kTie) continue;
        result.push_back(seen_along(triangle, normal, 2 * axis + (normal[axis] < 0 ? 1 : 0)));
    }
    return result;
}

LatticePiece::LatticePiece(const ClassTriangle& triangle, const std::array<int64_t, 2>& column_at, int64_t spacing)
    : triangle_(triangle), column_at_(column_at), spacing_(spacing) {}

std::optional<LatticePiece> LatticePiece::create(const ClassTriangle& triangle, const std::array<int64_t, 2>& column_at,
                                                 int64_t spacing) {
    LatticePiece piece(triangle, column_at, spacing);
    for (const auto& corner : triangle.corners) {
        piece.polygon_.add(
            {static_cast<double>(corner[0] - column_at[0]), static_cast<double>(corner[1] - column_at[1]), 0});
    }
    const auto side = static_cast<double>(spacing);
    piece.polygon_.clip({1, 0}, side);
    piece.polygon_.clip({-1, 0}, side);
    piece.polygon_.clip({0, 1}, side);
    piece.polygon_.clip({0, -1}, side);
    const auto points = piece.polygon_.points();
    double area = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        const auto &p = points[i], &q = points[(i + 1) % points.size()];
        area += (p[0] * q[1] - q[0] * p[1]) / 2;
        piece.middle_[0] += p[0] / static_cast<double>(points.size());
        piece.middle_[1] += p[1] / static_cast<double>(points.size());
    }
    if (std::abs(area) < kLeastArea) return std::nullopt;
    piece.turn_ = area > 0 ? 1 : -1;
    piece.find_nearest();
    return piece;
}

void LatticePiece::find_nearest() {
    // The nearest point of the border, and of the piece.
    Place border{}, nearest{};
    double least = INFINITY;
    const auto points = polygon_.points();
    for (size_t i = 0; i < points.size(); ++i) {
        const auto &p = points[i], &q = points[(i + 1) % points.size()];
        const Place edge = {q[0] - p[0], q[1] - p[1]};
        const double length = squared(edge[0]) + squared(edge[1]);
        const double along = length == 0 ? 0 : std::clamp(-(p[0] * edge[0] + p[1] * edge[1]) / length, 0.0, 1.0);
        const Place place = {p[0] + along * edge[0], p[1] + along * edge[1]};
        const double distance = squared(place[0]) + squared(place[1]);
        if (distance < least) {
            least = distance;
            border = place;
        }
    }
    const double inset = kInset * static_cast<double>(spacing_);
    const bool inside = holds({0, 0});
    if (!inside || least < squared(inset)) {
        const Place start = inside ? nearest : border;
        const Place inwards = {middle_[0] - start[0], middle_[1] - start[1]};
        const double way = std::sqrt(squared(inwards[0]) + squared(inwards[1]));
        const double part = way > inset ? inset / way : 1;
        nearest = {start[0] + inwards[0] * part, start[1] + inwards[1] * part};
    }
    nearest_ = {std::round(nearest[0]), std::round(nearest[1])};
    squared_distance_ = static_cast<int64_t>(squared(nearest_[0]) + squared(nearest_[1]));
}

bool LatticePiece::holds(const Place& place) const {
    const auto points = polygon_.points();
    for (size_t i = 0; i < points.size(); ++i) {
        const auto &p = points[i], &q = points[(i + 1) % points.size()];
        const double side = (q[0] - p[0]) * (place[1] - p[1]) - (q[1] - p[1]) * (place[0] - p[0]);
        if (side * turn_ < 0) return false;
    }
    return true;
}

GridPoint LatticePiece::point_at(const Place& place) const {
    const auto [own, a, b] = class_axes(triangle_.surface_class);
    const auto& first = triangle_.corners[0];
    std::array<int64_t, 3> point{};
    point[a] = column_at_[0] + std::llround(place[0]);
    point[b] = column_at_[1] + std::llround(place[1]);
    point[own] = first[2] + std::llround(triangle_.slope[0] * static_cast<double>(point[a] - first[0]) +
                                         triangle_.slope[1] * static_cast<double>(point[b] - first[1]));
    return {point[0], point[1], point[2]};
}

double LatticePiece::share() const {
    const auto points = polygon_.points();
    const auto side = static_cast<double>(spacing_);
    const auto weight_between = [&](const ClippedPolygon::Point& p, const ClippedPolygon::Point& q) {
        return (1 - std::abs(p[0] + q[0]) / 2 / side) * (1 - std::abs(p[1] + q[1]) / 2 / side);
    };
    double sum = 0;
    for (size_t i = 1; i + 1 < points.size(); ++i) {
        const auto &p = points[0], &q = points[i], &r = points[i + 1];
        const double area = std::abs((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])) / 2;
        sum += area * (weight_between(p, q) + weight_between(q, r) + weight_between(r, p)) / 3;
    }
    return sum;
}

GridPoint LatticePiece::nearest() const {
    return point_at(nearest_);
}

std::optional<GridPoint> LatticePiece::at(const Place& place) const {
    const auto side = static_cast<double>(spacing_);
    const Place inside = {std::round(place[0] * side), std::round(place[1] * side)};
    if (!holds(inside)) return std::nullopt;
    return point_at(inside);
}

std::array<Place, 2> LatticePiece::polygon_bounds() const {
    Place low = middle_, high = middle_;
    for (const auto& point : polygon_.points()) {
        for (uint32_t axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], point[axis]);
            high[axis] = std::max(high[axis], point[axis]);
        }
    }
    return {low, high};
}

std::array<Place, 2> LatticePiece::bounds() const {
    const auto side = static_cast<double>(spacing_);
    auto bounds = polygon_bounds();
    for (Place& place : bounds) place = {place[0] / side, place[1] / side};
    return bounds;
}

std::vector<GridPoint> LatticePiece::others() const {
    std::vector<Place> places;
    const auto [low, high] = polygon_bounds();
    const Place step = {(high[0] - low[0]) / kPlacesAcross, (high[1] - low[1]) / kPlacesAcross};
    for (int32_t j = 0; j < kPlacesAcross; ++j) {
        for (int32_t i = 0; i < kPlacesAcross; ++i) {
            const Place place = {low[0] + (i + 0.5) * step[0], low[1] + (j + 0.5) * step[1]};
            if (holds(place)) places.push_back(place);
        }
    }
    places.push_back(middle_);
    std::stable_sort(places.begin(), places.end(), [](const Place& p, const Place& q) {
        return squared(p[0]) + squared(p[1]) < squared(q[0]) + squared(q[1]);
    });
    std::vector<GridPoint> points;
    points.reserve(places.size());
    for (const Place& place : places) points.push_back(point_at(place));
    return points;
}

}  // namespace citystream::tiles::radiance
