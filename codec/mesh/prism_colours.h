// The colours of prisms' walls, tops and floors on the wire: mostly those of the prism that one hangs on.
//
// One template for writer and reader (range_coder.h). O(1) a prism.
#pragma once

#include <cstdint>
#include <span>

#include "codec/mesh/chart_word_code.h"
#include "codec/mesh/mesh_content.h"
#include "codec/mesh/prism_code.h"

namespace citystream::codec::mesh {

/// `prisms` in the order of `tree`. Where there is no floor, its colour is 0. False: a word names no colour.
template <typename Coder>
bool code_prism_colours(Coder& coder, const PrismTree& tree, std::span<MeshPrism> prisms) {
    enum Part : uint32_t { kWall, kTop, kFloor };
    ChartWordCode words[3];
    uint32_t history[3] = {};
    constexpr uint32_t kNone = ChartWordCode::kNone;
    bool all_colours = true;
    const auto code = [&](Part part, uint32_t& word, const std::array<uint32_t, 3>& candidates) {
        word = words[part].code(coder, history[part], candidates, word);
        history[part] = (history[part] << 1 | (word == candidates[0] ? 1 : 0)) & 15;
        all_colours = all_colours && names_colour(word);
    };
    for (size_t i = 0; i < prisms.size(); ++i) {
        MeshPrism& prism = prisms[i];
        const MeshPrism* parent = tree.parent[i] != PrismTree::kRoot ? &prisms[tree.parent[i]] : nullptr;
        const MeshPrism* last = i > 0 ? &prisms[i - 1] : nullptr;
        const uint32_t last_wall = last != nullptr ? last->wall_chart : kNone,
                       last_top = last != nullptr ? last->top_chart : kNone;
        code(kTop, prism.top_chart, {parent != nullptr ? parent->top_chart : kNone, last_top, kNone});
        code(kWall, prism.wall_chart, {parent != nullptr ? parent->wall_chart : kNone, last_wall, prism.top_chart});
        if (prism.shape.has_floor)
            code(kFloor, prism.floor_chart, {prism.top_chart, prism.wall_chart, kNone});
        else
            prism.floor_chart = 0;
    }
    return all_colours;
}

}  // namespace citystream::codec::mesh
