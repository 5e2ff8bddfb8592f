#include "client/light/spherical_harmonics.h"

#include <cassert>
#include <cmath>
#include <numbers>

namespace citystream::client {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::array<double, kMostBands> kCosineLobe = {kPi, 2 * kPi / 3, kPi / 4, 0, -kPi / 24};
/// Small maps are sampled as if they had at least so many rows: the sums are integrals over texels.
constexpr uint32_t kLeastRows = 128;

constexpr uint32_t number_of(uint32_t band, int order) {
    return static_cast<uint32_t>(static_cast<int>(band * (band + 1)) + order);
}

/// (l - m)! / (l + m)!
double factorial_ratio(uint32_t band, uint32_t order) {
    double ratio = 1;
    for (uint32_t i = band - order + 1; i <= band + order; ++i) ratio /= i;
    return ratio;
}

/// sqrt((2l + 1) / (4 pi) (l - m)! / (l + m)!)
std::array<double, kHarmonics> make_norms() {
    std::array<double, kHarmonics> norms{};
    for (uint32_t band = 0; band < kMostBands; ++band) {
        for (uint32_t order = 0; order <= band; ++order) {
            const double norm = std::sqrt((2 * band + 1) / (4 * kPi) * factorial_ratio(band, order));
            norms[number_of(band, static_cast<int>(order))] = norms[number_of(band, -static_cast<int>(order))] =
                order == 0 ? norm : std::numbers::sqrt2 * norm;
        }
    }
    return norms;
}

/// Legendre functions divided by sin^m, which the caller's (x + iy)^m brings back: no division at the poles.
std::array<double, kHarmonics> legendre(double z) {
    std::array<double, kHarmonics> p{};
    double diagonal = 1;
    for (uint32_t m = 0; m < kMostBands; ++m) {
        const auto order = static_cast<int>(m);
        p[number_of(m, order)] = diagonal;
        if (m + 1 < kMostBands) p[number_of(m + 1, order)] = z * (2 * m + 1) * diagonal;
        for (uint32_t l = m + 2; l < kMostBands; ++l) {
            p[number_of(l, order)] =
                (z * (2 * l - 1) * p[number_of(l - 1, order)] - (l + m - 1) * p[number_of(l - 2, order)]) / (l - m);
        }
        diagonal *= 2 * m + 1;
    }
    return p;
}

void add(HarmonicLight& light, const Direction& direction, const LightSum& amount) {
    const auto basis = harmonics_at(direction);
    for (uint32_t i = 0; i < kHarmonics; ++i) {
        for (size_t c = 0; c < 3; ++c) light.coefficients[i][c] += basis[i] * amount[c];
    }
}

}  // namespace

std::array<double, kHarmonics> harmonics_at(const Direction& direction) {
    static const std::array<double, kHarmonics> kNorms = make_norms();
    const auto p = legendre(direction[2]);
    std::array<double, kHarmonics> result{};
    double cosine = 1, sine = 0;  // of m a, times sin^m of the angle from the zenith
    for (int m = 0; m < static_cast<int>(kMostBands); ++m) {
        for (auto band = static_cast<uint32_t>(m); band < kMostBands; ++band) {
            const double value = kNorms[number_of(band, m)] * p[number_of(band, m)];
            result[number_of(band, m)] = value * cosine;
            if (m > 0) result[number_of(band, -m)] = value * sine;
        }
        const double next = cosine * direction[0] - sine * direction[1];
        sine = cosine * direction[1] + sine * direction[0];
        cosine = next;
    }
    return result;
}

LightSum HarmonicLight::radiance(const Direction& from, uint32_t bands) const {
    assert(bands <= kMostBands);
    const auto basis = harmonics_at(from);
    LightSum sum{};
    for (uint32_t i = 0; i < bands * bands; ++i) {
        for (size_t c = 0; c < 3; ++c) sum[c] += basis[i] * coefficients[i][c];
    }
    return sum;
}

LightSum HarmonicLight::irradiance(const Direction& normal, uint32_t bands) const {
    assert(bands <= kMostBands);
    const auto basis = harmonics_at(normal);
    LightSum sum{};
    for (uint32_t band = 0; band < bands; ++band) {
        for (uint32_t i = band * band; i < (band + 1) * (band + 1); ++i) {
            for (size_t c = 0; c < 3; ++c) sum[c] += kCosineLobe[band] * basis[i] * coefficients[i][c];
        }
    }
    return sum;
}

HarmonicLight HarmonicLight::turned(double yaw) const {
    HarmonicLight result = *this;
    for (uint32_t band = 1; band < kMostBands; ++band) {
        for (int m = 1; m <= static_cast<int>(band); ++m) {
            const double c = std::cos(m * yaw), s = std::sin(m * yaw);
            const LightSum& even = coefficients[number_of(band, m)];
            const LightSum& odd = coefficients[number_of(band, -m)];
            for (size_t i = 0; i < 3; ++i) {
                result.coefficients[number_of(band, m)][i] = c * even[i] + s * odd[i];
                result.coefficients[number_of(band, -m)][i] = c * odd[i] - s * even[i];
            }
        }
    }
    return result;
}

HarmonicLight harmonic_light(const EnvironmentMap& map) {
    const uint32_t parts = (kLeastRows + map.height - 1) / map.height;
    HarmonicLight light;
    for (uint32_t row = 0; row < map.height * parts; ++row) {
        const double solid_angle = map_solid_angle(map.width * parts, map.height * parts, row);
        for (uint32_t column = 0; column < map.width * parts; ++column) {
            const Rgb& texel = map.texels[size_t{row / parts} * map.width + column / parts];
            add(light, map_direction(map.width * parts, map.height * parts, column + 0.5, row + 0.5),
                {solid_angle * texel[0], solid_angle * texel[1], solid_angle * texel[2]});
        }
    }
    return light;
}

void add_parallel_light(HarmonicLight& light, const Direction& direction, const LightSum& irradiance) {
    add(light, direction, irradiance);
}

}  // namespace citystream::client
