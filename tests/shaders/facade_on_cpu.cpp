#include "tests/shaders/facade_on_cpu.h"

#include "tests/shaders/glsl_on_cpu.h"

namespace citystream::shaders_test {
namespace {

// NOLINTNEXTLINE: the shaders use GLSL's names.
using namespace citystream::glsl;

// Parts with include guards once, then all that depends on the renderer in a namespace of its own.
#include "shaders/facade_lookup_binary.glsl"
#include "shaders/facade_lookup_raw.glsl"
#include "shaders/facade_lookup_svd.glsl"
#include "shaders/facade_samples.glsl"
#include "shaders/facade_step_max_mip.glsl"
#include "shaders/facade_step_patch.glsl"
#include "shaders/facade_step_tiled.glsl"

namespace patch {
#define FACADE_RENDERER FACADE_RENDERER_PATCH
#include "shaders/facade_cast.glsl"
#undef FACADE_RENDERER
}  // namespace patch

namespace max_mip {
#define FACADE_RENDERER FACADE_RENDERER_MAX_MIP
#include "shaders/facade_cast.glsl"
#undef FACADE_RENDERER
}  // namespace max_mip

namespace rm {
#define FACADE_RENDERER FACADE_RENDERER_RM
#include "shaders/facade_cast.glsl"
#undef FACADE_RENDERER
}  // namespace rm

namespace fdm {
#define FACADE_RENDERER FACADE_RENDERER_FDM
#include "shaders/facade_cast.glsl"
#undef FACADE_RENDERER
}  // namespace fdm

namespace crm {
#define FACADE_RENDERER FACADE_RENDERER_CRM
#include "shaders/facade_cast.glsl"
#undef FACADE_RENDERER
}  // namespace crm

namespace bcrm {
#define FACADE_RENDERER FACADE_RENDERER_BCRM
#include "shaders/facade_cast.glsl"
#undef FACADE_RENDERER
}  // namespace bcrm

namespace cfdm {
#define FACADE_RENDERER FACADE_RENDERER_CFDM
#include "shaders/facade_cast.glsl"
#undef FACADE_RENDERER
}  // namespace cfdm

namespace bcfdm {
#define FACADE_RENDERER FACADE_RENDERER_BCFDM
#include "shaders/facade_cast.glsl"
#undef FACADE_RENDERER
}  // namespace bcfdm

namespace quotient {
#define FACADE_RENDERER FACADE_RENDERER_QUOTIENT
#include "shaders/facade_cast.glsl"
#undef FACADE_RENDERER
}  // namespace quotient

FacadeHit cast(client::FacadeRenderer renderer, FacadeMap map, vec3 origin, vec3 direction, float begin, float margin) {
#define CAST_WITH(caster) \
    if (caster::facade_form_is_known(map)) return caster::cast_facade_ray(map, origin, direction, begin, margin)
    switch (renderer) {
        case client::FacadeRenderer::kPatch:
            CAST_WITH(patch);
            CAST_WITH(quotient);
            break;
        case client::FacadeRenderer::kMaxMip:
            CAST_WITH(max_mip);
            break;
        case client::FacadeRenderer::kRm:
            CAST_WITH(rm);
            break;
        case client::FacadeRenderer::kFdm:
            CAST_WITH(fdm);
            break;
        case client::FacadeRenderer::kCrm:
            CAST_WITH(crm);
            break;
        case client::FacadeRenderer::kBcrm:
            CAST_WITH(bcrm);
            break;
        case client::FacadeRenderer::kCfdm:
            CAST_WITH(cfdm);
            break;
        case client::FacadeRenderer::kBcfdm:
            CAST_WITH(bcfdm);
            break;
    }
#undef CAST_WITH
    return facade_miss();
}

void forget_counts() {
    counted_loads = counted_words = counted_steps = 0;
}

void add_counts(ShaderCost* cost) {
    if (cost == nullptr) return;
    cost->loads += counted_loads;
    cost->words += counted_words;
    cost->steps += counted_steps;
}

}  // namespace

ShaderHit cast_on_cpu(client::FacadeRenderer renderer, std::span<const uint32_t> words, const float origin[3],
                      const float direction[3], float begin, float margin, ShaderCost* cost) {
    const FacadeMap map = facade_map(layer_reference(words));
    forget_counts();
    const FacadeHit hit = cast(renderer, map, vec3(origin[0], origin[1], origin[2]),
                               vec3(direction[0], direction[1], direction[2]), begin, margin);
    add_counts(cost);
    return {hit.hit, hit.t, hit.label, hit.axis, hit.side > 0 ? 1 : -1, hit.at_edge};
}

void limit_steps_on_cpu(uint32_t most) {
    step_limit = most;
}

uint32_t lookup_on_cpu(std::span<const uint32_t> words, uint32_t x, uint32_t y, ShaderCost* cost) {
    const FacadeMap map = facade_map(layer_reference(words));
    forget_counts();
    uint32_t label = 0;
    switch (map_form(map)) {
        case FACADE_FORM_PATCH:
            label = lookup_patch(map, x, y);
            break;
        case FACADE_FORM_QUOTIENT:
            label = lookup_quotient(map, x, y);
            break;
        case FACADE_FORM_TILED:
            label = lookup_tiled(map, x, y);
            break;
        case FACADE_FORM_RAW:
            label = lookup_raw(map, x, y);
            break;
        case FACADE_FORM_MAX_MIP:
            label = lookup_max_mip(map, x, y);
            break;
        case FACADE_FORM_SVD:
            label = lookup_svd(map, x, y);
            break;
        case FACADE_FORM_BINARY:
            label = lookup_binary(map, x, y);
            break;
        default:
            throw std::invalid_argument("no lookup for form " + std::to_string(map_form(map)));
    }
    add_counts(cost);
    return label;
}

std::array<float, 2> sample_offset_on_cpu(uint32_t i, uint32_t count) {
    const vec2 offset = facade_sample_offset(i, count);
    return {offset.x, offset.y};
}

uint32_t sample_count_on_cpu(const float ray[3], const float right[3], const float down[3], float t,
                             const float finest[2], uint32_t most) {
    const auto vector = [](const float v[3]) { return vec3(v[0], v[1], v[2]); };
    return facade_sample_count(facade_footprint(vector(ray), vector(right), vector(down), t),
                               vec2(finest[0], finest[1]), most);
}

client::FacadeRenderer exact_renderer_of(codec::facade::FacadeForm form) {
    switch (form) {
        case codec::facade::FacadeForm::kRaw:
            return client::FacadeRenderer::kFdm;
        case codec::facade::FacadeForm::kMaxMip:
            return client::FacadeRenderer::kMaxMip;
        case codec::facade::FacadeForm::kSvd:
            return client::FacadeRenderer::kCfdm;
        case codec::facade::FacadeForm::kBinary:
            return client::FacadeRenderer::kBcfdm;
        default:
            return client::FacadeRenderer::kPatch;
    }
}

}  // namespace citystream::shaders_test
