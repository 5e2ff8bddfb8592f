// Directions, frames and light: the conventions that the bits of a radiance layer are read by.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

#include "codec/radiance/frames.h"
#include "codec/radiance/local_directions.h"
#include "codec/radiance/series_angle.h"
#include "codec/radiance/source_directions.h"
#include "codec/radiance/source_light.h"

namespace citystream::codec::radiance {
namespace {

using Vector = std::array<double, 3>;

Vector as_vector(const GridDirection& d) {
    return {static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2])};
}

std::array<int64_t, 3> as_wide(const GridDirection& d) {
    return {d[0], d[1], d[2]};
}

double angle_between(const Vector& a, const Vector& b) {
    const auto dot = [](const Vector& v, const Vector& w) { return v[0] * w[0] + v[1] * w[1] + v[2] * w[2]; };
    return std::acos(std::clamp(dot(a, b) / std::sqrt(dot(a, a) * dot(b, b)), -1.0, 1.0));
}

TEST(SourceDirections, FindTheirOwnCells) {
    for (const uint32_t side : {1u, 2u, 3u, 8u, 64u, 128u}) {
        for (uint32_t cell = 0; cell < cube_cells(side); ++cell) {
            const GridDirection d = cell_direction(side, cell);
            EXPECT_EQ(cell_of(as_wide(d), side), cell);
            EXPECT_EQ(cell_of(as_vector(d), side), cell);
        }
    }
}

TEST(SourceDirections, HaveFacesAsCubeMapsHaveThem) {
    // First texel, in the corner of s = t = -1, of a map of 2 x 2.
    const GridDirection corners[] = {{2, 1, 1}, {-2, 1, -1}, {-1, 2, -1}, {-1, -2, 1}, {-1, 1, 2}, {1, 1, -2}};
    for (uint32_t face = 0; face < kCubeFaces; ++face) EXPECT_EQ(cell_direction(2, face * 4), corners[face]);
}

TEST(SourceDirections, BreakTiesBetweenFacesAsVulkanDoes) {
    EXPECT_EQ(cell_of(std::array<int64_t, 3>{1, 1, 1}, 8) / 64, 4u);
    EXPECT_EQ(cell_of(std::array<int64_t, 3>{1, 1, -1}, 8) / 64, 5u);
    EXPECT_EQ(cell_of(std::array<int64_t, 3>{1, -1, 0}, 8) / 64, 3u);
    EXPECT_EQ(cell_of(std::array<int64_t, 3>{1, 0, 0}, 8) / 64, 0u);
    EXPECT_EQ(cell_of(std::array<int64_t, 3>{0, 0, 0}, 8) / 64, 4u);
    EXPECT_EQ(cell_of(Vector{NAN, 0, 0}, 8) / 64, 4u);
}

TEST(SourceDirections, AgreeInIntegersAndDoubles) {
    std::mt19937 random(3);
    for (int i = 0; i < 20000; ++i) {
        const auto number = [&] { return static_cast<int64_t>(random() % 201) - 100; };
        const std::array<int64_t, 3> d{number(), number(), number()};
        const Vector same{static_cast<double>(d[0]), static_cast<double>(d[1]), static_cast<double>(d[2])};
        const uint32_t a = cell_of(d, 16), b = cell_of(same, 16);
        EXPECT_EQ(a, b) << d[0] << ' ' << d[1] << ' ' << d[2];
    }
}

TEST(SourceDirections, HaveSolidAnglesThatAddUpToTheSphere) {
    for (const uint32_t side : {1u, 2u, 7u, 32u, 64u}) {
        double sum = 0;
        for (uint32_t cell = 0; cell < cube_cells(side); ++cell) sum += cell_solid_angle(side, cell);
        EXPECT_NEAR(sum, 4 * kPi, 1e-9);
    }
    EXPECT_NEAR(cell_solid_angle(32, 16 * 32 + 16), 0.003891, 1e-6);
    EXPECT_NEAR(cell_solid_angle(32, 0), 0.0008007, 1e-7);
}

TEST(SourceDirections, PutFourSamplesIntoEachTexel) {
    for (const uint32_t side : {1u, 4u, 32u}) {
        std::vector<uint32_t> count(texel_count(side), 0);
        for (uint32_t s = 0; s < sample_count(side); ++s) {
            const uint32_t k = texel_of_sample(side, s);
            EXPECT_EQ(cell_of(as_wide(cell_direction(2 * side, s)), side), k);
            ++count[k];
        }
        for (const uint32_t samples : count) EXPECT_EQ(samples, kSamplesInTexel);
    }
}

TEST(SeriesAngle, IsSineAndCosine) {
    for (int i = -700; i <= 700; ++i) {
        const double x = i * 0.01;
        EXPECT_NEAR(angle_parts(x).sine, std::sin(x), 1e-13);
        EXPECT_NEAR(angle_parts(x).cosine, std::cos(x), 1e-13);
    }
}

TEST(LocalDirections, AreUnitVectorsAboveThePlaneAtTheAnglesOfTheMap) {
    // Worst angle to the nearest and lowest elevation in degrees, for 8, 12, 16 and 32 on a side.
    const double expected[][3] = {{8, 14.96, 13.55}, {12, 10.02, 9.19}, {16, 7.55, 6.96}, {32, 3.79, 3.53}};
    for (const auto& [side, worst_angle, lowest] : expected) {
        const LocalDirections local(static_cast<uint32_t>(side));
        double elevation = 90, worst = 0;
        for (uint32_t j = 0; j < local.count(); ++j) {
            const Vector d = as_vector(local.direction(j));
            EXPECT_NEAR(std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), kFrameOne, 1);
            elevation = std::min(elevation, 90 - angle_between(d, {0, 0, 1}) * 180 / kPi);
        }
        const auto look = [&](const GridDirection& d) {
            worst = std::max(worst, angle_between(as_vector(d), as_vector(local.direction(local.nearest(as_wide(d))))));
        };
        for (uint32_t cell = 0; cell < cube_cells(128); ++cell) {
            GridDirection d = cell_direction(128, cell);
            if (d[2] > 0) look(d);
            d[2] = 0;  // the horizon is farthest
            if (d[0] != 0 || d[1] != 0) look(d);
        }
        EXPECT_NEAR(elevation, lowest, 0.02);
        EXPECT_NEAR(worst * 180 / kPi, worst_angle, 0.05);
    }
}

TEST(LocalDirections, FindTheNearestOfAllAndTheLowestOfEquals) {
    for (const uint32_t side : {1u, 2u, 3u, 8u, 12u, 32u}) {
        const LocalDirections local(side);
        std::mt19937 random(side);
        for (int i = 0; i < 4000; ++i) {
            const auto number = [&] { return static_cast<int64_t>(random() % 2001) - 1000; };
            const std::array<int64_t, 3> d{number(), number(), number()};
            EXPECT_EQ(local.nearest(d), local.nearest_of_all(d));
        }
        for (uint32_t cell = 0; cell < cube_cells(24); ++cell) {
            const auto d = as_wide(cell_direction(24, cell));
            EXPECT_EQ(local.nearest(d), local.nearest_of_all(d));
        }
    }
    // The normal itself is as far from the four in the middle.
    const LocalDirections local(8);
    EXPECT_EQ(local.nearest({0, 0, 1}), 27u);
    EXPECT_EQ(LocalDirections(1).direction(0), (GridDirection{0, 0, kFrameOne}));
}

TEST(LocalDirections, ShareTheHemisphereAndItsCosine) {
    for (const uint32_t side : {1u, 8u, 12u, 32u}) {
        const CellAverages averages = cell_averages(LocalDirections(side));
        double sum = 0, cosines = 0;
        for (size_t j = 0; j < averages.cosine.size(); ++j) {
            sum += averages.solid_angle[j];
            cosines += averages.solid_angle[j] * averages.cosine[j];
        }
        EXPECT_NEAR(sum, 2 * kPi, 1e-9);
        EXPECT_NEAR(cosines, kPi, 1e-4);
    }
}

void expect_orthonormal(const Frame& frame, bool mirrored) {
    const double one = static_cast<double>(kFrameOne) * kFrameOne;
    for (size_t i = 0; i < 3; ++i) {
        for (size_t k = 0; k < 3; ++k) {
            const auto local = frame.to_local(frame.axes[k]);
            EXPECT_NEAR(static_cast<double>(local[i]) / one, i == k ? 1 : 0, 3e-4);
        }
    }
    const auto& a = frame.axes;
    const double z = static_cast<double>(a[0][0]) * a[1][1] - static_cast<double>(a[0][1]) * a[1][0];
    EXPECT_NEAR(z / one, (mirrored ? -1.0 : 1.0) * a[2][2] / kFrameOne, 3e-4);
}

TEST(Frames, AreOrthonormalWhateverTheCode) {
    std::mt19937 random(5);
    for (int i = 0; i < 5000; ++i) {
        const auto code = static_cast<uint32_t>(random());
        expect_orthonormal(unpack_frame(code), code >> 31 != 0);
    }
    for (const uint32_t code : {0u, ~0u, 0x80000000u, 0x7fffffffu, 0xffffffu}) {
        expect_orthonormal(unpack_frame(code), code >> 31 != 0);
    }
}

TEST(Frames, KeepAxesExactly) {
    const Vector axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    for (const Vector& n : axes) {
        const Frame frame = unpack_frame(pack_frame(n));
        for (size_t i = 0; i < 3; ++i) EXPECT_EQ(frame.axes[2][i], static_cast<int32_t>(n[i]) * kFrameOne);
    }
}

TEST(Frames, FollowTheirTangents) {
    std::mt19937 random(6);
    std::uniform_real_distribution<double> number(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        const Vector n{number(random), number(random), number(random)},
            t{number(random), number(random), number(random)};
        const Frame frame = unpack_frame(pack_frame(n, t));
        EXPECT_LT(angle_between(as_vector(frame.axes[2]), n), 0.002);
        // The tangent lies in the half plane of x, give or take half of a turn's 128th.
        const double x = as_vector(frame.axes[0])[0] * t[0] + as_vector(frame.axes[0])[1] * t[1] +
                         as_vector(frame.axes[0])[2] * t[2];
        const double y = as_vector(frame.axes[1])[0] * t[0] + as_vector(frame.axes[1])[1] * t[1] +
                         as_vector(frame.axes[1])[2] * t[2];
        EXPECT_LT(std::abs(std::atan2(y, x)), kPi / kFrameTurns + 0.001);
    }
}

TEST(Frames, TakeNormalsAndTangentsThatAreNone) {
    const double nan = std::nan(""), inf = HUGE_VAL;
    for (const Vector& none : {Vector{0, 0, 0}, Vector{nan, 0, 1}, Vector{inf, 0, 0}}) {
        EXPECT_EQ(pack_frame(none), pack_frame({0, 0, 1}));
        EXPECT_EQ(pack_frame({0, 1, 0}, none), pack_frame({0, 1, 0}));
    }
    for (const Vector& pole : {Vector{0, 0, 1}, Vector{0, 0, -1}}) {
        EXPECT_EQ(pack_frame(pole, pole), pack_frame(pole));
        EXPECT_EQ(unpack_frame(pack_frame(pole)).axes[0], (GridDirection{kFrameOne, 0, 0}));
        EXPECT_EQ(unpack_frame(pack_frame(pole, {0, 1, 0})).axes[0], (GridDirection{0, kFrameOne, 0}));
    }
    const Frame plain = unpack_frame(pack_frame({0, 1, 0}, {1, 0, 0})),
                mirrored = unpack_frame(pack_frame({0, 1, 0}, {1, 0, 0}, true));
    EXPECT_EQ(plain.axes[0], mirrored.axes[0]);
    for (size_t i = 0; i < 3; ++i) EXPECT_EQ(plain.axes[1][i], -mirrored.axes[1][i]);
}

TEST(Yaw, IsThatOfMostEdges) {
    EXPECT_EQ(common_yaw({}), 0u);
    const double angle = yaw_angle(40);
    std::vector<std::array<double, 2>> edges;
    for (const double turn : {0.0, kPi / 2, kPi, 3 * kPi / 2})
        edges.push_back({10 * std::cos(angle + turn), 10 * std::sin(angle + turn)});
    edges.push_back({30, 0.1});
    edges.push_back({NAN, 1});
    EXPECT_EQ(common_yaw(edges), 40u);
}

TEST(SourceLight, HasNoNegativeAndNoInfiniteValues) {
    const float inf = HUGE_VALF;
    std::vector<Rgb> map(texel_count(4), Rgb{1, 2, 3});
    map[0] = {-1, std::nanf(""), inf};
    map[1] = {-inf, -0.0F, 1e38F};
    for (const auto& light : {weighted_light(map, 4), turned_light(map, 4, 0.3)}) {
        for (const Rgb& value : light) {
            for (const float v : value) EXPECT_TRUE(std::isfinite(v) && v >= 0);
        }
    }
    const WholeLight whole = whole_light(weighted_light(map, 4));
    uint64_t sums[3] = {};
    for (const auto& value : whole.values) {
        for (size_t c = 0; c < 3; ++c) sums[c] += value[c];
    }
    for (const uint64_t sum : sums) EXPECT_LT(4 * sum, uint64_t{1} << 31);
    const WholeLight dark = whole_light(std::vector<Rgb>(6, Rgb{0, 0, 0}));
    for (const auto& value : dark.values) EXPECT_EQ(value, (std::array<uint32_t, 3>{0, 0, 0}));
}

TEST(SourceLight, TurnsAboutTheVertical) {
    const uint32_t side = 32;
    const std::vector<Rgb> grey(texel_count(side), Rgb{0.5F, 0.25F, 1});
    EXPECT_EQ(turned_light(grey, side, 0.7), grey);
    // A quarter turn of the axes brings what is in the north to the east.
    std::vector<Rgb> map(texel_count(side), Rgb{});
    map[cell_of(Vector{0.01, 1, 0.01}, side)] = {1, 1, 1};
    const auto turned_map = turned_light(map, side, kPi / 2);
    EXPECT_GT(turned_map[cell_of(Vector{1, -0.01, 0.01}, side)][0], 0.9F);
    // A smooth map keeps its light.
    for (uint32_t k = 0; k < map.size(); ++k) {
        const Vector d = as_vector(cell_direction(side, k));
        map[k].fill(static_cast<float>(1 + 0.8 * std::cos(angle_between(d, {1, 0.3, 0.5}))));
    }
    const auto total = [&](const std::vector<Rgb>& light) {
        double sum = 0;
        for (const Rgb& value : weighted_light(light, side)) sum += value[0];
        return sum;
    };
    EXPECT_NEAR(total(turned_light(map, side, 0.4)) / total(map), 1, 1e-3);
}

}  // namespace
}  // namespace citystream::codec::radiance
