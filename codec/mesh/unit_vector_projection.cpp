#include "codec/mesh/unit_vector_projection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace citystream::codec::mesh {

namespace {

template <typename Real>
using Vector = std::array<Real, 3>;

struct MethodFacts {
    const char* name;
    uint32_t charts, chart_bits;
    double middle, half;
    bool unit;
};
constexpr double kPi = std::numbers::pi, kHalfRoot2 = std::numbers::sqrt2 / 2;
constexpr MethodFacts kFacts[] = {{"PP", 2, 1, 0, 1, true},
                                  {"SPP", 6, 3, 0, kHalfRoot2, true},
                                  {"CP", 6, 3, 0, 1, false},
                                  {"WCP", 6, 3, 0, 1, false},
                                  {"OP", 1, 0, 0, 1, false},
                                  {"WOP", 2, 1, 0, 1, false},
                                  {"SCP", 2, 1, kPi / 2, kPi / 2, true}};
static_assert(std::size(kFacts) == kUnitVectorMethods.size());

const MethodFacts& facts_of(UnitVectorMethod method) {
    return kFacts[static_cast<size_t>(method)];
}

template <typename Real>
Real sign_of(Real value) {
    return value < 0 ? Real(-1) : Real(1);
}

template <typename Real>
Real l1_norm(const Vector<Real>& n) {
    return std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
}

template <typename Real>
Real l2_norm(const Vector<Real>& n) {
    return std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

/// Axes in the order of the charts of SPP, CP and WCP: z, x, y. Chart 2k is +, 2k + 1 is - along axis k, its parameters
/// are the two axes behind that one, cyclically.
constexpr size_t kAxisOfSide[3] = {2, 0, 1};

template <typename Real>
uint32_t side_of(const Vector<Real>& n) {
    size_t side = 0;
    for (size_t k = 1; k < 3; ++k) {
        if (std::abs(n[kAxisOfSide[k]]) > std::abs(n[kAxisOfSide[side]])) side = k;
    }
    return static_cast<uint32_t>(2 * side + (n[kAxisOfSide[side]] < 0 ? 1 : 0));
}

/// The two parameters of a side, divided by `norm`.
template <typename Real>
Projected<Real> project_side(const Vector<Real>& n, uint32_t side, Real norm) {
    const size_t axis = kAxisOfSide[side / 2];
    return {n[(axis + 1) % 3] / norm, n[(axis + 2) % 3] / norm, side};
}

template <typename Real>
Vector<Real> unproject_side(const Projected<Real>& place, Real across) {
    const size_t axis = kAxisOfSide[place.chart / 2];
    Vector<Real> n;
    n[axis] = place.chart % 2 == 0 ? across : -across;
    n[(axis + 1) % 3] = place.u;
    n[(axis + 2) % 3] = place.v;
    return n;
}

template <typename Real>
Projected<Real> project_cube(const Vector<Real>& n) {
    const uint32_t side = side_of(n);
    return project_side(n, side, std::abs(n[kAxisOfSide[side / 2]]));
}

template <typename Real>
Projected<Real> project_octahedron(const Vector<Real>& n) {
    const Real norm = l1_norm(n);
    const Real u = n[0] / norm, v = n[1] / norm;
    if (n[2] >= 0) return {u, v, 0};
    return {sign_of(u) * (1 - std::abs(v)), sign_of(v) * (1 - std::abs(u)), 0};
}

template <typename Real>
Vector<Real> unproject_octahedron(Real u, Real v) {
    const Real z = 1 - std::abs(u) - std::abs(v);
    if (z >= 0) return {u, v, z};
    return {sign_of(u) * (1 - std::abs(v)), sign_of(v) * (1 - std::abs(u)), z};
}

template <typename Real>
Vector<Real> unproject_warped_octahedron(const Projected<Real>& place) {
    const Real x = (place.u + place.v) / 2, y = (place.v - place.u) / 2;
    const Real z = std::max(Real(0), 1 - std::abs(x) - std::abs(y));
    return {x, y, place.chart == 0 ? z : -z};
}

template <typename Real>
Vector<Real> unproject_parallel(const Projected<Real>& place) {
    const Real square = place.u * place.u + place.v * place.v;
    if (square > 1) {
        const Real length = std::sqrt(square);
        return {place.u / length, place.v / length, 0};
    }
    const Real z = std::sqrt(1 - square);
    return {place.u, place.v, place.chart == 0 ? z : -z};
}

/// By arc tangents: the arc cosine of z, as printed, loses half of the digits near the poles.
template <typename Real>
Projected<Real> project_spherical(const Vector<Real>& n) {
    const Real polar = std::atan2(std::sqrt(n[0] * n[0] + n[1] * n[1]), n[2]);
    const Real longitude = std::atan2(n[1], n[0]);
    if (longitude < 0) return {polar, longitude + static_cast<Real>(kPi), 1};
    return {polar, longitude, 0};
}

/// Longitudes of chart 1 are turned by half a turn: signs, instead of adding pi.
template <typename Real>
Vector<Real> unproject_spherical(const Projected<Real>& place) {
    const Real across = place.chart == 0 ? std::sin(place.u) : -std::sin(place.u);
    return {across * std::cos(place.v), across * std::sin(place.v), std::cos(place.u)};
}

}  // namespace

const char* short_name(UnitVectorMethod method) {
    return facts_of(method).name;
}

uint32_t chart_count(UnitVectorMethod method) {
    return facts_of(method).charts;
}

uint32_t chart_bits(UnitVectorMethod method) {
    return facts_of(method).chart_bits;
}

ParameterRange parameter_range(UnitVectorMethod method) {
    return {facts_of(method).middle, facts_of(method).half};
}

bool is_unit(UnitVectorMethod method) {
    return facts_of(method).unit;
}

template <typename Real>
Projected<Real> project(UnitVectorMethod method, const Vector<Real>& n) {
    constexpr Real kWarp = static_cast<Real>(4 / kPi);
    switch (method) {
        case UnitVectorMethod::kParallel: {
            const Real norm = l2_norm(n);
            return {n[0] / norm, n[1] / norm, n[2] < 0 ? 1U : 0U};
        }
        case UnitVectorMethod::kSextant:
            return project_side(n, side_of(n), l2_norm(n));
        case UnitVectorMethod::kCube:
            return project_cube(n);
        case UnitVectorMethod::kWarpedCube: {
            const Projected<Real> place = project_cube(n);
            return {kWarp * std::atan(place.u), kWarp * std::atan(place.v), place.chart};
        }
        case UnitVectorMethod::kOctahedron:
            return project_octahedron(n);
        case UnitVectorMethod::kWarpedOctahedron: {
            const Real norm = l1_norm(n);
            return {(n[0] - n[1]) / norm, (n[0] + n[1]) / norm, n[2] < 0 ? 1U : 0U};
        }
        case UnitVectorMethod::kSpherical:
            break;
    }
    return project_spherical(n);
}

template <typename Real>
Vector<Real> unproject(UnitVectorMethod method, const Projected<Real>& place) {
    constexpr Real kWarp = static_cast<Real>(kPi / 4);
    switch (method) {
        case UnitVectorMethod::kParallel:
            return unproject_parallel(place);
        case UnitVectorMethod::kSextant:
            return unproject_side(place, std::sqrt(std::max(Real(0), 1 - place.u * place.u - place.v * place.v)));
        case UnitVectorMethod::kCube:
            return unproject_side(place, Real(1));
        case UnitVectorMethod::kWarpedCube:
            return unproject_side({std::tan(kWarp * place.u), std::tan(kWarp * place.v), place.chart}, Real(1));
        case UnitVectorMethod::kOctahedron:
            return unproject_octahedron(place.u, place.v);
        case UnitVectorMethod::kWarpedOctahedron:
            return unproject_warped_octahedron(place);
        case UnitVectorMethod::kSpherical:
            break;
    }
    return unproject_spherical(place);
}

template Projected<float> project(UnitVectorMethod, const Vector<float>&);
template Projected<double> project(UnitVectorMethod, const Vector<double>&);
template Vector<float> unproject(UnitVectorMethod, const Projected<float>&);
template Vector<double> unproject(UnitVectorMethod, const Projected<double>&);

}  // namespace citystream::codec::mesh
