#include "codec/mesh/unit_vector_theory.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace citystream::codec::mesh {

namespace {

constexpr double kPi = std::numbers::pi, kRoot2 = std::numbers::sqrt2, kRoot3 = std::numbers::sqrt3;
const double kRoot6 = std::sqrt(6.0);

struct MethodTheory {
    double domain, range;  ///< error / step; of PP error / sqrt(step)
    Projected<double> worst_domain, worst_range;
};

const MethodTheory& theory_of(UnitVectorMethod method) {
    // Tables 4.3 and 4.4, in the order of UnitVectorMethod.
    static const MethodTheory kTheory[] = {{std::sqrt(kRoot2), 1, {kRoot2 / 2, kRoot2 / 2, 0}, {1, 0, 0}},
                                           {kRoot6 / 2, kRoot3 / 2, {kRoot3 / 3, kRoot3 / 3, 0}, {kRoot2 / 2, 0, 0}},
                                           {kRoot2 / 2, kRoot2 / 2, {0, 0, 0}, {0, 0, 0}},
                                           {kRoot6 / 12 * kPi, kRoot2 / 8 * kPi, {1, 1, 0}, {0, 0, 0}},
                                           {3 * kRoot2 / 2, kRoot2, {1.0 / 3, 1.0 / 3, 0}, {1.0 / 3, 1.0 / 3, 0}},
                                           {kRoot6 / 2, kRoot6 / 2, {0, 2.0 / 3, 0}, {0, 2.0 / 3, 0}},
                                           {kRoot2 / 2, kRoot2 / 2, {kPi / 2, kPi / 4, 0}, {kPi / 2, kPi / 4, 0}}};
    return kTheory[static_cast<size_t>(method)];
}

Direction cross(const Direction& a, const Direction& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Direction minus(const Direction& a, const Direction& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Direction direction_at(UnitVectorMethod method, const Projected<double>& place, double du, double dv) {
    return unproject<double>(method, {place.u + du, place.v + dv, place.chart});
}

/// Angle between m0 and the point that is as far from all three; a cross product may give its antipode.
double circumradius(const Direction& m0, const Direction& m1, const Direction& m2) {
    const double angle = angle_between(m0, cross(minus(m2, m0), minus(m1, m0)));
    return std::min(angle, kPi - angle);
}

}  // namespace

double lambert_error(uint32_t colour_bits) {
    return 2 * std::asin(std::exp2(-static_cast<double>(colour_bits) - 1));
}

// Both directions of Fejes Toth's bound go by a = w + pi/6, the angle N/(N-2) * pi/6, whose excess d = pi / (3(N-2))
// over pi/6 is tiny: 2 cos(2t) + 1 = 3 - 4 sin(t)^2 = cot(a)^2.
double optimal_error(double count) {
    const double excess = std::tan(kPi / (3 * (count - 2)));
    const double denominator = 1 / kRoot3 + excess;
    const double cotangent = (1 - excess / kRoot3) / denominator;
    const double short_of_root3 = 4 / kRoot3 * excess / denominator;
    return std::asin(std::sqrt(short_of_root3 * (kRoot3 + cotangent)) / 2);
}

double optimal_count(double error) {
    const double square = 4 * std::sin(error) * std::sin(error);
    const double root = std::sqrt(3 - square);  // cot(w)
    const double tangent = 1 / root;
    const double excess = std::atan(square / ((kRoot3 + root) * kRoot3 * root) / (1 + tangent / kRoot3));
    return 12 * (kPi / 6 + excess) / (6 * excess);
}

double covering_count(double error) {
    return 8 * kPi / (3 * kRoot3 * error * error);
}

double float_vector_error(uint32_t mantissa) {
    const double e = std::exp2(-1.0 - mantissa);
    return std::asin(std::sqrt(8 * e * e / (9 + 12 * e + 12 * e * e)));
}

double float_direction_error(uint32_t mantissa) {
    return std::exp2(-1.0 - mantissa);
}

double float_unit_vector_error(uint32_t mantissa) {
    return (2 + kRoot2) / 4 * std::exp2(-1.0 - mantissa);
}

double lattice_step(const UnitVectorFormat& format) {
    return 2 * parameter_range(format.method).half / last_lattice_value(format);
}

double nominal_step(UnitVectorMethod method, double b) {
    return 2 * parameter_range(method).half * std::exp2((chart_bits(method) - b) / 2);
}

double largest_error(UnitVectorMethod method, Quantisation quantisation, double step) {
    const MethodTheory& theory = theory_of(method);
    const double factor = quantisation == Quantisation::kDomain ? theory.domain : theory.range;
    return factor * (method == UnitVectorMethod::kParallel ? std::sqrt(step) : step);
}

double compactness(UnitVectorMethod method, Quantisation quantisation, double b) {
    return largest_error(method, quantisation, nominal_step(method, b)) * std::exp2(b / 2);
}

Projected<double> worst_place(UnitVectorMethod method, Quantisation quantisation) {
    const MethodTheory& theory = theory_of(method);
    return quantisation == Quantisation::kDomain ? theory.worst_domain : theory.worst_range;
}

Direction worst_direction(UnitVectorMethod method, Quantisation quantisation) {
    return unit_direction(unproject(method, worst_place(method, quantisation)));
}

std::optional<double> surplus_bits(UnitVectorMethod method, Quantisation quantisation) {
    if (method == UnitVectorMethod::kParallel) return {};
    const double c = compactness(method, quantisation, 0);
    return std::log2(c * c * kRoot3 / (2 * kPi));
}

std::optional<double> surplus_bits_over_covering(UnitVectorMethod method, Quantisation quantisation) {
    if (method == UnitVectorMethod::kParallel) return {};
    const double c = compactness(method, quantisation, 0);
    return std::log2(c * c * 3 * kRoot3 / (8 * kPi));
}

uint32_t bits_to_match(UnitVectorMethod method, Quantisation quantisation, double error) {
    uint32_t b = chart_bits(method) + 2;
    while (largest_error(method, quantisation, nominal_step(method, b)) > error) b += 2;
    return b;
}

double domain_error_at(UnitVectorMethod method, const Projected<double>& middle, double step) {
    const Direction centre = direction_at(method, middle, 0, 0);
    double largest = 0;
    for (const double du : {-step / 2, step / 2}) {
        for (const double dv : {-step / 2, step / 2})
            largest = std::max(largest, angle_between(centre, direction_at(method, middle, du, dv)));
    }
    return largest;
}

double range_error_at(UnitVectorMethod method, const Projected<double>& corner, double step) {
    const auto m = [&](double du, double dv) { return unit_direction(direction_at(method, corner, du, dv)); };
    const Direction m0 = m(0, 0), m1 = m(step, 0), m2 = m(step, step), m3 = m(0, step);
    return std::min(circumradius(m0, m1, m2), circumradius(m0, m3, m1));
}

}  // namespace citystream::codec::mesh
