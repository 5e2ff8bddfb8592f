#include "codec/mesh/mesh_layer.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "codec/mesh/draco_transport.h"
#include "codec/mesh/mesh_wire.h"
#include "codec/mesh/position_error.h"
#include "codec/mesh/step_choice.h"

namespace citystream::codec::mesh {
namespace {

/// Triangles and points that a word of GPU memory can hold at most (strips of one or two bits a step, prisms of a few
/// bits a point), and what the smallest layers have beside.
constexpr uint64_t kMostPerWord = 32, kMostBeside = 64;

MeshLimits limits_of(uint64_t decoded_bytes) {
    const MeshLimits most;
    const uint64_t count = kMostPerWord * (decoded_bytes / 4) + kMostBeside;
    return {static_cast<uint32_t>(std::min<uint64_t>(most.points, count)),
            static_cast<uint32_t>(std::min<uint64_t>(most.triangles, count))};
}

/// What Draco declines travels by our own transport.
MeshWire encode(const MeshTile& tile, const MeshLayerOptions& options) {
    if (options.transport == MeshTransport::kDefault && options.choose_steps)
        return encode_best_steps(tile, options.content);
    const MeshContent content = make_content(tile, options.content);
    if (options.transport == MeshTransport::kDraco) {
        if (auto wire = encode_draco_mesh(content)) return std::move(*wire);
    }
    return encode_mesh_wire(content);
}

}  // namespace

std::vector<MeshLayerStep> encode_mesh_layer(const MeshTile& tile, const MeshLayerOptions& options) {
    MeshWire wire = encode(tile, options);
    const ResidentMesh resident = make_resident(wire.content);
    std::vector<MeshLayerStep> steps;
    for (uint32_t s = 0; s < wire.steps.size(); ++s) {
        const auto bytes = static_cast<uint32_t>(4 * resident.added_words(s));
        const double error = step_error(options.content.finest_error_metres, wire.content.dropped[s]);
        steps.push_back({std::move(wire.steps[s]), bytes, static_cast<float>(error)});
    }
    return steps;
}

Result<MeshContent> decode_mesh_content(std::span<const std::span<const std::byte>> wire, uint64_t decoded_bytes,
                                        uint32_t chart_count) {
    const MeshLimits limits = limits_of(decoded_bytes);
    const bool draco = is_draco_mesh(wire[0]);
    if (draco && wire.size() > 1) return Error{"mesh layer: Draco's has one step"};
    auto content = draco ? decode_draco_mesh(wire[0], limits) : decode_mesh_wire(wire, limits);
    if (!content) return content;
    if (Status status = check_charts(*content, chart_count); !status) return status.error();
    return content;
}

Result<MeshLayer> decode_mesh_layer(std::span<const std::span<const std::byte>> wire,
                                    std::span<const uint32_t> decoded_bytes, uint32_t chart_count) {
    const uint64_t all = std::accumulate(decoded_bytes.begin(), decoded_bytes.end(), uint64_t{0});
    auto content = decode_mesh_content(wire, all, chart_count);
    if (!content) return content.error();
    MeshLayer layer;
    layer.content = std::move(*content);
    layer.resident = make_resident(layer.content);
    layer.steps = static_cast<uint32_t>(wire.size());
    if (layer.resident.words.empty()) return Error{"mesh layer: too large"};
    for (uint32_t s = 0; s < layer.steps; ++s) {
        const uint64_t bytes = 4 * layer.resident.added_words(s);
        if (bytes != decoded_bytes[s])
            return Error{"mesh layer: step " + std::to_string(s) + " decodes to " + std::to_string(bytes) +
                         " bytes, expected " + std::to_string(decoded_bytes[s])};
    }
    return layer;
}

}  // namespace citystream::codec::mesh
