#include "tests/bench/position_costs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "client/select/selection.h"
#include "client/stream/layer_decoder.h"
#include "codec/grid.h"
#include "codec/mesh/mesh_content_make.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/mesh_triangles.h"
#include "codec/mesh/mesh_wire.h"
#include "codec/mesh/step_choice.h"

namespace citystream::bench {

using codec::mesh::MeshContentOptions;
using codec::mesh::MeshWire;
using tiles::tileset::Layer;

namespace {

Result<codec::mesh::MeshTile> mesh_of(const SampleCity& city, const tiles::tileset::TileRecord& record) {
    const auto& steps = record.steps(Layer::kMesh);
    std::vector<std::vector<std::byte>> wire;
    uint64_t begin = 0;
    for (const auto& step : steps) {
        const auto bytes = city.layer_bytes(record, Layer::kMesh).subspan(begin, step.end - begin);
        wire.emplace_back(bytes.begin(), bytes.end());
        begin = step.end;
    }
    const auto content = client::decode_mesh_content(wire, steps);
    if (!content) return content.error();
    return codec::mesh::to_tile(*content);
}

/// Bytes of points in the first step.
double first_bytes(const MeshWire& wire) {
    return (wire.bits.positions + wire.bits.prisms) / 8;
}

}  // namespace

Result<PositionCosts> PositionCosts::of_tile(const SampleCity& city, const tiles::tileset::TileRecord& record) {
    PositionCosts costs;
    costs.record_ = &record;
    auto mesh = mesh_of(city, record);
    if (!mesh) return mesh.error();
    costs.mesh_ = std::move(*mesh);
    int64_t longest = 0;
    for (size_t c = 0; c < 3 && !costs.mesh_.vertices.empty(); ++c) {
        const auto [low, high] =
            std::minmax_element(costs.mesh_.vertices.begin(), costs.mesh_.vertices.end(),
                                [c](const auto& a, const auto& b) { return a.position[c] < b.position[c]; });
        longest = std::max(longest, int64_t{high->position[c]} - low->position[c]);
    }
    costs.full_bits_ = static_cast<uint32_t>(std::bit_width(static_cast<uint64_t>(longest)));
    MeshContentOptions options;
    options.finest_error_metres = record.geometric_error;
    const MeshWire wire = encode_best_steps(costs.mesh_, options);
    costs.dropped_ = wire.content.dropped;
    costs.step_bytes_.push_back(first_bytes(wire));
    costs.other_bytes_ = static_cast<double>(wire.steps[0].size()) - costs.step_bytes_[0];
    for (size_t s = 1; s < wire.steps.size(); ++s)
        costs.step_bytes_.push_back(costs.step_bytes_.back() + static_cast<double>(wire.steps[s].size()));
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
