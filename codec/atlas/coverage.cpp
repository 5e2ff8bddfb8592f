#include "codec/atlas/coverage.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "codec/vector.h"

namespace citystream::codec::atlas {

namespace {

Vector minus(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double length(const Vector& a) {
    return std::hypot(a[0], a[1], a[2]);
}

/// A triangle by two edges from its first corner.
struct Edges {
    Vector p, q;            // in space
    double pu, pv, qu, qv;  // in the texture

    Edges(const CoverageVertex& a, const CoverageVertex& b, const CoverageVertex& c)
        : p(minus(b.position, a.position)),
          q(minus(c.position, a.position)),
          pu(b.texture[0] - a.texture[0]),
          pv(b.texture[1] - a.texture[1]),
          qu(c.texture[0] - a.texture[0]),
          qv(c.texture[1] - a.texture[1]) {}

    double texture_area_twice() const { return pu * qv - pv * qu; }
    /// |dP/du| and |dP/dv|.
    std::array<double, 2> metres() const {
        const double twice = texture_area_twice();
        Vector du, dv;
        for (size_t k = 0; k < 3; ++k) {
            du[k] = (qv * p[k] - pv * q[k]) / twice;
            dv[k] = (pu * q[k] - qu * p[k]) / twice;
        }
        return {length(du), length(dv)};
    }
};

double span_of(std::span<const CoverageVertex> corners, size_t axis) {
    const auto [low, high] = std::minmax_element(
        corners.begin(), corners.end(),
        [axis](const CoverageVertex& a, const CoverageVertex& b) { return a.texture[axis] < b.texture[axis]; });
    return high->texture[axis] - low->texture[axis];
}

bool finite(const CoverageVertex& corner) {
    const auto is_finite = [](double value) { return std::isfinite(value); };
    return std::all_of(corner.position.begin(), corner.position.end(), is_finite) &&
           std::all_of(corner.texture.begin(), corner.texture.end(), is_finite);
}

uint32_t texels(uint32_t side, double metres, double metres_per_texel) {
    constexpr double kRounding = 1e-9;  // a quotient that is a whole number up to rounding is that number
    const double wanted = std::floor(metres / metres_per_texel * (1 + kRounding));
    return wanted >= side ? side : std::max(1u, static_cast<uint32_t>(wanted));
}

}  // namespace

void add_polygon(Coverage& coverage, std::span<const CoverageVertex> corners) {
    constexpr double kLeastArea = 1e-12;
    double texture_area = 0, space_area = 0, widest = 0;
    std::array<double, 2> metres{};
    if (corners.size() >= 3 && std::all_of(corners.begin(), corners.end(), finite)) {
        for (size_t i = 1; i + 1 < corners.size(); ++i) {
            const Edges triangle(corners[0], corners[i], corners[i + 1]);
            const double area = triangle.texture_area_twice() / 2;
            texture_area += area;
            space_area = std::max(space_area, length(cross(triangle.p, triangle.q)) / 2);
            if (std::abs(area) <= widest || std::abs(area) < kLeastArea) continue;
            widest = std::abs(area);
            metres = triangle.metres();
        }
    }
    if (widest == 0 || space_area < kLeastArea || !std::isfinite(metres[0] + metres[1])) {
        ++coverage.degenerate;
        return;
    }
    add_coverage(coverage,
                 {metres[0], metres[1], std::abs(texture_area), span_of(corners, 0), span_of(corners, 1), 1, 0});
}

void add_coverage(Coverage& coverage, const Coverage& other) {
    coverage.metres_u = std::max(coverage.metres_u, other.metres_u);
    coverage.metres_v = std::max(coverage.metres_v, other.metres_v);
    coverage.repeats += other.repeats;
    coverage.repeats_u = std::max(coverage.repeats_u, other.repeats_u);
    coverage.repeats_v = std::max(coverage.repeats_v, other.repeats_v);
    coverage.polygons += other.polygons;
    coverage.degenerate += other.degenerate;
}

ChartSize view_size(ChartSize image, const Coverage& coverage, double metres_per_texel) {
    assert(image.width >= 1 && image.height >= 1 && metres_per_texel > 0);
    if (!coverage.used()) return {};
    return {texels(image.width, coverage.metres_u, metres_per_texel),
            texels(image.height, coverage.metres_v, metres_per_texel)};
}

}  // namespace citystream::codec::atlas
