#include "client/render/facade_map_facts.h"

#include "client/render/facade_renderer_layout.h"
#include "codec/facade/facade_form.h"

namespace citystream::client {

using codec::facade::FacadeForm;

FacadeMapFacts facade_map_facts(std::span<const uint32_t> words) {
    if (words.empty() || (words[FACADE_FORM_WORD_FORM] & 0xffffu) != FACADE_FORM_MAGIC) return {};
    const auto grid = codec::facade::decode_form(words);
    return {words[FACADE_FORM_WORD_FORM] >> 16, grid.ok() && !grid->has_open_cells()};
}

std::optional<uint32_t> caster_for(FacadeRenderer renderer, uint32_t form) {
    if (renderer == FacadeRenderer::kPatch) {
        if (form == FACADE_FORM_PATCH) return FACADE_RENDERER_PATCH;
        if (form == FACADE_FORM_QUOTIENT || form == FACADE_FORM_TILED) return FACADE_RENDERER_QUOTIENT;
        return std::nullopt;
    }
    const std::optional<FacadeForm> own = form_for(renderer);
    const bool raw_too = own != FacadeForm::kMaxMip;
    if (form != static_cast<uint32_t>(*own) && !(raw_too && form == FACADE_FORM_RAW)) return std::nullopt;
    return static_cast<uint32_t>(renderer);
}

}  // namespace citystream::client
