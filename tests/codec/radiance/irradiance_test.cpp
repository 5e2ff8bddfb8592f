// Irradiance against sums over what each receiver sees, sample by sample in double.
#include "codec/radiance/irradiance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "codec/radiance/series_angle.h"
#include "tests/codec/radiance/lattice_scene.h"

namespace citystream::codec::radiance {
namespace {

using Vector = std::array<double, 3>;

constexpr uint32_t kSide = 32, kReceiversOfAClass = 12;

double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector unit(const GridDirection& d) {
    const double x = d[0], y = d[1], z = d[2], length = std::sqrt(x * x + y * y + z * z);
    return {x / length, y / length, z / length};
}

Vector random_direction(std::mt19937_64& random) {
    const auto part = [&] { return static_cast<int32_t>(random() % 2001) - 1000; };
    const GridDirection d = {part(), part(), part()};
    return d == GridDirection{} ? Vector{0, 0, 1} : unit(d);
}

struct Sample {
    Vector direction;
    double solid_angle;
    uint32_t texel;
};

std::vector<Sample> samples() {
    std::vector<Sample> all;
    for (uint32_t s = 0; s < sample_count(kSide); ++s)
        all.push_back({unit(cell_direction(kSamplesAcross * kSide, s)), cell_solid_angle(kSamplesAcross * kSide, s),
                       texel_of_sample(kSide, s)});
    return all;
}

/// Receivers of all classes and any tilts, each behind discs of the sky and walls of its own; every sixth sees samples
/// at random, and every sixth is without any tilt.
RadianceTile partly_hidden(const std::vector<Sample>& samples, uint64_t seed) {
    std::mt19937_64 random(seed);
    RadianceTile tile;
    tile.spacing_log2 = 12;
    tile.visibility.side = kSide;
    for (uint32_t c = 0; c < RECEIVER_CLASSES; ++c) {
        for (uint32_t i = 0; i < kReceiversOfAClass; ++i) {
            const auto tilt = [&] {
                return static_cast<int8_t>(i % 6 == 0 ? 0 : static_cast<int>(random() % 255) - 127);
            };
            tile.places.push_back({c, {static_cast<int32_t>(i), 0}, 0, {tilt(), tilt()}});
            tile.visibility.add_receiver(frame_of_place(tile.places.back()));
            const uint32_t r = tile.visibility.receivers() - 1;
            std::vector<std::pair<Vector, double>> hidden;
            for (int k = 0; k < 5; ++k)
                hidden.emplace_back(random_direction(random), 0.3 + 0.1 * static_cast<double>(random() % 7));
            for (uint32_t s = 0; s < samples.size(); ++s) {
                const Vector& d = samples[s].direction;
                const bool free =
                    i % 6 == 1 ? random() % 2 == 0 : std::none_of(hidden.begin(), hidden.end(), [&](const auto& disc) {
                        return dot(disc.first, d) > disc.second;
                    });
                if (free) tile.visibility.set(r, s);
            }
        }
    }
    clear_below_planes(tile.visibility);
    return tile;
}

/// What the tile's receivers get, through the layer.
std::vector<std::array<float, 3>> lit(const RadianceTile& tile, const std::vector<Rgb>& sky, MatrixForm form) {
    const auto steps = encode_radiance_layer(tile, 8, 1);
    EXPECT_TRUE(steps.ok());
    const LayerPrefix prefix(*steps, 3);
    const auto words = decode_radiance_layer(prefix.steps, prefix.decoded_bytes, form);
    const auto view = RadianceLayerView::create(*words);
    const WholeLight light = whole_light(weighted_light(sky, kSide));
    const auto irradiance = irradiance_words(*view, light);
    std::vector<std::array<float, 3>> result;
    for (uint32_t r = 0; r < view->receivers(); ++r)
        result.push_back(irradiance_of(irradiance, r, irradiance_unit(light)));
    return result;
}

/// The red light of a receiver, and how much its samples' cosines make of a light of 1.
std::array<double, 2> exact(const RadianceTile& tile, uint32_t receiver, const std::vector<Sample>& samples,
                            const std::vector<Rgb>& sky) {
    const WholeNormal whole = whole_normal(tile.places[receiver].surface_class, tile.places[receiver].tilt);
    const Vector normal = unit(whole.vector);
    std::array<double, 2> sum{};
    for (uint32_t s = 0; s < samples.size(); ++s) {
        if (!tile.visibility.sees(receiver, s)) continue;
        const double part = std::max(0.0, dot(normal, samples[s].direction)) * samples[s].solid_angle;
        sum[0] += part * sky[samples[s].texel][0];
        sum[1] += part;
    }
    return sum;
}

TEST(Irradiance, OfAnEvenSkyIsExactWhateverPartOfItIsSeen) {
    const auto all = samples();
    const std::vector<Rgb> even(texel_count(kSide), {1, 1, 1});
    double least = kPi, most = 0;
    for (const MatrixForm form : {MatrixForm::kBiclusters, MatrixForm::kRows}) {
        const RadianceTile tile = partly_hidden(all, 5);
        const auto result = lit(tile, even, form);
        for (uint32_t r = 0; r < result.size(); ++r) {
            const double truth = exact(tile, r, all, even)[1];
            // Of that 0.05 % is rounding to halves; little light is that of few samples, parts of texels.
            EXPECT_NEAR(result[r][0], truth, 1e-3 * truth + 1e-4 * kPi) << r;
            least = std::min(least, truth);
            most = std::max(most, truth);
        }
    }
    EXPECT_LT(least, 0.1) << "some see little";
    EXPECT_GT(most, 1.2) << "some see much";
}

TEST(Irradiance, OfSkiesOfManyTexelsIsThatOfTheirSamples) {
    const auto all = samples();
    const RadianceTile tile = partly_hidden(all, 6);
    std::mt19937_64 random(2);
    std::vector<Rgb> sky(texel_count(kSide));
    for (Rgb& value : sky) value = {static_cast<float>(random() % 1000), 1, 0};
    // A bright lamp, some texels wide.
    for (uint32_t k = 0; k < sky.size(); ++k) {
        if (dot(unit(cell_direction(kSide, k)), {0.48, 0.6, 0.64}) > 0.985) sky[k][0] = 2e5F;
    }
    const auto result = lit(tile, sky, MatrixForm::kBiclusters);
    double squares = 0, truths = 0;
    for (uint32_t r = 0; r < result.size(); ++r) {
        const double truth = exact(tile, r, all, sky)[0];
        squares += (result[r][0] - truth) * (result[r][0] - truth);
        truths += truth * truth;
        EXPECT_GE(result[r][0], 0) << r;
        EXPECT_EQ(result[r][2], 0) << r;
    }
    EXPECT_LT(std::sqrt(squares / truths), 0.002);
}

TEST(Irradiance, NormalsOfIntegersHaveTheLengthOfTheirScale) {
    for (int a = -128; a < 128; ++a) {
        for (int b = -128; b < 128; b += 3) {
            const WholeNormal normal = whole_normal(3, {static_cast<int8_t>(a), static_cast<int8_t>(b)});
            EXPECT_EQ(normal.vector, (std::array<int32_t, 3>{b, -RECEIVER_TILT_ONE, a}));
            const double length = std::sqrt(RECEIVER_TILT_ONE * RECEIVER_TILT_ONE + a * a + b * b);
            EXPECT_NEAR(normal.scale * length, 1 << IRRADIANCE_SCALE_BITS, length / 2 * 1.001);
        }
    }
    EXPECT_NEAR(whole_normal(4, {}).scale * 127.0 / (1 << IRRADIANCE_SCALE_BITS), 1, 1e-6);
}

TEST(Irradiance, PartsAlongNormalsAreNeverNegativeAndThoseOfTheLongestVectorsFit) {
    std::mt19937_64 random(4);
    for (int i = 0; i < 20000; ++i) {
        const auto tilt = [&] { return static_cast<int8_t>(random()); };
        const WholeNormal normal = whole_normal(static_cast<uint32_t>(random() % 6), {tilt(), tilt()});
        std::array<uint32_t, 3> vector{};
        double product = 0;
        for (size_t axis = 0; axis < 3; ++axis) {
            vector[axis] =
                i % 3 == 0 ? 0x80000000u - static_cast<uint32_t>(random() % 2) : static_cast<uint32_t>(random());
            product += static_cast<double>(normal.vector[axis]) * static_cast<int32_t>(vector[axis]);
        }
        const double exact_part = std::max(
            0.0, product * normal.scale / (1 << (IRRADIANCE_SCALE_BITS - IRRADIANCE_WEIGHT_BITS - LIGHT_VECTOR_SHIFT)));
        EXPECT_NEAR(static_cast<double>(part_along(normal, vector)), exact_part, 1 + 1e-12 * exact_part);
        EXPECT_LE(irradiance_half(part_along(normal, vector)), 0x47ffU);
    }
    // All light there is and more, from where the surface looks.
    const WholeNormal up = whole_normal(4, {});
    const uint64_t all = part_along(up, {0, 0, 0x3fffffff}), more = part_along(up, {0, 0, 0x5fffffff});
    EXPECT_EQ(irradiance_half(all), IRRADIANCE_LIT);
    EXPECT_NEAR(static_cast<double>(more) / static_cast<double>(all), 1.5, 1e-6);
}

TEST(SourceDirections, MeanDirectionsOfCellsAddUpToThoseOfFineOnes) {
    for (const uint32_t side : {1u, 2u, 5u, 32u}) {
        constexpr uint32_t kFine = 16;
        Vector up{};
        for (uint32_t cell = 0; cell < cube_cells(side); cell += side == 32 ? 37 : 1) {
            const uint32_t column = cell % side, row = cell / side % side, face = cell / side / side;
            Vector sum{};
            for (uint32_t i = 0; i < kFine * kFine; ++i) {
                const uint32_t fine =
                    (face * kFine * side + kFine * row + i / kFine) * kFine * side + kFine * column + i % kFine;
                const Vector d = unit(cell_direction(kFine * side, fine));
                for (size_t k = 0; k < 3; ++k) sum[k] += d[k] * cell_solid_angle(kFine * side, fine);
            }
            const Vector mean = cell_mean_direction(side, cell);
            for (size_t k = 0; k < 3; ++k)
                EXPECT_NEAR(mean[k], sum[k] / cell_solid_angle(side, cell), 2e-3 / (side * side))
                    << side << ' ' << cell;
        }
        for (uint32_t cell = 0; cell < cube_cells(side) && side % 2 == 0; ++cell) {
            if (cell_direction(side, cell)[2] <= 0) continue;
            for (size_t k = 0; k < 3; ++k) up[k] += cell_mean_direction(side, cell)[k] * cell_solid_angle(side, cell);
        }
        EXPECT_NEAR(up[2], side % 2 == 0 ? kPi : 0, 1e-12);
        EXPECT_NEAR(up[0], 0, 1e-12);
    }
}

}  // namespace
}  // namespace citystream::codec::radiance
