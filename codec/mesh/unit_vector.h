// Unit vectors in any number of bits by any of the seven parameterisations, with domain or range quantisation (Meyer
// 2012, section 4.7; notes N4, N5). octahedral.h is the one that layers use; this is what it is compared with, and
// where an odd budget asks for another method.
//
// A code is u, v and a chart. u and v are uniformly quantised over the range of the parameterisation (Equation 2.5; the
// rounding of Equation 2.6 as corrected: floor(x + 1/2), clamped). kEven, as in the thesis, has 2^n lattice points a
// parameter; kOdd has 2^n - 1, so that the middle of the range is one of them, which makes the axes exact (of SPP, CP,
// WCP, OP and WOP; of PP but for rounding, too).
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "codec/mesh/unit_vector_projection.h"

namespace citystream::codec::mesh {

enum class Quantisation : uint8_t {
    kDomain,  ///< each parameter to the nearest lattice value (section 4.7.1)
    kRange    ///< the nearest of the four enclosing lattice points (section 4.7.2): about five times the work
};
enum class UnitVectorLattice : uint8_t { kEven, kOdd };

struct UnitVectorFormat {
    UnitVectorMethod method = UnitVectorMethod::kOctahedron;
    uint32_t bits = 8;  ///< a parameter: 1..32, 2..32 of odd lattices
    UnitVectorLattice lattice = UnitVectorLattice::kEven;
};

/// Bits of a code, chart included.
uint32_t total_bits(const UnitVectorFormat& format);

/// The finest format of at most `budget` bits a vector: OP leaves a bit of an odd budget unused, the others one of an
/// even budget. Nothing where the budget is too small; never more than 32 bits a parameter.
std::optional<UnitVectorFormat> format_of_budget(UnitVectorMethod method, uint32_t budget,
                                                 UnitVectorLattice lattice = UnitVectorLattice::kEven);

/// The largest value of a parameter: 2^n - 1, or 2^n - 2 of odd lattices.
uint32_t last_lattice_value(const UnitVectorFormat& format);

struct UnitVectorCode {
    uint32_t u = 0, v = 0, chart = 0;
    bool operator==(const UnitVectorCode&) const = default;
};

/// Codes a vector of any length; zero and non-finite ones are +z. Real is float or double: what is reckoned in.
template <typename Real>
UnitVectorCode encode_unit_vector(const std::array<Real, 3>& n, const UnitVectorFormat& format,
                                  Quantisation quantisation);

/// The direction of a code, of a length near 1; values and charts that are not written read as the last ones.
template <typename Real>
std::array<Real, 3> decode_direction(const UnitVectorCode& code, const UnitVectorFormat& format);

/// The same, of length 1.
template <typename Real>
std::array<Real, 3> decode_unit_vector(const UnitVectorCode& code, const UnitVectorFormat& format);

/// A code as one number: u, then v, then the chart from bit 0 on, total_bits(format) <= 64 in all.
uint64_t join_code(const UnitVectorCode& code, const UnitVectorFormat& format);
UnitVectorCode split_code(uint64_t joined, const UnitVectorFormat& format);

}  // namespace citystream::codec::mesh
