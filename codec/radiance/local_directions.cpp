#include "codec/radiance/local_directions.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "codec/radiance/frames.h"
#include "codec/radiance/series_angle.h"
#include "codec/vector.h"

namespace citystream::codec::radiance {

namespace {

/// Side of the cube grid that finds candidates.
constexpr uint32_t kLookupSide = 32;
/// Room for rounding of directions and angles, radians.
constexpr double kSlack = 0.01;
constexpr uint32_t kAverageSide = 256;

Vector shirley_chiu(double a, double b) {
    const double x = 2 * a - 1, y = 2 * b - 1;
    double r = 0, phi = 0;
    if (std::abs(x) > std::abs(y)) {
        r = x;
        phi = kPi / 4 * (y / x);
    } else if (y != 0) {
        r = y;
        phi = kPi / 2 - kPi / 4 * (x / y);
    }
    const AngleParts parts = angle_parts(phi);
    const double s = std::sqrt(2 - r * r);
    return {r * parts.cosine * s, r * parts.sine * s, 1 - r * r};
}

int64_t product(const GridDirection& a, const std::array<int64_t, 3>& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector unit(const GridDirection& d) {
    const double x = d[0], y = d[1], z = d[2], length = std::sqrt(x * x + y * y + z * z);
    return {x / length, y / length, z / length};
}

double cosine(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double angle(const Vector& a, const Vector& b) {
    return std::acos(std::clamp(cosine(a, b), -1.0, 1.0));
}

/// Angle from a cell's centre to the farthest of its corners, which are centres of cells of a grid of twice the side,
/// give or take half of its cells.
double cell_radius(uint32_t side, uint32_t cell) {
    const Vector centre = unit(cell_direction(side, cell));
    const uint32_t column = cell % side, row = cell / side % side, face = cell / side / side;
    double radius = 0;
    for (const uint32_t corner : {0u, 1u, 2u, 3u}) {
        const uint32_t part = (face * 4 * side + 4 * row + 3 * (corner / 2)) * 4 * side + 4 * column + 3 * (corner % 2);
        radius = std::max(radius, angle(centre, unit(cell_direction(4 * side, part))));
    }
    return radius * 4 / 3;
}

}  // namespace

LocalDirections::LocalDirections(uint32_t side) : side_(side) {
    assert(side >= 1 && side <= kMostLocalSide);
    std::vector<Vector> units;
    for (uint32_t j = 0; j < side * side; ++j) {
        units.push_back(shirley_chiu((j % side + 0.5) / side, (j / side + 0.5) / side));
        GridDirection grid{};
        for (size_t i = 0; i < 3; ++i) grid[i] = static_cast<int32_t>(std::floor(units[j][i] * kFrameOne + 0.5));
        directions_.push_back(grid);
    }
    // What is nearest to a point of a cell is no farther from the centre than the centre's nearest and twice the
    // radius.
    std::vector<double> cosines(units.size());
    for (uint32_t cell = 0; cell < cube_cells(kLookupSide); ++cell) {
        const Vector centre = unit(cell_direction(kLookupSide, cell));
        for (size_t j = 0; j < units.size(); ++j) cosines[j] = cosine(centre, units[j]);
        const double nearest = std::acos(std::min(*std::max_element(cosines.begin(), cosines.end()), 1.0));
        const double least = std::cos(std::min(nearest + 2 * cell_radius(kLookupSide, cell) + kSlack, kPi));
        candidate_begin_.push_back(static_cast<uint32_t>(candidates_.size()));
        for (size_t j = 0; j < units.size(); ++j) {
            if (cosines[j] >= least) candidates_.push_back(static_cast<uint16_t>(j));
        }
    }
    candidate_begin_.push_back(static_cast<uint32_t>(candidates_.size()));
}

uint32_t LocalDirections::nearest(const std::array<int64_t, 3>& local) const {
    const uint32_t cell = cell_of(local, kLookupSide);
    uint32_t best = candidates_[candidate_begin_[cell]];
    int64_t most = product(directions_[best], local);
    for (uint32_t i = candidate_begin_[cell] + 1; i < candidate_begin_[cell + 1]; ++i) {
        const int64_t here = product(directions_[candidates_[i]], local);
        if (here <= most) continue;
        most = here;
        best = candidates_[i];
    }
    return best;
}

uint32_t LocalDirections::nearest_of_all(const std::array<int64_t, 3>& local) const {
    uint32_t best = 0;
    for (uint32_t j = 1; j < count(); ++j) {
        if (product(directions_[j], local) > product(directions_[best], local)) best = j;
    }
    return best;
}

CellAverages cell_averages(const LocalDirections& directions) {
    CellAverages averages{std::vector<double>(directions.count(), 0), std::vector<double>(directions.count(), 0)};
    for (uint32_t cell = 0; cell < cube_cells(kAverageSide); ++cell) {
        const GridDirection d = cell_direction(kAverageSide, cell);
        if (d[2] <= 0) continue;
        const uint32_t j = directions.nearest({d[0], d[1], d[2]});
        const double solid_angle = cell_solid_angle(kAverageSide, cell);
        averages.solid_angle[j] += solid_angle;
        averages.cosine[j] += solid_angle * unit(d)[2];
    }
    for (uint32_t j = 0; j < directions.count(); ++j) averages.cosine[j] /= averages.solid_angle[j];
    return averages;
}

}  // namespace citystream::codec::radiance
