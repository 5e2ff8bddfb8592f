#include "tiles/layers/mesh_form.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace citystream::tiles::layers {

codec::mesh::MeshLayerOptions MeshForm::layer_options(
    float geometric_error, int64_t side, std::function<std::array<uint32_t, 2>(uint32_t)> chart_size) const {
    codec::mesh::MeshLayerOptions layer;
    layer.transport = transport;
    layer.choose_steps = !steps;
    codec::mesh::MeshContentOptions& options = layer.content;
    options.finest_error_metres = geometric_error;
    options.normal_bits = normal_bits / 2;
    options.topology = topology;
    options.most_dropped = std::min<uint32_t>(codec::mesh::kMeshGridBits,
                                              static_cast<uint32_t>(std::bit_width(static_cast<uint64_t>(side)) - 1));
    options.most_steps = transport == MeshTransport::kDraco ? 1 : steps.value_or(kMostChosenSteps);
    if (precision == PositionPrecision::kConstrained) {
        options.constraint.emplace();
        options.constraint->chart_size = std::move(chart_size);
        options.constraint->tile_side = static_cast<int32_t>(std::min<int64_t>(side, 1 << 30));
    }
    return layer;
}

Status check_mesh_form(const MeshForm& form) {
    const uint32_t bits = form.normal_bits;
    if (bits < kLeastNormalBits || bits > kMostNormalBits || bits % 2 != 0) {
        return Error{fmt::format("normals of {} bits; they take an even number from {} to {}", bits, kLeastNormalBits,
                                 kMostNormalBits)};
    }
    if (form.steps && (*form.steps < 1 || *form.steps > codec::mesh::kMostMeshSteps))
        return Error{fmt::format("meshes of {} steps; they have 1 to {}", *form.steps, codec::mesh::kMostMeshSteps)};
    return Done{};
}

std::string to_string(const MeshForm& form) {
    const MeshForm usual;
    std::string text;
    if (form.transport != usual.transport)
        text += fmt::format(" mesh-transport={}", kMeshTransportNames[static_cast<size_t>(form.transport)]);
    if (form.normal_bits != usual.normal_bits) text += fmt::format(" normal-bits={}", form.normal_bits);
    if (form.topology != usual.topology)
        text += fmt::format(" mesh-topology={}", kMeshTopologyNames[static_cast<size_t>(form.topology)]);
    if (form.precision != usual.precision)
        text += fmt::format(" precision={}", kPositionPrecisionNames[static_cast<size_t>(form.precision)]);
    if (form.steps) text += fmt::format(" mesh-steps={}", *form.steps);
    return text;
}

}  // namespace citystream::tiles::layers
