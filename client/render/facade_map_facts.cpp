#include "client/render/facade_map_facts.h"

#include <map>

#include "client/render/facade_renderer_layout.h"
#include "codec/facade/facade_form.h"
#include "codec/radiance/btf.h"

namespace citystream::client {

using codec::facade::FacadeForm;
using codec::facade::RunGrid;

namespace {

/// Of a facade's area: window frames cover some hundredths, single slivers less.
constexpr double kNegligibleShare = 0.01;

}  // namespace

FacadeMapFacts facade_map_facts(std::span<const uint32_t> words) {
    if (words.empty() || (words[FACADE_FORM_WORD_FORM] & 0xffffu) != FACADE_FORM_MAGIC) return {};
    const auto grid = codec::facade::decode_form(words);
    FacadeMapFacts facts;
    facts.form = words[FACADE_FORM_WORD_FORM] >> 16;
    if (!grid.ok()) return facts;
    facts.size = {grid->width(), grid->height()};
    facts.is_opaque = !grid->has_open_cells();
    facts.slots = codec::radiance::palette_slots(*grid);
    facts.finest = {finest_run(*grid, 0), finest_run(*grid, 1)};
    return facts;
}

float finest_run(const RunGrid& grid, int axis) {
    const std::vector<uint32_t>& along = axis == 0 ? grid.x_breaks : grid.y_breaks;
    const std::vector<uint32_t>& across = axis == 0 ? grid.y_breaks : grid.x_breaks;
    const auto label = [&](size_t i, size_t line) {
        return axis == 0 ? grid.label(static_cast<uint32_t>(i), static_cast<uint32_t>(line))
                         : grid.label(static_cast<uint32_t>(line), static_cast<uint32_t>(i));
    };
    std::map<uint32_t, uint64_t> area_of_width;
    for (size_t line = 0; line + 1 < across.size(); ++line) {
        for (size_t begin = 0, end = 0; begin + 1 < along.size(); begin = end) {
            for (end = begin + 1; end + 1 < along.size() && label(end, line) == label(begin, line);) ++end;
            const uint32_t width = along[end] - along[begin];
            area_of_width[width] += uint64_t{width} * (across[line + 1] - across[line]);
        }
    }
    const auto negligible = static_cast<uint64_t>(kNegligibleShare * grid.width() * grid.height());
    uint64_t covered = 0;
    for (const auto& [width, area] : area_of_width) {
        covered += area;
        if (covered > negligible) return static_cast<float>(width);
    }
    return static_cast<float>(along.back());
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
