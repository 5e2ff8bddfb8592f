#include "client/render/facade_renderer.h"

namespace citystream::client {

using codec::facade::FacadeForm;

static_assert(static_cast<int>(FacadeRenderer::kPatch) == FACADE_RENDERER_PATCH &&
              static_cast<int>(FacadeRenderer::kMaxMip) == FACADE_RENDERER_MAX_MIP &&
              static_cast<int>(FacadeRenderer::kRm) == FACADE_RENDERER_RM &&
              static_cast<int>(FacadeRenderer::kFdm) == FACADE_RENDERER_FDM &&
              static_cast<int>(FacadeRenderer::kCrm) == FACADE_RENDERER_CRM &&
              static_cast<int>(FacadeRenderer::kBcrm) == FACADE_RENDERER_BCRM &&
              static_cast<int>(FacadeRenderer::kCfdm) == FACADE_RENDERER_CFDM &&
              static_cast<int>(FacadeRenderer::kBcfdm) == FACADE_RENDERER_BCFDM);

std::string_view facade_renderer_name(FacadeRenderer renderer) {
    switch (renderer) {
        case FacadeRenderer::kPatch:
            return "patch";
        case FacadeRenderer::kMaxMip:
            return "max-mip";
        case FacadeRenderer::kRm:
            return "rm";
        case FacadeRenderer::kFdm:
            return "fdm";
        case FacadeRenderer::kCrm:
            return "crm";
        case FacadeRenderer::kBcrm:
            return "bcrm";
        case FacadeRenderer::kCfdm:
            return "cfdm";
        case FacadeRenderer::kBcfdm:
            return "bcfdm";
    }
    return "";
}

std::optional<FacadeRenderer> facade_renderer_named(std::string_view name) {
    for (const FacadeRenderer renderer : kFacadeRenderers) {
        if (facade_renderer_name(renderer) == name) return renderer;
    }
    return std::nullopt;
}

std::vector<std::string> facade_renderer_names() {
    std::vector<std::string> names;
    names.reserve(kFacadeRenderers.size());
    for (const FacadeRenderer renderer : kFacadeRenderers) names.emplace_back(facade_renderer_name(renderer));
    return names;
}

std::vector<std::string> facade_sample_names() {
    std::vector<std::string> names;
    for (const uint32_t count : kFacadeSampleCounts) names.push_back(std::to_string(count));
    return names;
}

std::optional<uint32_t> facade_samples_named(std::string_view name) {
    for (const uint32_t count : kFacadeSampleCounts) {
        if (std::to_string(count) == name) return count;
    }
    return std::nullopt;
}

std::optional<FacadeForm> form_for(FacadeRenderer renderer) {
    switch (renderer) {
        case FacadeRenderer::kPatch:
            return std::nullopt;
        case FacadeRenderer::kMaxMip:
            return FacadeForm::kMaxMip;
        case FacadeRenderer::kRm:
        case FacadeRenderer::kFdm:
            return FacadeForm::kRaw;
        case FacadeRenderer::kCrm:
        case FacadeRenderer::kCfdm:
            return FacadeForm::kSvd;
        case FacadeRenderer::kBcrm:
        case FacadeRenderer::kBcfdm:
            return FacadeForm::kBinary;
    }
    return std::nullopt;
}

}  // namespace citystream::client
