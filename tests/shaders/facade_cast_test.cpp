// The facade shaders, compiled as C++, against the double-precision reference: lookups bit for bit, rays on every shape
// that breaks casters.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

#include "codec/facade/facade_form.h"
#include "tests/shaders/facade_on_cpu.h"
#include "tests/shaders/facade_rays.h"

namespace citystream::shaders_test {
namespace {

using client::FacadeRenderer;
using codec::facade::FacadeForm;
using codec::facade::RunGrid;

/// The forms in which a renderer gets maps: its own and the fallback of a map that this refuses.
std::vector<FacadeForm> forms_of(FacadeRenderer renderer) {
    const auto own = client::form_for(renderer);
    if (!own) return {FacadeForm::kPatch, FacadeForm::kQuotient, FacadeForm::kTiled};
    if (*own == FacadeForm::kRaw || *own == FacadeForm::kMaxMip) return {*own};
    return {*own, FacadeForm::kRaw};
}

constexpr FacadeRenderer kExactRenderers[] = {FacadeRenderer::kPatch, FacadeRenderer::kMaxMip, FacadeRenderer::kFdm,
                                              FacadeRenderer::kCfdm, FacadeRenderer::kBcfdm};

std::vector<FacadeCase> facades() {
    std::vector<FacadeCase> cases = awkward_facades();
    for (uint32_t i = 0; i < 6; ++i)
        cases.push_back(
            {"random " + std::to_string(i), random_facade(i, 90 + 70 * i, 140 + 50 * i, 4 + 12 * i, i % 2 == 1)});
    return cases;
}

/// Words of a facade in a form; empty when the form refuses it.
std::vector<uint32_t> words_in(FacadeForm form, const RunGrid& grid) {
    const auto words = codec::facade::encode_form(form, grid);
    return words ? *words : std::vector<uint32_t>();
}

CastResult result_of(const ShaderHit& hit) {
    return {hit.hit, hit.t, hit.label, hit.axis, hit.side};
}

class FormLookup : public testing::TestWithParam<FacadeForm> {};

TEST_P(FormLookup, GivesEveryTexelOfEveryFacade) {
    size_t encoded = 0;
    for (const FacadeCase& facade : facades()) {
        const std::vector<uint32_t> words = words_in(GetParam(), facade.grid);
        if (words.empty()) continue;
        ++encoded;
        const auto matrices = codec::facade::expand(facade.grid);
        for (uint32_t y = 0; y < matrices.height; ++y) {
            for (uint32_t x = 0; x < matrices.width; ++x) {
                const size_t i = size_t{y} * matrices.width + x;
                const uint32_t want = codec::facade::make_label(matrices.displacement_mm[i], matrices.material[i]);
                ASSERT_EQ(lookup_on_cpu(words, x, y), want) << facade.name << " texel " << x << ", " << y;
            }
        }
    }
    EXPECT_GE(encoded, 5u);
}

INSTANTIATE_TEST_SUITE_P(Forms, FormLookup, testing::ValuesIn(codec::facade::kFacadeForms), [](const auto& row) {
    std::string name(codec::facade::form_name(row.param));
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

class RendererCast : public testing::TestWithParam<FacadeRenderer> {};

TEST_P(RendererCast, HitsWhatTheReferenceHits) {
    RayTally ordinary, on_edges;
    ShaderCost cost;
    uint32_t seed = 0;
    for (const FacadeCase& facade : facades()) {
        const RayJudge judge(facade.grid);
        const std::vector<Ray> rays = rays_at(facade.grid, ++seed, 10000);
        for (const FacadeForm form : forms_of(GetParam())) {
            const std::vector<uint32_t> words = words_in(form, facade.grid);
            if (words.empty()) continue;
            const std::string name = facade.name + ", " + std::string(codec::facade::form_name(form));
            for (size_t i = 0; i < rays.size(); ++i) {
                const ShaderHit hit = cast_on_cpu(GetParam(), words, rays[i].data(), rays[i].data() + 3, 0, 0, &cost);
                (is_on_edges(i) ? on_edges : ordinary).add(judge, rays[i], result_of(hit), name);
            }
        }
    }
    expect_exact(ordinary, on_edges);
    const auto rays = static_cast<double>(ordinary.rays + on_edges.rays);
    std::printf("%.2f loads and %.2f steps a ray\n", static_cast<double>(cost.loads) / rays,
                static_cast<double>(cost.steps) / rays);
}

INSTANTIATE_TEST_SUITE_P(Renderers, RendererCast, testing::ValuesIn(kExactRenderers), [](const auto& row) {
    std::string name(client::facade_renderer_name(row.param));
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

/// Whether the label is that of a texel within float's rounding of where the ray is.
bool is_label_at(const codec::facade::FacadeMatrices& facade, const Ray& ray, const ShaderHit& hit) {
    for (const float du : {-0.01f, 0.01f}) {
        for (const float dv : {-0.01f, 0.01f}) {
            const float u = ray[0] + hit.t * ray[3] + du, v = ray[1] + hit.t * ray[4] + dv;
            const auto x = static_cast<uint32_t>(std::clamp(u, 0.0f, static_cast<float>(facade.width - 1)));
            const auto y = static_cast<uint32_t>(std::clamp(v, 0.0f, static_cast<float>(facade.height - 1)));
            const size_t i = size_t{y} * facade.width + x;
            if (hit.label == codec::facade::make_label(facade.displacement_mm[i], facade.material[i])) return true;
        }
    }
    return false;
}

// The stated fallback (facade_stuck): the front of the cell where the ray is, so that there is no hole and no endless
// loop.
TEST_P(RendererCast, EndsAtItsStepBoundOnTheFrontOfTheCellWhereTheRayIs) {
    const RunGrid grid = random_facade(5, 400, 300, 16);
    const codec::facade::FacadeMatrices matrices = codec::facade::expand(grid);
    const std::vector<Ray> rays = rays_at(grid, 9, 2000);
    for (const FacadeForm form : forms_of(GetParam())) {
        const std::vector<uint32_t> words = words_in(form, grid);
        ASSERT_FALSE(words.empty());
        size_t stuck = 0;
        for (const uint32_t bound : {0u, 1u, 2u, 3u, 5u, 8u}) {
            for (size_t i = 0; i < rays.size(); ++i) {
                const float *origin = rays[i].data(), *direction = origin + 3;
                const ShaderHit whole = cast_on_cpu(GetParam(), words, origin, direction);
                limit_steps_on_cpu(bound);
                ShaderCost cost;
                const ShaderHit hit = cast_on_cpu(GetParam(), words, origin, direction, 0, 0, &cost);
                limit_steps_on_cpu();
                ASSERT_LE(cost.steps, bound + 3) << "ray " << i;  // a band's, a stripe's and a cell's beyond the bound
                const bool is_whole = hit.hit == whole.hit && hit.t == whole.t && hit.label == whole.label;
                if (is_whole) continue;
                ++stuck;
                ASSERT_TRUE(hit.hit) << "a hole at ray " << i << ", bound " << bound;
                EXPECT_EQ(hit.axis, 2);
                EXPECT_EQ(hit.side, 1);
                EXPECT_TRUE(!whole.hit || hit.t <= whole.t) << "ray " << i << " went on through what it meets";
                EXPECT_TRUE(is_label_at(matrices, rays[i], hit)) << "ray " << i << ", bound " << bound;
            }
        }
        EXPECT_GT(stuck, rays.size() / 20) << codec::facade::form_name(form);
        std::printf("%s: %zu rays met the bound\n", std::string(codec::facade::form_name(form)).c_str(), stuck);
    }
}

// Relief mapping's error: the share of rays that it gets wrong by their angle from the normal, over a facade of
// windows.
TEST(ReliefMapping, MissesMoreTheFlatterTheRay) {
    const RunGrid grid = random_facade(7, 600, 800, 90);
    const std::vector<uint32_t> words = words_in(FacadeForm::kRaw, grid);
    const RayJudge judge(grid);
    const auto depths = grid.depths();
    double last = 0;
    for (const int degrees : {0, 30, 60, 80, 85}) {
        const double angle = degrees * 3.14159265358979323846 / 180;
        int wrong = 0;
        constexpr int kRays = 4000;
        for (int i = 0; i < kRays; ++i) {
            const double azimuth = i * 2.399963229728653;  // golden angle
            const double u = 600 * std::fmod(i * 0.7548776662466927, 1.0),
                         v = 800 * std::fmod(i * 0.5698402909980532, 1.0);
            // From the top of the volume; 10 mm a texel.
            const Ray ray = {static_cast<float>(u),
                             static_cast<float>(v),
                             static_cast<float>(depths.max_mm),
                             static_cast<float>(std::sin(angle) * std::cos(azimuth) * 100),
                             static_cast<float>(std::sin(angle) * std::sin(azimuth) * 100),
                             static_cast<float>(-std::cos(angle) * 1000)};
            const ShaderHit got = cast_on_cpu(FacadeRenderer::kRm, words, ray.data(), ray.data() + 3);
            const auto want = judge.reference(ray);
            wrong += got.hit != want.hit || (got.hit && got.label != want.label) ? 1 : 0;
        }
        const double share = static_cast<double>(wrong) / kRays;
        std::printf("relief mapping at %d degrees: %.2f %% of rays hit another surface than there is\n", degrees,
                    100 * share);
        if (degrees == 0) {
            EXPECT_EQ(wrong, 0);
        }
        if (degrees == 80) {
            EXPECT_GT(share, 0.01) << "a sampled search must miss what is thin";
        }
        EXPECT_GE(share, last * 0.8);
        last = share;
    }
}

// Maps with flipped bits that the check lets pass are looked up and cast within their words, and every ray ends.
TEST(DamagedMaps, ThatPassTheCheckAreCastInsideTheirWords) {
    const RunGrid grid = random_facade(3, 90, 120, 14, true);
    const std::vector<Ray> rays = rays_at(grid, 5, 24);
    std::mt19937 engine(11);
    const auto draw = [&] { return static_cast<uint32_t>(engine()); };
    size_t passed = 0, damaged = 0;
    for (const FacadeRenderer renderer : client::kFacadeRenderers) {
        for (const FacadeForm form : forms_of(renderer)) {
            const std::vector<uint32_t> whole = words_in(form, grid);
            for (int i = 0; i < 1500 && !whole.empty(); ++i) {
                std::vector<uint32_t> words = whole;
                // Most flips in the head and the tables behind it, where they do most.
                for (uint32_t flips = 1 + draw() % 3; flips > 0; --flips) {
                    const size_t range = draw() % 2 == 0 ? std::min<size_t>(words.size(), 64) : words.size();
                    words[draw() % range] ^= 1u << draw() % 32;
                }
                ++damaged;
                if (!codec::facade::check_form(words).ok()) continue;
                ++passed;
                for (const Ray& ray : rays)
                    ASSERT_NO_THROW(cast_on_cpu(renderer, words, ray.data(), ray.data() + 3, 0, 0.1f)) << i;
                ASSERT_NO_THROW(lookup_on_cpu(words, (words[1] & 0xffffu) - 1, (words[1] >> 16) - 1)) << i;
            }
        }
    }
    EXPECT_GT(passed, 100u);
    std::printf("%zu damaged maps, %zu passed the check\n", damaged, passed);
}

}  // namespace
}  // namespace citystream::shaders_test
