#include "codec/radiance/source_directions.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace citystream::codec::radiance {

namespace {

/// A direction's face, and its s and t in units of the major component's size.
template <typename Number>
struct FacePlace {
    uint32_t face;
    Number s, t, major;
};

template <typename Number>
FacePlace<Number> face_place(const std::array<Number, 3>& d) {
    const auto size = [](Number v) { return v < 0 ? -v : v; };
    const Number x = size(d[0]), y = size(d[1]), z = size(d[2]);
    if (z >= x && z >= y)
        return d[2] < 0 ? FacePlace<Number>{5, -d[0], -d[1], z} : FacePlace<Number>{4, d[0], -d[1], z};
    if (y >= x) return d[1] < 0 ? FacePlace<Number>{3, d[0], -d[2], y} : FacePlace<Number>{2, d[0], d[2], y};
    return d[0] < 0 ? FacePlace<Number>{1, d[2], -d[1], x} : FacePlace<Number>{0, -d[2], -d[1], x};
}

double corner_area(double x, double y) {
    return std::atan2(x * y, std::sqrt(x * x + y * y + 1));
}

}  // namespace

GridDirection cell_direction(uint32_t side, uint32_t cell) {
    assert(side >= 1 && cell < cube_cells(side));
    const auto size = static_cast<int32_t>(side);
    const int32_t s = 2 * static_cast<int32_t>(cell % side) + 1 - size;
    const int32_t t = 2 * static_cast<int32_t>(cell / side % side) + 1 - size;
    switch (cell / side / side) {
        case 0:
            return {size, -t, -s};
        case 1:
            return {-size, -t, s};
        case 2:
            return {s, size, t};
        case 3:
            return {s, -size, -t};
        case 4:
            return {s, -t, size};
        default:
            return {-s, -t, -size};
    }
}

FaceProduct face_product(const std::array<int64_t, 3>& vector, uint32_t side, uint32_t face) {
    const auto at = [&](uint32_t cell) {
        const GridDirection d = cell_direction(side, cell);
        return vector[0] * d[0] + vector[1] * d[1] + vector[2] * d[2];
    };
    const uint32_t first = face * side * side;
    FaceProduct product{at(first), 0, 0};
    if (side > 1) {
        product.right = at(first + 1) - product.first;
        product.down = at(first + side) - product.first;
    }
    return product;
}

uint32_t cell_of(const std::array<int64_t, 3>& direction, uint32_t side) {
    const auto place = face_place(direction);
    if (place.major == 0) return (4 * side + side / 2) * side + side / 2;
    const auto along = [&](int64_t v) {
        const int64_t i = (v + place.major) * side / (2 * place.major);
        return static_cast<uint32_t>(std::min<int64_t>(i, side - 1));
    };
    return (place.face * side + along(place.t)) * side + along(place.s);
}

uint32_t cell_of(const std::array<double, 3>& direction, uint32_t side) {
    const auto place = face_place(direction);
    if (!(place.major > 0)) return (4 * side + side / 2) * side + side / 2;
    const auto along = [&](double v) {
        const double i = (v / place.major + 1) / 2 * side;
        return static_cast<uint32_t>(std::clamp(i, 0.0, static_cast<double>(side - 1)));
    };
    return (place.face * side + along(place.t)) * side + along(place.s);
}

uint32_t texel_of_sample(uint32_t texels_across, uint32_t sample) {
    const uint32_t side = kSamplesAcross * texels_across;
    const uint32_t column = sample % side, row = sample / side % side, face = sample / side / side;
    return (face * texels_across + row / kSamplesAcross) * texels_across + column / kSamplesAcross;
}

double cell_solid_angle(uint32_t side, uint32_t cell) {
    const double x0 = 2.0 * (cell % side) / side - 1, y0 = 2.0 * (cell / side % side) / side - 1;
    const double x1 = x0 + 2.0 / side, y1 = y0 + 2.0 / side;
    return corner_area(x1, y1) - corner_area(x0, y1) - corner_area(x1, y0) + corner_area(x0, y0);
}

std::array<double, 3> cell_mean_direction(uint32_t side, uint32_t cell) {
    const GridDirection centre = cell_direction(side, cell);
    const auto toward_major = [&](size_t axis) { return std::abs(centre[axis]) == static_cast<int32_t>(side); };
    const size_t major = toward_major(0) ? 0 : toward_major(1) ? 1 : 2;
    const size_t s = (major + 1) % 3, t = (major + 2) % 3;
    std::array<std::array<double, 3>, 4> corners{};
    for (size_t i = 0; i < 4; ++i) {
        auto& corner = corners[i];
        for (size_t k = 0; k < 3; ++k) corner[k] = centre[k];
        corner[s] += i == 1 || i == 2 ? 1 : -1;
        corner[t] += i >= 2 ? 1 : -1;
    }
    std::array<double, 3> sum{};
    for (size_t i = 0; i < 4; ++i) {
        const auto &a = corners[i], &b = corners[(i + 1) % 4];
        const std::array<double, 3> normal = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                              a[0] * b[1] - a[1] * b[0]};
        const double sine = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
        const double angle = std::atan2(sine, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
        for (size_t k = 0; k < 3; ++k) sum[k] += angle / (2 * sine) * normal[k];
    }
    // Counter-clockwise along the axis is clockwise against it.
    const double factor = (centre[major] > 0 ? 1 : -1) / cell_solid_angle(side, cell);
    return {factor * sum[0], factor * sum[1], factor * sum[2]};
}

}  // namespace citystream::codec::radiance
