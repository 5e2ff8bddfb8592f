#include "tests/bench/position_costs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "codec/grid.h"
#include "codec/mesh/lattice_code.h"
#include "codec/mesh/mesh_content_make.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/mesh_wire.h"
#include "codec/mesh/step_choice.h"
#include "tests/bench/city_heights.h"

namespace citystream::bench {

using codec::mesh::MeshContentOptions;
using codec::mesh::MeshWire;

namespace {

/// Bytes of points in the first step.
double first_bytes(const MeshWire& wire) {
    return (wire.bits.positions + wire.bits.prisms) / 8;
}

PositionSteps steps_of(const MeshWire& wire) {
    PositionSteps steps;
    steps.dropped = wire.content.dropped;
    steps.bytes.push_back(first_bytes(wire));
    steps.other = static_cast<double>(wire.steps[0].size()) - steps.bytes[0];
    for (size_t s = 1; s < wire.steps.size(); ++s)
        steps.bytes.push_back(steps.bytes.back() + static_cast<double>(wire.steps[s].size()));
    return steps;
}

uint32_t bits_of_longest_side(const codec::mesh::MeshTile& mesh) {
    int64_t longest = 0;
    for (size_t c = 0; c < 3 && !mesh.vertices.empty(); ++c) {
        const auto [low, high] =
            std::minmax_element(mesh.vertices.begin(), mesh.vertices.end(),
                                [c](const auto& a, const auto& b) { return a.position[c] < b.position[c]; });
        longest = std::max(longest, int64_t{high->position[c]} - low->position[c]);
    }
    return static_cast<uint32_t>(std::bit_width(static_cast<uint64_t>(longest)));
}

}  // namespace

size_t PositionSteps::step_for(uint32_t granted) const {
    size_t step = 0;
    while (step + 1 < dropped.size() && dropped[step] > granted) ++step;
    return step;
}

Result<PositionCosts> PositionCosts::of_tile(const SampleCity& city, const tiles::tileset::TileRecord& record) {
    PositionCosts costs;
    costs.record_ = &record;
    auto mesh = mesh_of(city, record);
    if (!mesh) return mesh.error();
    costs.mesh_ = std::move(*mesh);
    costs.full_bits_ = bits_of_longest_side(costs.mesh_);
    MeshContentOptions options;
    options.finest_error_metres = record.geometric_error;
    codec::mesh::KnownLattices known;
    for (const StepChoice choice : kStepChoices) {
        if (choice != StepChoice::kBest) options.most_steps = static_cast<uint32_t>(choice);
        costs.steps_[static_cast<size_t>(choice)] =
            steps_of(choice == StepChoice::kBest
                         ? codec::mesh::encode_best_steps(costs.mesh_, options)
                         : codec::mesh::encode_mesh_wire(codec::mesh::make_content(costs.mesh_, options), &known));
    }
    return costs;
}

double PositionCosts::fixed_bytes(uint32_t dropped) {
    dropped = std::max(dropped, finest_dropped());
    const auto [at, added] = fixed_.try_emplace(dropped, 0);
    if (!added) return at->second;
    MeshContentOptions options;
    options.most_steps = 1;
    // What drops just so many bits (finest_dropped of position_error.h).
    if (dropped > 0)
        options.finest_error_metres = std::ldexp(8.0f / float{kGridUnitsPerMetre}, static_cast<int>(dropped));
    at->second = first_bytes(encode_mesh_wire(make_content(mesh_, options)));
    return at->second;
}

}  // namespace citystream::bench
