#include "codec/mesh/unit_vector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "codec/mesh/octahedral.h"
#include "codec/mesh/unit_vector_theory.h"

namespace citystream::codec::mesh {
namespace {

using enum UnitVectorMethod;
using enum Quantisation;
constexpr UnitVectorLattice kBothLattices[] = {UnitVectorLattice::kEven, UnitVectorLattice::kOdd};

double error_of(const Direction& n, const UnitVectorFormat& format, Quantisation quantisation) {
    return angle_between(decode_unit_vector<double>(encode_unit_vector(n, format, quantisation), format), n);
}

/// Half of `count` directions all over the sphere, a quarter each near the two worst directions of a method, of any
/// signs.
class DirectionSource {
  public:
    explicit DirectionSource(UnitVectorMethod method)
        : worst_{worst_direction(method, kDomain), worst_direction(method, kRange)} {}

    Direction next() {
        const Direction shift = {gauss_(random_), gauss_(random_), gauss_(random_)};
        const uint64_t bits = random_();
        if (bits % 2 == 0) return shift;
        Direction n = worst_[bits / 2 % 2];
        for (size_t i = 0; i < 3; ++i) n[i] = (bits >> (8 + i) & 1 ? -n[i] : n[i]) + 0.01 * shift[i];
        return n;
    }

  private:
    std::array<Direction, 2> worst_;
    std::mt19937_64 random_{1};
    std::normal_distribution<double> gauss_;
};

struct Worst {
    double domain = 0, range = 0;
    uint32_t rises = 0;  ///< vectors that range quantisation made worse
};

/// Of unit vectors: angles as small as these by their chords, which takes a quarter of the time of angle_between.
double small_angle(const Direction& m, const Direction& n) {
    double square = 0;
    for (size_t i = 0; i < 3; ++i) square += (m[i] - n[i]) * (m[i] - n[i]);
    return 2 * std::asin(std::sqrt(square) / 2);
}

void measure(const Direction& n, const UnitVectorFormat& format, Worst& worst) {
    const UnitVectorCode rounded = encode_unit_vector(n, format, kDomain);
    const UnitVectorCode nearest = encode_unit_vector(n, format, kRange);
    const double domain = small_angle(decode_unit_vector<double>(rounded, format), n);
    const double range = nearest == rounded ? domain : small_angle(decode_unit_vector<double>(nearest, format), n);
    worst.domain = std::max(worst.domain, domain);
    worst.range = std::max(worst.range, range);
    // Of two that are equally far the rounding of doubles may take either.
    if (range > domain * (1 + 1e-6)) ++worst.rises;
}

constexpr uint32_t kBudgets[] = {16, 24, 32, 48};

/// Of `count` directions, the same at every budget.
std::array<Worst, std::size(kBudgets)> worst_of(UnitVectorMethod method, uint32_t count) {
    DirectionSource source(method);
    std::array<Worst, std::size(kBudgets)> worst;
    for (uint32_t i = 0; i < count; ++i) {
        const Direction n = unit_direction(source.next());
        for (size_t k = 0; k < worst.size(); ++k) measure(n, *format_of_budget(method, kBudgets[k]), worst[k]);
    }
    return worst;
}

void expect_bounds(UnitVectorMethod method) {
    const auto worst = worst_of(method, 1'000'000);
    for (size_t k = 0; k < worst.size(); ++k) {
        const double step = lattice_step(*format_of_budget(method, kBudgets[k]));
        for (const Quantisation quantisation : {kDomain, kRange}) {
            const double bound = largest_error(method, quantisation, step);
            const double seen = quantisation == kDomain ? worst[k].domain : worst[k].range;
            EXPECT_LT(seen, bound * 1.005) << short_name(method) << ' ' << kBudgets[k];
            EXPECT_GT(seen, bound * 0.95) << short_name(method) << ' ' << kBudgets[k];
        }
        EXPECT_EQ(worst[k].rises, 0U) << short_name(method) << ' ' << kBudgets[k];
    }
}

TEST(UnitVector, SextantsKeepTheirBounds) {
    expect_bounds(kSextant);
}
TEST(UnitVector, CubesKeepTheirBounds) {
    expect_bounds(kCube);
}
TEST(UnitVector, WarpedCubesKeepTheirBounds) {
    expect_bounds(kWarpedCube);
}
TEST(UnitVector, OctahedraKeepTheirBounds) {
    expect_bounds(kOctahedron);
}
TEST(UnitVector, WarpedOctahedraKeepTheirBounds) {
    expect_bounds(kWarpedOctahedron);
}
TEST(UnitVector, SphericalCoordinatesKeepTheirBounds) {
    expect_bounds(kSpherical);
}

// Its range error is below the thesis's, which was found by trial: candidates outside the disc are brought to its rim.
TEST(UnitVector, ParallelProjectionErrsBySquareRootsOfTheStep) {
    const auto worst = worst_of(kParallel, 200'000);
    for (size_t k = 0; k < worst.size(); ++k) {
        const double step = lattice_step(*format_of_budget(kParallel, kBudgets[k]));
        EXPECT_LT(worst[k].domain, largest_error(kParallel, kDomain, step) * 1.005) << kBudgets[k];
        EXPECT_LT(worst[k].range, std::sqrt(step / 2) * 1.01) << kBudgets[k];
        EXPECT_EQ(worst[k].rises, 0U) << kBudgets[k];
    }
}

TEST(UnitVector, OctahedraOfSixteenToThirtyTwoBitsKeepTheDegreesOfTheChecks) {
    const auto degrees = [](uint32_t budget) {
        return largest_error(kOctahedron, kRange, lattice_step(*format_of_budget(kOctahedron, budget))) * 180 /
               std::numbers::pi;
    };
    EXPECT_LT(degrees(16), 0.636);
    EXPECT_LT(degrees(24), 0.0397);
    EXPECT_LT(degrees(32), 0.00248);
}

TEST(UnitVector, TheExampleOfSectionFourSeven) {
    const UnitVectorFormat format = {kOctahedron, 4};
    const Direction n = {2.0 / 3, 2.0 / 3, 1.0 / 3};
    const auto degrees = [&](Quantisation quantisation) {
        return error_of(n, format, quantisation) * 180 / std::numbers::pi;
    };
    // u = v = 0.4 lies halfway between lattice values: 15.8 degrees rounded down, 13.7 rounded up.
    const double domain = degrees(kDomain);
    EXPECT_LT(std::min(std::abs(domain - 15.8), std::abs(domain - 13.7)), 0.05) << domain;
    EXPECT_NEAR(degrees(kRange), std::acos(27 / (3 * std::sqrt(83.0))) * 180 / std::numbers::pi, 1e-9) << "about 9";
}

TEST(UnitVector, OctahedronCodesOfSixteenBitsPackToTheDirectionThatTheyStandFor) {
    const UnitVectorFormat format = {kOctahedron, 8};
    for (const Quantisation quantisation : {kDomain, kRange}) {
        for (uint32_t joined = 0; joined < 65536; ++joined) {
            const Direction n = decode_unit_vector<double>(split_code(joined, format), format);
            const UnitVectorCode again = encode_unit_vector(n, format, quantisation);
            ASSERT_LT(angle_between(decode_unit_vector<double>(again, format), n), 1e-15) << joined;
        }
    }
}

TEST(UnitVector, AnyCodeOfAnyMethodIsAUnitVectorThatPacksToItself) {
    std::mt19937_64 random(5);
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        for (const uint32_t bits : {1U, 2U, 8U, 16U, 23U, 24U, 25U, 26U, 30U, 32U}) {
            for (const UnitVectorLattice lattice : kBothLattices) {
                if (bits == 1 && lattice == UnitVectorLattice::kOdd) continue;
                const UnitVectorFormat format = {method, bits, lattice};
                for (int i = 0; i < 300; ++i) {
                    const auto word = [&] { return i % 8 == 0 ? ~0U : static_cast<uint32_t>(random()); };
                    const UnitVectorCode code = {word(), word(), i % 5 == 0 ? word() : word() % 8};
                    const Direction n = decode_unit_vector<double>(code, format);
                    ASSERT_NEAR(n[0] * n[0] + n[1] * n[1] + n[2] * n[2], 1, 1e-14) << short_name(method);
                    const std::array<float, 3> f = decode_unit_vector<float>(code, format);
                    ASSERT_NEAR(f[0] * f[0] + f[1] * f[1] + f[2] * f[2], 1, 1e-6F) << short_name(method);
                    // Of PP and SPP the squares' corners are not used: directions there have other codes.
                    if (method == kParallel || method == kSextant) continue;
                    ASSERT_LT(error_of(n, format, kRange), 1e-14) << short_name(method) << ' ' << bits;
                }
            }
        }
    }
}

TEST(UnitVector, AxesAreExactOnOddLatticesAndTiltedOnEvenOnes) {
    for (const UnitVectorMethod method : {kSextant, kCube, kWarpedCube, kOctahedron, kWarpedOctahedron}) {
        for (size_t axis = 0; axis < 3; ++axis) {
            for (const double sign : {1.0, -1.0}) {
                Direction n = {-0.0, 0, -0.0};
                n[axis] = sign;
                for (const Quantisation quantisation : {kDomain, kRange})
                    EXPECT_EQ(error_of(n, {method, 8, UnitVectorLattice::kOdd}, quantisation), 0) << short_name(method);
            }
        }
    }
    const UnitVectorFormat even = {kOctahedron, 8};
    EXPECT_NEAR(error_of({0, 0, 1}, even, kRange), std::sqrt(0.5) * lattice_step(even), 1e-4) << "0.32 degrees";
}

TEST(UnitVector, TheIntegerOctahedronIsThatOfTheOddLattice) {
    std::mt19937_64 random(9);
    std::normal_distribution<double> gauss;
    for (const uint32_t bits : {2U, 8U, 16U, 24U, 32U}) {
        const UnitVectorFormat format = {kOctahedron, bits, UnitVectorLattice::kOdd};
        for (int i = 0; i < 20000; ++i) {
            const Direction n = {gauss(random), gauss(random), gauss(random)};
            const uint64_t packed = pack_octahedral(n, bits);
            const Direction m = unpack_octahedral(packed, bits);
            const Direction other = decode_unit_vector<double>(split_code(packed, format), format);
            ASSERT_LT(angle_between(m, other), 1e-15) << bits;
            ASSERT_NEAR(error_of(n, format, kRange), angle_between(m, n), 1e-15 + 1e-6 * angle_between(m, n)) << bits;
        }
    }
}

TEST(UnitVector, SinglePrecisionIsSafeToThirtyTwoBits) {
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        const UnitVectorFormat format = *format_of_budget(method, 32);
        DirectionSource source(method);
        double worst = 0;
        for (int i = 0; i < 100'000; ++i) {
            const Direction n = source.next();
            const std::array<float, 3> single = {static_cast<float>(n[0]), static_cast<float>(n[1]),
                                                 static_cast<float>(n[2])};
            const std::array<float, 3> back =
                decode_unit_vector<float>(encode_unit_vector(single, format, kRange), format);
            worst = std::max(worst, angle_between({back[0], back[1], back[2]}, {single[0], single[1], single[2]}));
        }
        EXPECT_LT(worst, largest_error(method, kRange, lattice_step(format)) * 1.01) << short_name(method);
    }
}

TEST(UnitVector, AwkwardVectorsAreFiniteUnitVectors) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const Direction vectors[] = {{0, 0, 0},          {-0.0, -0.0, -0.0}, {nan, 0, 1},  {0, infinity, 0},
                                 {5e-324, 0, 0},     {1e-30, 1e-30, 0},  {0, 1e30, 0}, {1e308, -1e308, 1e308},
                                 {-0.0, 1, -1e-300}, {1, 1, 1},          {-1, 1, 0},   {0, 0, -1}};
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        for (const Quantisation quantisation : {kDomain, kRange}) {
            const UnitVectorFormat format = {method, 16};
            for (const Direction& vector : vectors) {
                EXPECT_LT(error_of(vector, format, quantisation),
                          largest_error(method, quantisation, lattice_step(format)) * 1.005)
                    << short_name(method) << ' ' << vector[0] << ' ' << vector[1] << ' ' << vector[2];
            }
        }
    }
}

TEST(UnitVector, ChartsMeetWithoutAJumpAtTiesOfComponents) {
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        const UnitVectorFormat format = {method, 20};
        for (const Direction& tie : {Direction{1, 1, 0.2}, Direction{-1, 0.3, 1}, Direction{0.1, -1, 1},
                                     Direction{1, 1, 1}, Direction{0.4, 1e-9, -1}, Direction{-1, -0.0, 0.5}}) {
            for (const double nudge : {0.0, 1e-16, -1e-16}) {
                const Direction n = {tie[0] + nudge, tie[1], tie[2] - nudge};
                EXPECT_LT(error_of(n, format, kRange), largest_error(method, kRange, lattice_step(format)) * 1.005)
                    << short_name(method);
            }
        }
    }
}

TEST(UnitVector, BudgetsAreFilledAndCodesJoinAndSplit) {
    EXPECT_EQ(format_of_budget(kOctahedron, 48)->bits, 24U);
    EXPECT_EQ(format_of_budget(kOctahedron, 47)->bits, 23U);
    EXPECT_EQ(format_of_budget(kWarpedOctahedron, 47)->bits, 23U);
    EXPECT_EQ(format_of_budget(kCube, 64)->bits, 30U);
    EXPECT_EQ(format_of_budget(kOctahedron, 64)->bits, 32U);
    EXPECT_FALSE(format_of_budget(kCube, 4));
    EXPECT_FALSE(format_of_budget(kOctahedron, 3, UnitVectorLattice::kOdd));
    std::mt19937_64 random(3);
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        for (uint32_t budget = 5; budget <= 64; ++budget) {
            const UnitVectorFormat format = *format_of_budget(method, budget);
            EXPECT_LE(total_bits(format), budget);
            EXPECT_GE(total_bits(format) + 1, budget);
            const UnitVectorCode code = {static_cast<uint32_t>(random()) & last_lattice_value(format),
                                         static_cast<uint32_t>(random()) & last_lattice_value(format),
                                         static_cast<uint32_t>(random() % chart_count(method))};
            EXPECT_EQ(split_code(join_code(code, format), format), code) << short_name(method) << ' ' << budget;
        }
    }
}

}  // namespace
}  // namespace citystream::codec::mesh
