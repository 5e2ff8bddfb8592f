// The seven parameterisations of the unit sphere that Meyer 2012 compares (section 4.6; notes N9-N15, with the errata
// of the inverses of SCP, OP and WOP, and of SPP's norm). Each maps a direction to a chart and a place (u, v) in the
// chart's domain, a square, and back. sg(0) = +1 throughout. Both ways are O(1).
//
// Real is float or double. Of the two warped methods by angles (WCP, SCP) the results depend on the platform's
// trigonometric functions in the last bit; all others use exact operations and roots only.
#pragma once

#include <array>
#include <cstdint>

namespace citystream::codec::mesh {

enum class UnitVectorMethod : uint8_t {
    kParallel,          ///< PP: (x, y) of two half spheres
    kSextant,           ///< SPP: the two smaller components of six sides; the corners of the square are not used
    kCube,              ///< CP: six sides of a cube
    kWarpedCube,        ///< WCP: the same by angles
    kOctahedron,        ///< OP: one chart, the lower half folded up
    kWarpedOctahedron,  ///< WOP: upper and lower half, turned by 45 degrees
    kSpherical          ///< SCP: polar angle, half of the longitudes
};
inline constexpr std::array kUnitVectorMethods = {UnitVectorMethod::kParallel,   UnitVectorMethod::kSextant,
                                                  UnitVectorMethod::kCube,       UnitVectorMethod::kWarpedCube,
                                                  UnitVectorMethod::kOctahedron, UnitVectorMethod::kWarpedOctahedron,
                                                  UnitVectorMethod::kSpherical};

/// The thesis's name: "PP", "SPP", ...
const char* short_name(UnitVectorMethod method);

/// S and b_s of Table 4.2: charts, and the bits that tell them apart.
uint32_t chart_count(UnitVectorMethod method);
uint32_t chart_bits(UnitVectorMethod method);

/// u and v of every chart are middle - half .. middle + half.
struct ParameterRange {
    double middle = 0, half = 1;
};
ParameterRange parameter_range(UnitVectorMethod method);

template <typename Real>
struct Projected {
    Real u = 0, v = 0;
    uint32_t chart = 0;
};

/// Of a vector of any length whose largest component is near 1 (scaled_direction): no squares overflow or vanish.
template <typename Real>
Projected<Real> project(UnitVectorMethod method, const std::array<Real, 3>& n);

/// The direction of a place in the range. PP, SPP and SCP give unit vectors; PP brings places outside its disc back to
/// its rim. The others' lengths are 1/sqrt(3)..sqrt(3): see is_unit.
template <typename Real>
std::array<Real, 3> unproject(UnitVectorMethod method, const Projected<Real>& place);

/// Whether unproject gives unit vectors.
bool is_unit(UnitVectorMethod method);

}  // namespace citystream::codec::mesh
