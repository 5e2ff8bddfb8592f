// What a draw binds: pictures are read from memory by address, so that no pass takes a texture unit, however many
// atlases and charts its tile shows. (The paper binds one texture a node, at most 16 a frame.)
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <initializer_list>
#include <set>
#include <span>

#include "client/render/facade_renderer_layout.h"
#include "client/render/facade_shaders.h"
#include "shaders/facade_occluder.vert.h"
#include "shaders/mesh.frag.h"
#include "shaders/mesh.vert.h"
#include "shaders/mesh_lit.frag.h"
#include "shaders/mesh_lit.vert.h"
#include "shaders/mesh_shadow.vert.h"
#include "shaders/sky.frag.h"

namespace citystream::client {
namespace {

// SPIR-V, sections 2.3, 3.20, 3.42.6 and 3.42.3.
constexpr uint32_t kMagic = 0x07230203, kHeaderWords = 5, kDecorate = 71, kBinding = 33;
constexpr std::initializer_list<uint32_t> kImageTypes = {25, 26, 27};  // OpTypeImage, OpTypeSampler, OpTypeSampledImage

struct Bound {
    size_t images = 0, bindings = 0, instructions = 0;
};

Bound bound_by(std::span<const uint32_t> module) {
    EXPECT_EQ(module[0], kMagic);
    Bound bound;
    for (size_t at = kHeaderWords; at < module.size();) {
        const uint32_t operation = module[at] & 0xffff, words = module[at] >> 16;
        if (words == 0 || at + words > module.size()) {
            ADD_FAILURE() << "not a module";
            return bound;
        }
        ++bound.instructions;
        bound.images += std::ranges::count(kImageTypes, operation);
        bound.bindings += operation == kDecorate && words > 2 && module[at + 2] == kBinding ? 1 : 0;
        at += words;
    }
    return bound;
}

void expect_nothing_bound(std::span<const uint32_t> module) {
    const Bound bound = bound_by(module);
    EXPECT_GT(bound.instructions, 50U);
    EXPECT_EQ(bound.images, 0U);
    EXPECT_EQ(bound.bindings, 0U);
}

TEST(TextureUnits, OfAModuleThatTakesOneAreFound) {
    // Types of an image and of a sampler with it, and "binding = 0".
    const uint32_t module[] = {kMagic, 0,        0, 0, 0, 2U << 16 | 25, 1, 3U << 16 | 27, 2, 1, 4U << 16 | kDecorate,
                               3,      kBinding, 0};
    EXPECT_EQ(bound_by(module).images, 2U);
    EXPECT_EQ(bound_by(module).bindings, 1U);
}

TEST(TextureUnits, ADrawTakesNone) {
    expect_nothing_bound(k_mesh_vert);
    expect_nothing_bound(k_mesh_frag);
    expect_nothing_bound(k_facade_occluder_vert);
    for (uint32_t caster = 0; caster < FACADE_RENDERER_COUNT; ++caster) {
        for (const bool lit : {false, true}) {
            const FacadeShaders shaders = facade_shaders(caster, lit);
            expect_nothing_bound(shaders.vertex);
            expect_nothing_bound(shaders.fragment);
            expect_nothing_bound(shaders.keyed_fragment);
        }
    }
}

TEST(TextureUnits, ADrawInAFrameWithALightTakesNone) {
    expect_nothing_bound(k_mesh_lit_vert);
    expect_nothing_bound(k_mesh_lit_frag);
    expect_nothing_bound(k_mesh_shadow_vert);
    expect_nothing_bound(k_sky_frag);
}

}  // namespace
}  // namespace citystream::client
