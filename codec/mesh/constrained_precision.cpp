#include "codec/mesh/constrained_precision.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "codec/mesh/precision.h"
#include "codec/vector.h"

namespace citystream::codec::mesh {
namespace {

Vector difference(const GridPoint& a, const GridPoint& b) {
    Vector d{};
    for (size_t c = 0; c < 3; ++c) d[c] = static_cast<double>(a[c]) - static_cast<double>(b[c]);
    return d;
}

bool all_equal(std::span<const double> attributes) {
    const size_t k = attributes.size() / 3;
    const auto first = attributes.first(k);
    return std::equal(first.begin(), first.end(), attributes.begin() + static_cast<std::ptrdiff_t>(k)) &&
           std::equal(first.begin(), first.end(), attributes.begin() + static_cast<std::ptrdiff_t>(2 * k));
}

}  // namespace

double attribute_slope(const std::array<GridPoint, 3>& corners, std::span<const double> attributes) {
    if (all_equal(attributes)) return 0;
    const Vector e1 = difference(corners[1], corners[0]), e2 = difference(corners[2], corners[0]);
    const Vector normal = cross(e1, e2);
    const double length = std::sqrt(dot(e1, e1));
    const double area = std::sqrt(dot(normal, normal));
    if (!(area > 0)) return std::numeric_limits<double>::infinity();
    // M = ((m11, m12), (0, m22)); the columns of A M^-1 are g and h.
    const double m11 = length, m12 = dot(e1, e2) / length, m22 = area / length;
    double gg = 0, gh = 0, hh = 0;
    const size_t k = attributes.size() / 3;
    for (size_t i = 0; i < k; ++i) {
        const double g = (attributes[k + i] - attributes[i]) / m11;
        const double h = (attributes[2 * k + i] - attributes[i] - g * m12) / m22;
        gg += g * g;
        gh += g * h;
        hh += h * h;
    }
    const double half = (gg - hh) / 2;
    return std::sqrt((gg + hh) / 2 + std::sqrt(half * half + gh * gh));
}

void share_among_duplicates(std::span<const GridPoint> points, std::span<uint32_t> dropped) {
    std::vector<uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return points[a] != points[b] ? points[a] < points[b] : a < b; });
    for (size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        uint32_t least = dropped[order[begin]];
        for (end = begin; end < order.size() && points[order[end]] == points[order[begin]]; ++end)
            least = std::min(least, dropped[order[end]]);
        for (size_t i = begin; i < end; ++i) dropped[order[i]] = least;
    }
}

std::vector<uint32_t> constrained_dropped(std::span<const GridPoint> points,
                                          std::span<const std::array<uint32_t, 3>> triangles,
                                          std::span<const AttributeLimit> limits, std::span<const uint8_t> on_border,
                                          uint32_t common_dropped) {
    assert(on_border.empty() || on_border.size() == points.size());
    std::vector<uint32_t> dropped(points.size(), common_dropped);
    for (const AttributeLimit& limit : limits) {
        const size_t values = size_t{3} * limit.dimensions;
        assert(limit.corner_values.size() == values * triangles.size());
        for (size_t t = 0; t < triangles.size(); ++t) {
            const auto [a, b, c] = triangles[t];
            const double slope =
                attribute_slope({points[a], points[b], points[c]}, limit.corner_values.subspan(t * values, values));
            const uint32_t most =
                slope > 0 ? dropped_for(limit.error / (limit.slope * slope), common_dropped) : common_dropped;
            for (const uint32_t v : triangles[t]) dropped[v] = std::min(dropped[v], most);
        }
    }
    share_among_duplicates(points, dropped);
    for (size_t v = 0; v < on_border.size(); ++v) {
        if (on_border[v] != 0) dropped[v] = common_dropped;
    }
    return dropped;
}

}  // namespace citystream::codec::mesh
