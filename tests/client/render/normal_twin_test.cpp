// Unit vectors on the GPU: codes are read to the same integers as by the codec, and codes that it writes (G-buffers,
// baked normal maps) keep the codec's bounds.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <random>

#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_hemisphere.h"
#include "shaders/twin_normal.comp.h"
#include "tests/client/render/gpu_twin.h"

namespace citystream::client::test {
namespace {

namespace mesh = codec::mesh;

constexpr uint32_t kCount = 200'000;

struct NormalCase {
    uint64_t code = 0;
    mesh::Direction direction = {};  ///< of floats
};

uint32_t float_bits(double value) {
    return std::bit_cast<uint32_t>(static_cast<float>(value));
}

/// Unit vectors and their codes; half of them near the worst directions, where |x| = |y| = |z|.
std::vector<NormalCase> cases_of(uint32_t bits) {
    std::mt19937_64 random(bits);
    std::normal_distribution<double> gauss;
    std::vector<NormalCase> cases(kCount);
    for (uint32_t i = 0; i < kCount; ++i) {
        mesh::Direction n = {gauss(random), gauss(random), gauss(random)};
        if (i % 2 == 1) {
            for (double& c : n) c = std::copysign(1.0, c) + 0.02 * gauss(random);
        }
        n = mesh::unit_direction(n);
        for (double& c : n) c = static_cast<float>(c);
        cases[i] = {mesh::pack_octahedral(n, bits), n};
    }
    return cases;
}

class NormalTwin : public GpuTwin {
  protected:
    std::vector<uint32_t> on_gpu(const std::vector<NormalCase>& cases, uint32_t bits) {
        TwinConstants constants{};
        constants.count = static_cast<uint32_t>(cases.size());
        constants.first = bits;
        std::vector<uint32_t> input;
        for (const NormalCase& one : cases) {
            const uint64_t mask = (uint64_t{1} << bits) - 1;
            input.push_back(static_cast<uint32_t>(one.code & mask));
            input.push_back(static_cast<uint32_t>(one.code >> bits & mask));
            for (const double c : one.direction) input.push_back(float_bits(c));
        }
        return run(k_twin_normal_comp, upload_words(std::array{0U}, false), constants, TWIN_NORMAL_WORDS, input);
    }

    static uint64_t code_at(const uint32_t* words, uint32_t bits) { return words[0] | uint64_t{words[1]} << bits; }
};

TEST_F(NormalTwin, AnyCodeUnfoldsToTheCodecsIntegers) {
    std::mt19937_64 random(1);
    for (const uint32_t bits : {2U, 5U, 8U, 15U, 16U, 24U, 25U, 31U, 32U}) {
        std::vector<NormalCase> cases(20'000);
        for (size_t i = 0; i < cases.size(); ++i) {
            cases[i] = {random(), {0, 0, 1}};
            if (i % 5 == 0) cases[i].code |= (uint64_t{1} << bits) - 1;  // the value that is never written
        }
        const std::vector<uint32_t> gpu = on_gpu(cases, bits);
        for (size_t i = 0; i < cases.size(); ++i) {
            const uint32_t* words = &gpu[i * TWIN_NORMAL_WORDS];
            const std::array<int32_t, 3> cpu = mesh::unfold_octahedral(cases[i].code, bits);
            const std::array<int64_t, 3> upper = mesh::unfold_hemisphere(cases[i].code, bits);
            for (size_t c = 0; c < 3; ++c) {
                ASSERT_EQ(static_cast<int32_t>(words[c]), cpu[c]) << bits << " bits, code " << cases[i].code;
                if (bits < 32) {
                    ASSERT_EQ(static_cast<int32_t>(words[6 + c]), upper[c]) << bits << " bits";
                }
            }
        }
    }
}

TEST_F(NormalTwin, DecodedUnitVectorsKeepTheBoundButForTheRoundingOfFloats) {
    for (const uint32_t bits : {8U, 16U, 24U}) {  // 16, 32 and 48 bits a vector
        const std::vector<NormalCase> cases = cases_of(bits);
        const std::vector<uint32_t> gpu = on_gpu(cases, bits);
        const double bound = std::numbers::sqrt2 * 2 / (2.0 * mesh::octahedral_side(bits));
        double worst = 0;
        for (size_t i = 0; i < cases.size(); ++i) {
            mesh::Direction shown;
            for (size_t c = 0; c < 3; ++c) shown[c] = std::bit_cast<float>(gpu[i * TWIN_NORMAL_WORDS + 3 + c]);
            worst = std::max(worst, mesh::angle_between(shown, cases[i].direction));
            ASSERT_NEAR(shown[0] * shown[0] + shown[1] * shown[1] + shown[2] * shown[2], 1, 2e-6);
        }
        EXPECT_LE(worst, bound * 1.005 + 6e-8) << bits;
        EXPECT_GT(worst, bound * 0.95) << bits;
    }
}

TEST_F(NormalTwin, WrittenCodesKeepTheBoundsOfDomainAndRangeQuantisation) {
    for (const uint32_t bits : {8U, 16U, 22U}) {
        const std::vector<NormalCase> cases = cases_of(bits);
        const std::vector<uint32_t> gpu = on_gpu(cases, bits);
        const double step = 2 / (2.0 * mesh::octahedral_side(bits));
        constexpr double kRounding = 3e-7;  // of a place in floats, of up to three roundings
        double rounded = 0, nearest = 0, hemisphere = 0;
        for (size_t i = 0; i < cases.size(); ++i) {
            const uint32_t* words = &gpu[i * TWIN_NORMAL_WORDS];
            const mesh::Direction& n = cases[i].direction;
            const auto error = [&](const uint32_t* code) {
                return mesh::angle_between(mesh::unpack_octahedral(code_at(code, bits), bits), n);
            };
            rounded = std::max(rounded, error(words + 9));
            nearest = std::max(nearest, error(words + 11));
            if (n[2] < 0) continue;
            const mesh::Direction upper = mesh::unpack_hemisphere(code_at(words + 13, bits), bits);
            hemisphere = std::max(hemisphere, mesh::angle_between(upper, n));
        }
        EXPECT_LT(rounded, std::sqrt(18.0) / 2 * step * 1.005 + kRounding) << bits;
        EXPECT_LT(nearest, std::numbers::sqrt2 * step * 1.005 + kRounding) << bits;
        EXPECT_LT(hemisphere, std::sqrt(6.0) / 2 * step * 1.005 + kRounding) << bits;
    }
}

TEST_F(NormalTwin, WrittenCodesOfAxesAreExactAndThoseOfNoDirectionAreUp) {
    for (const uint32_t bits : {2U, 8U, 16U, 22U}) {
        std::vector<NormalCase> cases = {{0, {0, 0, 0}}};
        for (size_t axis = 0; axis < 3; ++axis) {
            for (const double length : {1.0, -1.0, 1e-20, -1e20}) {
                cases.push_back({});
                cases.back().direction[axis] = length;
            }
        }
        const std::vector<uint32_t> gpu = on_gpu(cases, bits);
        for (size_t i = 0; i < cases.size(); ++i) {
            const mesh::Direction expected = mesh::unit_direction(cases[i].direction);
            for (const size_t at : {9, 11}) {
                const uint64_t code = code_at(&gpu[i * TWIN_NORMAL_WORDS + at], bits);
                EXPECT_EQ(mesh::unpack_octahedral(code, bits), expected) << bits << " bits, case " << i;
            }
        }
    }
}

}  // namespace
}  // namespace citystream::client::test
