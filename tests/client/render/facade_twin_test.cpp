// Lookups and rays of every facade renderer on the GPU: lookups bit for bit like the matrices, rays like the
// double-precision reference.
#include <algorithm>
#include <bit>
#include <cstdio>

#include "client/render/facade_map_facts.h"
#include "client/render/facade_renderer_layout.h"
#include "codec/facade/facade_form.h"
#include "shaders/twin_facade_bcfdm.comp.h"
#include "shaders/twin_facade_bcrm.comp.h"
#include "shaders/twin_facade_cfdm.comp.h"
#include "shaders/twin_facade_crm.comp.h"
#include "shaders/twin_facade_fdm.comp.h"
#include "shaders/twin_facade_max_mip.comp.h"
#include "shaders/twin_facade_patch.comp.h"
#include "shaders/twin_facade_quotient.comp.h"
#include "shaders/twin_facade_rm.comp.h"
#include "shaders/twin_label_bcfdm.comp.h"
#include "shaders/twin_label_bcrm.comp.h"
#include "shaders/twin_label_cfdm.comp.h"
#include "shaders/twin_label_crm.comp.h"
#include "shaders/twin_label_fdm.comp.h"
#include "shaders/twin_label_max_mip.comp.h"
#include "shaders/twin_label_patch.comp.h"
#include "shaders/twin_label_quotient.comp.h"
#include "shaders/twin_label_rm.comp.h"
#include "tests/client/render/facade_scene.h"
#include "tests/client/render/gpu_twin.h"
#include "tests/shaders/facade_rays.h"

namespace citystream::client::test {
namespace {

using codec::facade::FacadeForm;
using codec::facade::RunGrid;
using shaders_test::CastResult;
using shaders_test::FacadeCase;
using shaders_test::Ray;
using shaders_test::RayJudge;
using shaders_test::RayTally;

struct TwinCode {
    std::span<const uint32_t> cast, label;
};

/// By caster (facade_renderer_layout.h).
const TwinCode kTwinCode[] = {
    {k_twin_facade_patch_comp, k_twin_label_patch_comp},
    {k_twin_facade_max_mip_comp, k_twin_label_max_mip_comp},
    {k_twin_facade_rm_comp, k_twin_label_rm_comp},
    {k_twin_facade_fdm_comp, k_twin_label_fdm_comp},
    {k_twin_facade_crm_comp, k_twin_label_crm_comp},
    {k_twin_facade_bcrm_comp, k_twin_label_bcrm_comp},
    {k_twin_facade_cfdm_comp, k_twin_label_cfdm_comp},
    {k_twin_facade_bcfdm_comp, k_twin_label_bcfdm_comp},
    {k_twin_facade_quotient_comp, k_twin_label_quotient_comp},
};
static_assert(std::size(kTwinCode) == FACADE_RENDERER_COUNT);

/// The forms in which a renderer gets maps: its own and the fallback of a map that this refuses.
std::vector<FacadeForm> forms_of(FacadeRenderer renderer) {
    const auto own = form_for(renderer);
    if (!own) return {FacadeForm::kPatch, FacadeForm::kQuotient, FacadeForm::kTiled};
    if (*own == FacadeForm::kRaw || *own == FacadeForm::kMaxMip) return {*own};
    return {*own, FacadeForm::kRaw};
}

std::vector<FacadeCase> facades() {
    std::vector<FacadeCase> cases = shaders_test::awkward_facades();
    for (uint32_t i = 0; i < 6; ++i) {
        cases.push_back({"random " + std::to_string(i),
                         shaders_test::random_facade(i, 200 + 150 * i, 300 + 100 * i, 4 + 6 * i, i % 2 == 1)});
    }
    return cases;
}

class FacadeTwin : public GpuTwin, public testing::WithParamInterface<FacadeRenderer> {
  protected:
    /// Every facade in every form in which the renderer gets it.
    template <typename Visit>
    void for_each_map(Visit visit) {
        bool scattered = false;
        for (const FacadeCase& facade : facades()) {
            for (const FacadeForm form : forms_of(GetParam())) {
                const auto words = codec::facade::encode_form(form, facade.grid);
                if (!words) continue;
                const LayerId layer = upload_words(*words, scattered);
                scattered = !scattered;
                const auto caster = caster_for(GetParam(), static_cast<uint32_t>(form));
                ASSERT_TRUE(caster.has_value());
                visit(facade, facade.name + ", " + std::string(codec::facade::form_name(form)), layer,
                      kTwinCode[*caster]);
                forget_layers();
            }
        }
    }
};

TEST_P(FacadeTwin, LooksUpTheSameLabels) {
    Random random;
    uint64_t texels = 0;
    for_each_map([&](const FacadeCase& facade, const std::string& name, LayerId layer, const TwinCode& code) {
        const auto matrices = codec::facade::expand(facade.grid);
        const size_t all = matrices.displacement_mm.size();
        std::vector<uint32_t> places;
        for (size_t i = 0; i < std::min<size_t>(all, 60000); ++i) {
            const uint32_t texel = all <= 60000 ? static_cast<uint32_t>(i) : random.below(static_cast<uint32_t>(all));
            places.push_back(texel % matrices.width | texel / matrices.width << 16);
        }
        TwinConstants constants{};
        constants.count = static_cast<uint32_t>(places.size());
        const std::vector<uint32_t> labels = run(code.label, layer, constants, 1, places);
        for (size_t i = 0; i < places.size(); ++i) {
            const size_t texel = size_t{places[i] >> 16} * matrices.width + (places[i] & 0xffffu);
            ASSERT_EQ(labels[i], codec::facade::make_label(matrices.displacement_mm[texel], matrices.material[texel]))
                << name << " texel " << (places[i] & 0xffffu) << ", " << (places[i] >> 16);
        }
        texels += places.size();
    });
    EXPECT_GT(texels, 100000u);
}

class FacadeRayTwin : public FacadeTwin {};

TEST_P(FacadeRayTwin, CastsRaysLikeTheReference) {
    constexpr size_t kRays = 1000000;
    size_t maps = 0;
    for (const FacadeCase& facade : facades()) {
        for (const FacadeForm form : forms_of(GetParam())) maps += encode_form(form, facade.grid).ok() ? 1 : 0;
    }
    RayTally ordinary, on_edges;
    uint32_t seed = 100;
    for_each_map([&](const FacadeCase& facade, const std::string& name, LayerId layer, const TwinCode& code) {
        const std::vector<Ray> rays = shaders_test::rays_at(facade.grid, ++seed, kRays / maps + 1);
        std::vector<uint32_t> input;
        input.reserve(rays.size() * 6);
        for (const Ray& ray : rays) {
            for (const float c : ray) input.push_back(std::bit_cast<uint32_t>(c));
        }
        TwinConstants constants{};
        constants.count = static_cast<uint32_t>(rays.size());
        const std::vector<uint32_t> gpu = run(code.cast, layer, constants, TWIN_HIT_WORDS, input);
        const RayJudge judge(facade.grid);
        for (size_t i = 0; i < rays.size(); ++i) {
            const uint32_t* got = &gpu[i * TWIN_HIT_WORDS];
            const CastResult hit{got[0] != 0, std::bit_cast<float>(got[1]), got[2], static_cast<int>(got[3] & 255u),
                                 (got[3] & 256u) != 0 ? 1 : -1};
            (shaders_test::is_on_edges(i) ? on_edges : ordinary).add(judge, rays[i], hit, name);
        }
    });
    expect_exact(ordinary, on_edges);
    EXPECT_GE(ordinary.rays + on_edges.rays, kRays);
    std::printf("{\"renderer\":\"%s\",\"rays\":%llu,\"near_edges\":%llu,\"mismatches\":%llu}\n",
                std::string(facade_renderer_name(GetParam())).c_str(),
                static_cast<unsigned long long>(ordinary.rays + on_edges.rays),
                static_cast<unsigned long long>(ordinary.near_edges + on_edges.near_edges),
                static_cast<unsigned long long>(ordinary.wrong + on_edges.wrong));
    RecordProperty("rays", std::to_string(ordinary.rays + on_edges.rays));
    RecordProperty("near_edges", std::to_string(ordinary.near_edges));
}

std::string test_name(const testing::TestParamInfo<FacadeRenderer>& row) {
    std::string name(facade_renderer_name(row.param));
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}
INSTANTIATE_TEST_SUITE_P(Renderers, FacadeTwin, testing::ValuesIn(kFacadeRenderers), test_name);
INSTANTIATE_TEST_SUITE_P(Renderers, FacadeRayTwin, testing::ValuesIn(kExactRenderers), test_name);

}  // namespace
}  // namespace citystream::client::test
