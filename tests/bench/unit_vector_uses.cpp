#include "tests/bench/unit_vector_uses.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_hemisphere.h"
#include "tiles/city/city_input.h"
#include "tiles/city/generator.h"

namespace citystream::bench {
namespace {

namespace city = tiles::city;
namespace mesh = codec::mesh;
using mesh::Direction;

using Through = std::function<Direction(const Direction&)>;  ///< to a code and back

double dot(const Direction& a, const Direction& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Direction through_floats(const Direction& n) {
    const volatile float x = static_cast<float>(n[0]), y = static_cast<float>(n[1]), z = static_cast<float>(n[2]);
    return {x, y, z};
}

/// 11 significant bits; the exponents of unit vectors that matter are those of half floats.
double half_float(double value) {
    int exponent = 0;
    const double mantissa = std::frexp(value, &exponent);
    return std::ldexp(std::nearbyint(std::ldexp(mantissa, 11)), exponent - 11);
}

Through through_octahedron(uint32_t bits) {
    return [bits](const Direction& n) {
        const std::array<float, 3> unit = mesh::unpack_octahedral_float(mesh::pack_octahedral(n, bits), bits);
        return Direction{unit[0], unit[1], unit[2]};
    };
}

constexpr uint32_t kSheetSide = 512;

/// Intensities 0..1 of the sheet.
std::vector<double> shaded_sheet(const Through& through) {
    const Direction middle = mesh::unit_direction({1, 1, 1}), right = mesh::unit_direction({1, -1, 0}),
                    up = mesh::unit_direction({1, 1, -2});
    const Direction light = mesh::unit_direction({1.2, 0.9, 1}), half = mesh::unit_direction({1.05, 1, 0.95});
    constexpr double kBend = 0.25, kShininess = 200;
    std::vector<double> image;
    for (uint32_t y = 0; y < kSheetSide; ++y) {
        for (uint32_t x = 0; x < kSheetSide; ++x) {
            const double a = kBend * ((x + 0.5) / kSheetSide * 2 - 1), b = kBend * ((y + 0.5) / kSheetSide * 2 - 1);
            Direction n;
            for (size_t c = 0; c < 3; ++c) n[c] = middle[c] + a * right[c] + b * up[c];
            n = through(mesh::unit_direction(n));
            const double diffuse = std::max(0.0, dot(n, light)),
                         specular = std::pow(std::max(0.0, dot(n, half)), kShininess);
            image.push_back(std::clamp(0.1 + 0.4 * diffuse + 0.5 * specular, 0.0, 1.0));
        }
    }
    return image;
}

uint32_t differing(const std::vector<double>& a, const std::vector<double>& b, uint32_t bits) {
    const double steps = std::exp2(bits) - 1;
    uint32_t count = 0;
    for (size_t i = 0; i < a.size(); ++i) count += std::round(a[i] * steps) != std::round(b[i] * steps) ? 1 : 0;
    return count;
}

double psnr_of(const std::vector<double>& a, const std::vector<double>& b) {
    double squares = 0;
    for (size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
    return 10 * std::log10(static_cast<double>(a.size()) / squares);
}

/// A component -1..1 in a signed byte, on an odd lattice as the other texels.
double signed_byte(double value) {
    return std::round(value * 127) / 127;
}

std::vector<Direction> half_sphere(bool gentle) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> gauss;
    std::vector<Direction> directions;
    for (int i = 0; i < 400'000; ++i) {
        const double x = gauss(random), y = gauss(random), z = gauss(random);
        directions.push_back(
            mesh::unit_direction(gentle ? Direction{0.3 * x, 0.3 * y, 1} : Direction{x, y, std::abs(z)}));
    }
    return directions;
}

void add_triangles(const city::CityObject& object, std::vector<Face>& faces) {
    for (const city::Triangle& triangle : object.triangles) {
        const city::Vec3 &a = object.vertices[triangle.vertex[0]], &b = object.vertices[triangle.vertex[1]],
                         &c = object.vertices[triangle.vertex[2]];
        const Direction e = {b.x - a.x, b.y - a.y, b.z - a.z}, f = {c.x - a.x, c.y - a.y, c.z - a.z};
        const Direction n = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]};
        const double twice = std::sqrt(dot(n, n));
        if (twice > 0) faces.push_back({mesh::unit_direction(n), twice / 2});
    }
}

void add_walls(const city::CityObject& object, std::vector<Face>& faces) {
    for (const city::FacadeWall& wall : object.facades) {
        faces.push_back({mesh::unit_direction({wall.along.y, -wall.along.x, 0}),
                         std::hypot(wall.along.x, wall.along.y) * wall.height});
    }
}

}  // namespace

std::vector<double> distances_to_fibonacci(const std::vector<Direction>& directions, uint32_t count) {
    constexpr double kGolden = std::numbers::phi - 1;
    std::vector<Direction> points;  // from the top down: point i at height 1 - (2i + 1) / count
    for (uint32_t i = 0; i < count; ++i) {
        const double z = 1 - (2.0 * i + 1) / count, across = std::sqrt(1 - z * z), turns = i * kGolden;
        const double longitude = 2 * std::numbers::pi * (turns - std::floor(turns));
        points.push_back({across * std::cos(longitude), across * std::sin(longitude), z});
    }
    // No direction is farther from a point than one and a half mean distances of neighbours.
    const double reach = 1.5 * std::sqrt(4 * std::numbers::pi / count);
    const auto index_at = [&](double z) {
        return static_cast<size_t>(std::clamp((1 - z) * count / 2, 0.0, count - 1.0));
    };
    std::vector<double> distances;
    for (const Direction& n : directions) {
        size_t nearest = index_at(n[2] + reach);
        const size_t last = index_at(n[2] - reach);
        for (size_t i = nearest; i <= last; ++i) {
            if (dot(points[i], n) > dot(points[nearest], n)) nearest = i;
        }
        distances.push_back(mesh::angle_between(points[nearest], n));
    }
    return distances;
}

std::vector<HighlightError> highlight_errors() {
    const std::vector<double> reference = shaded_sheet(through_floats);
    const auto compare = [&](const std::string& format, uint32_t bits, const Through& through) {
        const std::vector<double> image = shaded_sheet(through);
        return HighlightError{format,
                              bits,
                              static_cast<uint32_t>(image.size()),
                              differing(reference, image, 8),
                              differing(reference, image, 13),
                              psnr_of(reference, image)};
    };
    std::vector<HighlightError> errors = {compare("three half floats", 48, [](const Direction& n) {
        return mesh::unit_direction({half_float(n[0]), half_float(n[1]), half_float(n[2])});
    })};
    for (const uint32_t bits : {8U, 10U, 12U, 16U, 24U})
        errors.push_back(compare("octahedron", 2 * bits, through_octahedron(bits)));
    return errors;
}

std::vector<TexelError> texel_errors(bool gentle) {
    const std::vector<Direction> directions = half_sphere(gentle);
    const auto measure = [&](const std::string& texel, uint32_t bytes, const Through& through) {
        TexelError error{texel, bytes, 0, 0, through({0, 0, 1}) == Direction{0, 0, 1}};
        for (const Direction& n : directions) {
            const double angle = mesh::angle_between(through(n), n);
            error.largest = std::max(error.largest, angle);
            error.mean += angle / static_cast<double>(directions.size());
        }
        return error;
    };
    return {measure("half octahedron, 8 + 8", 2,
                    [](const Direction& n) { return mesh::unpack_hemisphere(mesh::pack_hemisphere(n, 8), 8); }),
            measure("octahedron, 8 + 8", 2,
                    [](const Direction& n) { return mesh::unpack_octahedral(mesh::pack_octahedral(n, 8), 8); }),
            measure("x and y, 8 + 8", 2,
                    [](const Direction& n) {
                        const double x = signed_byte(n[0]), y = signed_byte(n[1]);
                        return mesh::unit_direction({x, y, std::sqrt(std::max(0.0, 1 - x * x - y * y))});
                    }),
            measure("x, y and z, 8 + 8 + 8", 3,
                    [](const Direction& n) {
                        return mesh::unit_direction({signed_byte(n[0]), signed_byte(n[1]), signed_byte(n[2])});
                    }),
            measure("half octahedron, 16 + 16", 4,
                    [](const Direction& n) { return mesh::unpack_hemisphere(mesh::pack_hemisphere(n, 16), 16); })};
}

std::vector<Face> faces_generated(uint32_t buildings, uint64_t seed) {
    city::GeneratorOptions options;
    options.buildings = buildings;
    options.seed = seed;
    city::CityHeader header;
    city::CityCatalog catalog;
    city::CityReport report;
    std::vector<Face> faces;
    city::generate_city(options, header, catalog, report, [&](city::CityObject&& object) {
        add_triangles(object, faces);
        add_walls(object, faces);
        return true;
    });
    return faces;
}

Result<std::vector<Face>> faces_of_file(const std::string& file) {
    city::CityHeader header;
    city::CityCatalog catalog;
    city::CityReport report;
    std::vector<Face> faces;
    const Status read = city::read_city({file}, {}, header, catalog, report, [&](city::CityObject&& object) {
        add_triangles(object, faces);
        return true;
    });
    if (!read) return read.error();
    return faces;
}

}  // namespace citystream::bench
