// What the renderer must know of a facade map before it draws it: found when its words are uploaded.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "client/render/facade_renderer.h"

namespace citystream::client {

struct FacadeMapFacts {
    uint32_t form = 0;       ///< FACADE_FORM_..., 0: no facade map
    bool is_opaque = false;  ///< no open cells: whoever looks through its front does not see what is behind its back
};

/// Of the words of any layer. A map that does not decode is not opaque.
FacadeMapFacts facade_map_facts(std::span<const uint32_t> words);

/// Which compiled caster (a number of facade_renderer_layout.h) draws maps of a form; none: they are not drawn.
std::optional<uint32_t> caster_for(FacadeRenderer renderer, uint32_t form);

}  // namespace citystream::client
