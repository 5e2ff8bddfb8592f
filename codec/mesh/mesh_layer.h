// A tile's mesh layer from end to end: what the builder stores of a tile's triangles, and what a client makes of the
// steps it has. The stages have pages of their own: mesh_content.h (what a layer says), mesh_wire.h and
// draco_transport.h (how it travels), mesh_resident.h (how it lies in GPU memory).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/mesh_content.h"
#include "codec/mesh/mesh_content_make.h"
#include "codec/mesh/mesh_resident.h"
#include "codec/mesh/mesh_tile.h"
#include "codec/result.h"

namespace citystream::codec::mesh {

/// How a layer travels. Each says by its first bytes which one it is.
enum class MeshTransport : uint8_t {
    kDefault,  ///< mesh_wire.h
    kDraco     ///< draco_transport.h: one step
};

struct MeshLayerOptions {
    MeshContentOptions content;
    MeshTransport transport = MeshTransport::kDefault;
    /// As many steps as pay (step_choice.h), content.most_steps at most; or as many as that wherever there can be.
    bool choose_steps = false;
};

/// One step of a layer as an archive holds it.
struct MeshLayerStep {
    std::vector<std::byte> wire;
    uint32_t decoded_bytes = 0;  ///< that it adds to the layer in GPU memory
    float error = 0;             ///< metres, of the prefix that ends with it (position_error.h)
};

/// All steps of a tile's layer. Deterministic.
std::vector<MeshLayerStep> encode_mesh_layer(const MeshTile& tile, const MeshLayerOptions& options);

/// The first steps of a layer, decoded.
struct MeshLayer {
    MeshContent content;
    ResidentMesh resident;
    uint32_t steps = 0;

    std::vector<uint32_t> words() const { return resident.with_steps(steps); }
};

/// No limit on chart numbers.
inline constexpr uint32_t kAnyMeshChart = ~uint32_t{0};

/// What wire.size() >= 1 steps say. `decoded_bytes` of them all, as the directory has it, limits what is made room
/// for. Chart numbers are below chart_count.
Result<MeshContent> decode_mesh_content(std::span<const std::span<const std::byte>> wire, uint64_t decoded_bytes,
                                        uint32_t chart_count);

/// The same with GPU words, whose bytes have to be those of the directory, step by step.
Result<MeshLayer> decode_mesh_layer(std::span<const std::span<const std::byte>> wire,
                                    std::span<const uint32_t> decoded_bytes, uint32_t chart_count);

}  // namespace citystream::codec::mesh
