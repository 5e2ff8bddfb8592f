#include "codec/mesh/step_choice.h"

#include <utility>

#include "codec/mesh/lattice_code.h"

namespace citystream::codec::mesh {
namespace {

size_t cost_of(const MeshWire& wire) {
    size_t whole = 0;
    for (const auto& step : wire.steps) whole += step.size();
    return wire.steps[0].size() + kWholeToFirst * whole;
}

}  // namespace

MeshWire encode_best_steps(const MeshTile& tile, const MeshContentOptions& options) {
    MeshContentOptions tried = options;
    tried.most_steps = 1;
    KnownLattices known;
    MeshWire best = encode_mesh_wire(make_content(tile, tried), &known);
    while (tried.most_steps < options.most_steps) {
        ++tried.most_steps;
        const MeshContent content = make_content(tile, tried);
        if (content.dropped.size() < tried.most_steps) break;
        MeshWire wire = encode_mesh_wire(content, &known);
        if (cost_of(wire) >= cost_of(best)) break;
        best = std::move(wire);
    }
    return best;
}

}  // namespace citystream::codec::mesh
