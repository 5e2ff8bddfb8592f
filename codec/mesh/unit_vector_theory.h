// What unit vectors of so many bits can and must be worth (Meyer 2012, sections 4.3, 4.4, 4.7.3-4.8.8; notes N1-N3,
// N6-N8, with the errata of Tables 4.1 and 4.2 and of section 4.4.3): bounds, the error of the seven parameterisations,
// and how many bits they waste. Angles are radians, b is bits a unit vector, charts included. Pure functions of
// doubles, O(1); where a printed formula subtracts nearly equal numbers it is rewritten, so that results are good to
// 10^-12 of themselves down to angles of 10^-16.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "codec/mesh/direction.h"
#include "codec/mesh/unit_vector.h"

namespace citystream::codec::mesh {

/// The largest error of a normal that stays below one step of a colour of `colour_bits` bits under Lambert's law:
/// 2 asin(2^-(d+1)) (Equation 4.3).
double lambert_error(uint32_t colour_bits);

/// Half of the largest smallest distance of `count` >= 3 points on the sphere, by Fejes Toth's bound (Equation 4.5): no
/// set of that many unit vectors has a smaller error.
double optimal_error(double count);
/// Its inverse (Equation 4.6): how many unit vectors an error takes at least, 0 < error <= pi/3.
double optimal_count(double error);
/// The same by the hexagonal covering of the plane, a stricter bound for small errors: every direction must lie within
/// `error` of a point, not only all points apart. log2(4/3) = 0.415 bits more in the limit.
double covering_count(double error);

/// Largest error of unit vectors stored as three floats with `mantissa` bits (Equation 4.10, with the square root over
/// epsilon's square only): 4.60e-4, 5.62e-8, 1.05e-16 of half (10), single (23), double (52).
double float_vector_error(uint32_t mantissa);
/// Least upper bounds by direction: of any vector rounded to floats, and of normalised ones (errata of Figure 4.6).
double float_direction_error(uint32_t mantissa);
double float_unit_vector_error(uint32_t mantissa);

/// Distance of neighbouring values of a parameter, exactly, and as 2^b values would have it (Equation 4.15).
double lattice_step(const UnitVectorFormat& format);
double nominal_step(UnitVectorMethod method, double b);

/// Largest error for a step e, of first order in e (Table 4.4).
double largest_error(UnitVectorMethod method, Quantisation quantisation, double step);
/// C with error = C 2^(-b/2) (Equation 4.16). That of PP grows with b.
double compactness(UnitVectorMethod method, Quantisation quantisation, double b);
/// Directions where the error is largest (Table 4.3), with one sign and order of components each.
Direction worst_direction(UnitVectorMethod method, Quantisation quantisation);
/// The same as a place of chart 0.
Projected<double> worst_place(UnitVectorMethod method, Quantisation quantisation);

/// Bits more than an optimal set of the same error takes (Table 4.10), against Fejes Toth's bound and against the
/// covering's. Nothing for PP, whose waste grows with b.
std::optional<double> surplus_bits(UnitVectorMethod method, Quantisation quantisation);
std::optional<double> surplus_bits_over_covering(UnitVectorMethod method, Quantisation quantisation);

/// The least budget that the parameterisation fills (b - charts' bits even) and that keeps the error (Table 4.8).
uint32_t bits_to_match(UnitVectorMethod method, Quantisation quantisation, double error);

/// The largest error in the cell of the lattice with its middle at a place (Equation 4.13) ...
double domain_error_at(UnitVectorMethod method, const Projected<double>& middle, double step);
/// ... and with its lower corner at a place (Equation 4.14): the smaller of the distances to two circumcentres, which
/// is the farthest point of the cell where both triangles are acute.
double range_error_at(UnitVectorMethod method, const Projected<double>& corner, double step);

}  // namespace citystream::codec::mesh
