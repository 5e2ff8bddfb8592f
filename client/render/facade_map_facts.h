// What the renderer must know of a facade map before it draws it: found when its words are uploaded.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "client/render/facade_renderer.h"

namespace citystream::client {

struct FacadeMapFacts {
    uint32_t form = 0;       ///< FACADE_FORM_..., 0: no facade map
    bool is_opaque = false;  ///< no open cells: whoever looks through its front does not see what is behind its back
    uint32_t slots = 0;      ///< palette_slots (codec/radiance/btf.h)
    std::array<uint32_t, 2> size{};  ///< texels; 0, 0 of a map that does not decode
    /// Texels: the narrowest and lowest runs of equal labels that matter (finest_run).
    std::array<float, 2> finest{};
};

/// Width (`axis` 0) or height (1) of the finest runs of equal labels along rows or columns that matter: all that are
/// narrower cover less than a hundredth of the facade. O(cells log cells).
float finest_run(const codec::facade::RunGrid& grid, int axis);

/// Of the words of any layer. A map that does not decode is not opaque.
FacadeMapFacts facade_map_facts(std::span<const uint32_t> words);

/// Which compiled caster (a number of facade_renderer_layout.h) draws maps of a form; none: they are not drawn.
std::optional<uint32_t> caster_for(FacadeRenderer renderer, uint32_t form);

}  // namespace citystream::client
