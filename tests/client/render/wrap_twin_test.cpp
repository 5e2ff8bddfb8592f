// Chart coordinates on the GPU against the codec and the shader's text on the CPU, through the include that draws.
#include <array>
#include <bit>
#include <cmath>

#include "codec/atlas/wrap_coordinate.h"
#include "shaders/twin_wrap.comp.h"
#include "tests/client/render/gpu_twin.h"
#include "tests/shaders/wrap_coordinate_on_cpu.h"

namespace citystream::client::test {
namespace {

constexpr uint32_t kCases = 200'000;

struct WrapCase {
    std::array<uint32_t, 2> packed;
    uint32_t border;
    bool clamp_u, clamp_v;
    std::array<float, 2> place;
    float level;
};

/// Any words; places of the packed grid, on which no float of Equation 2 is rounded, or of all bits.
WrapCase random_case(Random& random, bool on_grid) {
    const auto place = [&] {
        const float step = static_cast<float>(random.below(64 * 512)) / 512;
        return on_grid ? step : step + static_cast<float>(random.unit()) / 512;
    };
    return {{random.next(), random.next()}, random.below(5),    random.below(2) != 0,
            random.below(2) != 0,           {place(), place()}, static_cast<float>(random.unit() * 4)};
}

std::vector<uint32_t> words_of(const std::vector<WrapCase>& cases) {
    std::vector<uint32_t> words;
    for (const WrapCase& one : cases) {
        words.insert(words.end(), {one.packed[0], one.packed[1],
                                   one.border | (one.clamp_u ? 1U << 8 : 0U) | (one.clamp_v ? 1U << 9 : 0U),
                                   std::bit_cast<uint32_t>(one.place[0]), std::bit_cast<uint32_t>(one.place[1]),
                                   std::bit_cast<uint32_t>(one.level)});
    }
    return words;
}

class WrapTwin : public GpuTwin {
  protected:
    std::vector<uint32_t> on_gpu(const std::vector<WrapCase>& cases) {
        TwinConstants constants{};
        constants.count = static_cast<uint32_t>(cases.size());
        const std::vector<uint32_t> input = words_of(cases);
        return run(k_twin_wrap_comp, upload_words(std::array{0U}, false), constants, TWIN_WRAP_WORDS, input);
    }

    static std::vector<WrapCase> cases(bool on_grid) {
        Random random;
        std::vector<WrapCase> all;
        for (uint32_t i = 0; i < kCases; ++i) all.push_back(random_case(random, on_grid));
        return all;
    }

    static std::array<float, 2> texel_on_cpu(const WrapCase& one) {
        const codec::atlas::ChartFrame frame = codec::atlas::frame_of({one.packed[0], one.packed[1]}, one.border);
        return shaders_test::wrap_texel_on_cpu(
            {frame.origin_u, frame.origin_v, one.clamp_u ? -frame.size_u : frame.size_u,
             one.clamp_v ? -frame.size_v : frame.size_v},
            one.place, one.level);
    }
};

TEST_F(WrapTwin, FramesAndPlacesAreTheCodecsBitForBit) {
    const std::vector<WrapCase> all = cases(true);
    const std::vector<uint32_t> gpu = on_gpu(all);
    for (size_t i = 0; i < all.size(); ++i) {
        const auto& [u, v] = all[i].packed;
        const codec::atlas::ChartFrame frame = codec::atlas::frame_of({u, v}, all[i].border);
        const auto place = [](uint32_t word) {
            return static_cast<float>(codec::atlas::decode_wrap_axis(word, 0).place * codec::atlas::kWrapStep);
        };
        const std::array<float, 6> cpu = {frame.origin_u, frame.origin_v, frame.size_u,
                                          frame.size_v,   place(u),       place(v)};
        for (size_t k = 0; k < cpu.size(); ++k)
            ASSERT_EQ(gpu[TWIN_WRAP_WORDS * i + k], std::bit_cast<uint32_t>(cpu[k])) << "case " << i << ", " << k;
    }
}

TEST_F(WrapTwin, PlacesOfThePackedGridWrapToTheSameBits) {
    const std::vector<WrapCase> all = cases(true);
    const std::vector<uint32_t> gpu = on_gpu(all);
    for (size_t i = 0; i < all.size(); ++i) {
        const std::array<float, 2> cpu = texel_on_cpu(all[i]);
        for (size_t k = 0; k < 2; ++k)
            ASSERT_EQ(gpu[TWIN_WRAP_WORDS * i + 6 + k], std::bit_cast<uint32_t>(cpu[k])) << "case " << i;
    }
}

// A device may fuse the product and the sum of Equation 2, which rounds once instead of twice.
TEST_F(WrapTwin, AnyPlaceWrapsToTheSameTexelButForARoundingOfAFloat) {
    const std::vector<WrapCase> all = cases(false);
    const std::vector<uint32_t> gpu = on_gpu(all);
    for (size_t i = 0; i < all.size(); ++i) {
        const std::array<float, 2> cpu = texel_on_cpu(all[i]);
        for (size_t k = 0; k < 2; ++k) {
            const float ulp = std::nextafter(cpu[k], INFINITY) - cpu[k];
            ASSERT_NEAR(std::bit_cast<float>(gpu[TWIN_WRAP_WORDS * i + 6 + k]), cpu[k], ulp) << "case " << i;
        }
    }
}

}  // namespace
}  // namespace citystream::client::test
