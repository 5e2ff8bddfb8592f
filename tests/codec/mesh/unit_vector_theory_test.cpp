#include "codec/mesh/unit_vector_theory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace citystream::codec::mesh {
namespace {

using enum UnitVectorMethod;
using enum Quantisation;
constexpr Quantisation kBoth[] = {kDomain, kRange};
constexpr double kPi = std::numbers::pi;

TEST(UnitVectorTheory, EightBitColoursTakeAtLeastEighteenBits) {
    EXPECT_NEAR(lambert_error(8), 0.0039, 1e-5);
    EXPECT_NEAR(optimal_count(std::exp2(-8)), 237740, 5);  // section 4.3.2
    EXPECT_EQ(std::ceil(std::log2(optimal_count(std::exp2(-8)))), 18);
}

TEST(UnitVectorTheory, FejesTothsBoundIsMetByTheRegularSolids) {
    EXPECT_NEAR(2 * optimal_error(3), 2 * kPi / 3, 1e-12);
    EXPECT_NEAR(2 * optimal_error(4), std::acos(-1.0 / 3), 1e-12);
    EXPECT_NEAR(2 * optimal_error(6), kPi / 2, 1e-12);
    EXPECT_NEAR(2 * optimal_error(12), std::atan(2.0), 1e-12);
}

TEST(UnitVectorTheory, CountAndErrorAreInversesFromAFewToTenToTheThirtyThree) {
    for (double count = 4; count < 1e33; count *= 7) {
        EXPECT_NEAR(optimal_count(optimal_error(count)) / count, 1, 1e-11) << count;
    }
}

TEST(UnitVectorTheory, FloatVectorsHaveTheErrorsOfTableFourOne) {
    EXPECT_NEAR(float_vector_error(10), 4.60e-4, 0.01e-4);
    EXPECT_NEAR(float_vector_error(23), 5.62e-8, 0.01e-8);
    EXPECT_NEAR(float_vector_error(52), 1.05e-16, 0.01e-16);
    // Equation 4.6 of these errors; the table's own column is another one (errata).
    const double bits[][2] = {{10, 24.03}, {23, 50.03}, {52, 108.03}};
    for (const auto& [mantissa, expected] : bits)
        EXPECT_NEAR(std::log2(optimal_count(float_vector_error(static_cast<uint32_t>(mantissa)))), expected, 0.005);
}

TEST(UnitVectorTheory, RoundingUnitVectorsToFloatsErrsAsFarAsTheErratumSays) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> gauss;
    double worst = 0;
    for (int i = 0; i < 2'000'000; ++i) {
        Direction n = {gauss(random), gauss(random), gauss(random)};
        if (i % 2 == 1) n = {0.5 + 0.01 * gauss(random), 0.5 + 0.01 * gauss(random), std::numbers::sqrt2 / 2};
        n = unit_direction(n);
        const volatile float x = static_cast<float>(n[0]), y = static_cast<float>(n[1]), z = static_cast<float>(n[2]);
        worst = std::max(worst, angle_between({x, y, z}, n));
    }
    EXPECT_GT(worst, 4.8e-8);
    EXPECT_LT(worst, float_unit_vector_error(23));
    EXPECT_NEAR(float_unit_vector_error(23), 5.09e-8, 0.005e-8);
    EXPECT_LT(float_unit_vector_error(23), float_vector_error(23));
    EXPECT_LT(float_vector_error(23), float_direction_error(23));
}

TEST(UnitVectorTheory, CompactnessFactorsAreThoseOfTableFourFour) {
    const double table[7][2] = {{0, 0},       {4.90, 3.46}, {4.00, 4.00}, {3.63, 3.14},
                                {4.24, 2.83}, {3.46, 3.46}, {3.14, 3.14}};
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        for (const Quantisation quantisation : kBoth) {
            const double c = compactness(method, quantisation, 48);
            const double expected = method == kParallel ? std::exp2((quantisation == kDomain ? 1 : 0.75) + 12)
                                                        : table[static_cast<size_t>(method)][quantisation == kRange];
            EXPECT_NEAR(c / expected, 1, 0.002) << short_name(method);
        }
    }
}

TEST(UnitVectorTheory, ErrorsAtFortySevenAndFortyEightBitsAreThoseOfTableFourFive) {
    struct Row {
        UnitVectorMethod method;
        double at_48[2], at_47[2];
    };
    const Row rows[] = {{kParallel, {5.81e-4, 4.88e-4}, {5.81e-4, 4.88e-4}},
                        {kSextant, {4.13e-7, 2.92e-7}, {4.13e-7, 2.92e-7}},
                        {kOctahedron, {2.53e-7, 1.69e-7}, {5.06e-7, 3.37e-7}},
                        {kWarpedOctahedron, {2.92e-7, 2.92e-7}, {2.92e-7, 2.92e-7}},
                        {kCube, {3.37e-7, 3.37e-7}, {3.37e-7, 3.37e-7}},
                        {kWarpedCube, {3.06e-7, 2.65e-7}, {3.06e-7, 2.65e-7}},
                        {kSpherical, {2.65e-7, 2.65e-7}, {2.65e-7, 2.65e-7}}};
    for (const Row& row : rows) {
        for (const Quantisation quantisation : kBoth) {
            const auto error = [&](uint32_t budget) {
                return largest_error(row.method, quantisation, lattice_step(*format_of_budget(row.method, budget)));
            };
            const size_t column = quantisation == kRange;
            EXPECT_NEAR(error(48) / row.at_48[column], 1, 0.003) << short_name(row.method);
            EXPECT_NEAR(error(47) / row.at_47[column], 1, 0.003) << short_name(row.method);
        }
    }
}

TEST(UnitVectorTheory, SurplusBitsAreThoseOfTableFourTen) {
    const std::pair<UnitVectorMethod, std::array<double, 2>> table[] = {
        {kSextant, {2.73, 1.73}}, {kOctahedron, {2.31, 1.14}}, {kWarpedOctahedron, {1.73, 1.73}},
        {kCube, {2.14, 2.14}},    {kWarpedCube, {1.86, 1.44}}, {kSpherical, {1.44, 1.44}}};
    for (const auto& [method, expected] : table) {
        for (const Quantisation quantisation : kBoth)
            EXPECT_NEAR(*surplus_bits(method, quantisation), expected[quantisation == kRange], 0.01);
    }
    EXPECT_FALSE(surplus_bits(kParallel, kRange));
}

TEST(UnitVectorTheory, SurplusIsTheLimitOfTheExactFormula) {
    for (const double b : {20.0, 48.0, 100.0}) {
        const double error = compactness(kOctahedron, kRange, b) * std::exp2(-b / 2);
        EXPECT_NEAR(b - std::log2(optimal_count(error)), *surplus_bits(kOctahedron, kRange), 2e-5);
        EXPECT_NEAR(b - std::log2(covering_count(error)), *surplus_bits_over_covering(kOctahedron, kRange), 1e-9);
    }
    EXPECT_NEAR(*surplus_bits(kOctahedron, kRange) - *surplus_bits_over_covering(kOctahedron, kRange),
                std::log2(4.0 / 3), 1e-12);
}

TEST(UnitVectorTheory, BitsToMatchFloatsAreThoseOfTableFourEight) {
    constexpr uint32_t kMantissas[] = {10, 23, 52};
    const auto expect = [&](UnitVectorMethod method, Quantisation quantisation, std::array<uint32_t, 3> bits) {
        for (size_t i = 0; i < 3; ++i)
            EXPECT_EQ(bits_to_match(method, quantisation, float_vector_error(kMantissas[i])), bits[i])
                << short_name(method);
    };
    for (const Quantisation quantisation : kBoth) {
        expect(kParallel, quantisation, {49, 101, 217});
        for (const UnitVectorMethod method : {kSextant, kCube, kWarpedCube, kWarpedOctahedron, kSpherical})
            expect(method, quantisation, {27, 53, 111});
    }
    expect(kOctahedron, kDomain, {28, 54, 112});
    expect(kOctahedron, kRange, {26, 52, 110});
}

TEST(UnitVectorTheory, TheErrorFunctionsPeakAtTheWorstPlacesWithTheErrorsOfTableFourFour) {
    constexpr double kStep = 1e-5;
    for (const UnitVectorMethod method : kUnitVectorMethods) {
        if (method == kParallel) continue;  // of first order only away from its rim
        const ParameterRange range = parameter_range(method);
        for (const Quantisation quantisation : kBoth) {
            const auto error_at = [&](const Projected<double>& place) {
                return quantisation == kDomain ? domain_error_at(method, place, kStep)
                                               : range_error_at(method, place, kStep);
            };
            const double largest = largest_error(method, quantisation, kStep);
            EXPECT_NEAR(error_at(worst_place(method, quantisation)) / largest, 1, 1e-3) << short_name(method);
            for (int i = 1; i < 200; ++i) {
                for (int k = 1; k < 200; ++k) {
                    const Projected<double> place = {range.middle + range.half * (i / 100.0 - 1.0001),
                                                     range.middle + range.half * (k / 100.0 - 1.0001), 0};
                    const double rest = 1 - place.u * place.u - place.v * place.v;
                    if (method == kSextant && std::max(std::abs(place.u), std::abs(place.v)) > std::sqrt(rest))
                        continue;
                    ASSERT_LE(error_at(place), largest * 1.001)
                        << short_name(method) << ' ' << place.u << ' ' << place.v;
                }
            }
        }
    }
}

TEST(UnitVectorTheory, WorstDirectionsAreThoseOfTableFourThree) {
    EXPECT_LT(angle_between(worst_direction(kParallel, kDomain), {1, 1, 0}), 1e-7);
    EXPECT_LT(angle_between(worst_direction(kSextant, kRange), {1, 0, 1}), 1e-12);
    EXPECT_LT(angle_between(worst_direction(kCube, kRange), {0, 0, 1}), 1e-12);
    for (const UnitVectorMethod method : {kSextant, kWarpedCube, kOctahedron})
        EXPECT_LT(angle_between(worst_direction(method, kDomain), {1, 1, 1}), 1e-12) << short_name(method);
    EXPECT_LT(angle_between(worst_direction(kWarpedOctahedron, kRange), {1, 1, 1}), 1e-12);
}

}  // namespace
}  // namespace citystream::codec::mesh
