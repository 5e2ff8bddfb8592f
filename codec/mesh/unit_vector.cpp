#include "codec/mesh/unit_vector.h"

#include <algorithm>
#include <cmath>

#include "codec/mesh/direction.h"
#include "codec/mesh/lattice_cell.h"

namespace citystream::codec::mesh {

namespace {

template <typename Real>
using Vector = std::array<Real, 3>;

constexpr uint32_t kMostBits = 32;

template <typename Real>
Vector<Real> normalised(const Vector<Real>& n) {
    const Real length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    return {n[0] / length, n[1] / length, n[2] / length};
}

/// Where a parameter lies on the lattice, 0..last.
template <typename Real>
Real lattice_place(Real parameter, const ParameterRange& range, Real last) {
    const Real centred = (parameter - static_cast<Real>(range.middle)) / static_cast<Real>(range.half);
    return (centred + 1) * last / 2;
}

/// Counted from the middle of the lattice, so that zero is zero (Equation 2.7 in other words).
template <typename Real>
Real parameter_at(uint32_t value, const ParameterRange& range, uint32_t last) {
    const auto centred = static_cast<Real>(2 * int64_t{std::min(value, last)} - int64_t{last});
    return static_cast<Real>(range.middle) + static_cast<Real>(range.half) * (centred / static_cast<Real>(last));
}

template <typename Real>
uint32_t rounded(Real place, uint32_t last) {
    // Clamped as an integer: `last` may be no float.
    return static_cast<uint32_t>(std::clamp<int64_t>(static_cast<int64_t>(std::floor(place + Real(0.5))), 0, last));
}

template <typename Real>
UnitVectorCode nearest_code(const Vector<Real>& n, const Projected<Real>& place, Real u, Real v,
                            const UnitVectorFormat& format) {
    const Vector<Real> unit = normalised(n);
    const auto code_of = [&](LatticePoint point) {
        return UnitVectorCode{static_cast<uint32_t>(point.u), static_cast<uint32_t>(point.v), place.chart};
    };
    const auto squared_chord = [&](LatticePoint point) {
        const Vector<Real> m = decode_unit_vector<Real>(code_of(point), format);
        Real sum = 0;
        for (size_t i = 0; i < 3; ++i) sum += (m[i] - unit[i]) * (m[i] - unit[i]);
        return sum;
    };
    const LatticePoint low = {static_cast<int64_t>(std::floor(u)), static_cast<int64_t>(std::floor(v))};
    return code_of(nearest_of_cell(low, 0, last_lattice_value(format), squared_chord));
}

}  // namespace

uint32_t total_bits(const UnitVectorFormat& format) {
    return 2 * format.bits + chart_bits(format.method);
}

std::optional<UnitVectorFormat> format_of_budget(UnitVectorMethod method, uint32_t budget, UnitVectorLattice lattice) {
    const uint32_t least = lattice == UnitVectorLattice::kEven ? 1 : 2;
    if (budget < 2 * least + chart_bits(method)) return {};
    return UnitVectorFormat{method, std::min((budget - chart_bits(method)) / 2, kMostBits), lattice};
}

uint32_t last_lattice_value(const UnitVectorFormat& format) {
    const uint32_t last = ~uint32_t{0} >> (kMostBits - format.bits);
    return format.lattice == UnitVectorLattice::kEven ? last : last - 1;
}

template <typename Real>
UnitVectorCode encode_unit_vector(const Vector<Real>& vector, const UnitVectorFormat& format,
                                  Quantisation quantisation) {
    const Vector<Real> n = scaled_direction(vector);
    const Projected<Real> place = project(format.method, n);
    const ParameterRange range = parameter_range(format.method);
    const uint32_t last = last_lattice_value(format);
    const Real u = lattice_place(place.u, range, static_cast<Real>(last));
    const Real v = lattice_place(place.v, range, static_cast<Real>(last));
    if (quantisation == Quantisation::kRange) return nearest_code(n, place, u, v, format);
    return {rounded(u, last), rounded(v, last), place.chart};
}

template <typename Real>
Vector<Real> decode_direction(const UnitVectorCode& code, const UnitVectorFormat& format) {
    const ParameterRange range = parameter_range(format.method);
    const uint32_t last = last_lattice_value(format);
    return unproject<Real>(format.method,
                           {parameter_at<Real>(code.u, range, last), parameter_at<Real>(code.v, range, last),
                            std::min(code.chart, chart_count(format.method) - 1)});
}

template <typename Real>
Vector<Real> decode_unit_vector(const UnitVectorCode& code, const UnitVectorFormat& format) {
    const Vector<Real> direction = decode_direction<Real>(code, format);
    return is_unit(format.method) ? direction : normalised(direction);
}

uint64_t join_code(const UnitVectorCode& code, const UnitVectorFormat& format) {
    uint64_t joined = code.u | uint64_t{code.v} << format.bits;
    // A chart of 32 + 32 bits has no bits, and none to be shifted by 64.
    if (chart_bits(format.method) != 0) joined |= uint64_t{code.chart} << 2 * format.bits;
    return joined;
}

UnitVectorCode split_code(uint64_t joined, const UnitVectorFormat& format) {
    const uint64_t mask = (uint64_t{1} << format.bits) - 1;
    const uint64_t charts = (uint64_t{1} << chart_bits(format.method)) - 1;
    return {static_cast<uint32_t>(joined & mask), static_cast<uint32_t>(joined >> format.bits & mask),
            charts == 0 ? 0 : static_cast<uint32_t>(joined >> 2 * format.bits & charts)};
}

template UnitVectorCode encode_unit_vector(const Vector<float>&, const UnitVectorFormat&, Quantisation);
template UnitVectorCode encode_unit_vector(const Vector<double>&, const UnitVectorFormat&, Quantisation);
template Vector<float> decode_direction(const UnitVectorCode&, const UnitVectorFormat&);
template Vector<double> decode_direction(const UnitVectorCode&, const UnitVectorFormat&);
template Vector<float> decode_unit_vector(const UnitVectorCode&, const UnitVectorFormat&);
template Vector<double> decode_unit_vector(const UnitVectorCode&, const UnitVectorFormat&);

}  // namespace citystream::codec::mesh
