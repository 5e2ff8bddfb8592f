// What must hold for the forms of the run grid, quotient and tiled: exact on every input, whole groups of words, and no
// reader leaves damaged words.
#include <gtest/gtest.h>

#include "codec/facade/quotient_map.h"
#include "codec/facade/tiled_map.h"
#include "tests/codec/damage.h"
#include "tests/codec/facade/relief_cases.h"
#include "tests/shaders/facade_on_cpu.h"

namespace citystream::codec::facade {
namespace {

using Words = std::span<const uint32_t>;

struct RunForm {
    const char* name;
    Result<std::vector<uint32_t>> (*encode)(const RunGrid&);
    Status (*check)(Words);
    Result<RunGrid> (*decode)(Words);
    uint32_t (*label)(Words, uint32_t x, uint32_t y);
};

constexpr RunForm kRunForms[] = {
    {"Quotient", encode_quotient_map, check_quotient_map, decode_quotient_map, quotient_label},
    {"Tiled", encode_tiled_map, check_tiled_map, decode_tiled_map, tiled_label}};

class RunForms : public testing::TestWithParam<RunForm> {
  protected:
    static std::vector<uint32_t> words_of(const FacadeMatrices& relief) {
        return GetParam().encode(make_run_grid(relief).value()).value();
    }

    static void expect_exact(const FacadeMatrices& relief, const std::string& name) {
        const RunGrid grid = make_run_grid(relief).value();
        const std::vector<uint32_t> words = exact_copy(words_of(relief));
        EXPECT_EQ(words.size() % 4, 0u) << name;
        const auto back = GetParam().decode(words);
        ASSERT_TRUE(back.ok()) << name << ": " << back.error().text();
        EXPECT_EQ(*back, grid) << name;
        for (uint32_t y = 0; y < relief.height; y += 1 + relief.height / 64) {
            for (uint32_t x = 0; x < relief.width; x += 1 + relief.width / 64) {
                const size_t i = size_t{y} * relief.width + x;
                const uint32_t label = make_label(relief.displacement_mm[i], relief.material[i]);
                ASSERT_EQ(GetParam().label(words, x, y), label) << name << " " << x << ", " << y;
                ASSERT_EQ(shaders_test::lookup_on_cpu(words, x, y), label) << name << " " << x << ", " << y;
            }
        }
    }
};

TEST_P(RunForms, KeepsEveryEntryOfAllShapes) {
    for (const ReliefCase& relief : small_reliefs()) expect_exact(relief.relief, relief.name);
    for (const ReliefCase& relief : large_reliefs()) expect_exact(relief.relief, relief.name);
    expect_exact(noise_relief(97, 61, -32768, 32767, 65536), "all different at full range");
    expect_exact(noise_relief(300, 200, 0, 4, 1), "noise of five labels");
    expect_exact(noise_relief(8192, 3, -1, 1, 2), "widest");
}

TEST_P(RunForms, RefusesEveryTruncationAndFollowingWords) {
    const auto words = words_of(window_relief(80, 100, 3, true));
    for (size_t size = 0; size < words.size(); ++size)
        EXPECT_FALSE(GetParam().check(exact_copy(std::span(words).first(size))).ok()) << size;
    for (const size_t more : {1u, 4u, 8u}) {
        auto longer = words;
        longer.resize(words.size() + more, 0);
        EXPECT_FALSE(GetParam().check(longer).ok());
    }
}

TEST_P(RunForms, NoDamagedWordMakesALookupReadOutside) {
    size_t accepted = 0, refused = 0;
    for (const auto& relief : {window_relief(40, 60, 3, true), noise_relief(9, 7, -3, 3, 1)}) {
        for_each_mutation(words_of(relief), [&](Words damaged) {
            const bool ok = GetParam().check(damaged).ok();
            ++(ok ? accepted : refused);
            if (!ok) return;
            const auto grid = GetParam().decode(damaged);
            ASSERT_TRUE(grid.ok());
            for (uint32_t y = 0; y < grid->height(); y += 5) {
                for (uint32_t x = 0; x < grid->width(); x += 5)
                    ASSERT_EQ(GetParam().label(damaged, x, y), shaders_test::lookup_on_cpu(damaged, x, y));
            }
        });
    }
    EXPECT_GT(accepted, 0u);
    EXPECT_GT(refused, accepted);
}

INSTANTIATE_TEST_SUITE_P(Forms, RunForms, testing::ValuesIn(kRunForms),
                         [](const auto& row) { return std::string(row.param.name); });

}  // namespace
}  // namespace citystream::codec::facade
