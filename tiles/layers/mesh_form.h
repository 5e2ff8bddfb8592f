// How the builder writes meshes: transport, precision, normals, topology.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "codec/mesh/mesh_layer.h"
#include "codec/result.h"

namespace citystream::tiles::layers {

using codec::mesh::MeshTransport;
inline constexpr std::array<std::string_view, 2> kMeshTransportNames = {"default", "draco"};
inline constexpr std::array<std::string_view, 3> kMeshTopologyNames = {"indices", "local-strips", "strip-code"};

enum class PositionPrecision : uint8_t {
    kAdaptive,    ///< bits by distance alone
    kConstrained  ///< and as many as what is shaded asks for (codec/mesh/constrained_precision.h)
};
inline constexpr std::array<std::string_view, 2> kPositionPrecisionNames = {"ap", "cap"};

/// Bits of a normal's code, both parameters.
inline constexpr uint32_t kLeastNormalBits = 2 * codec::mesh::kLeastMeshNormalBits;
inline constexpr uint32_t kMostNormalBits = 2 * codec::mesh::kMostMeshNormalBits;

/// A fourth step saves Chiyoda 0.1 % of first steps and all together.
inline constexpr uint32_t kMostChosenSteps = 3;

struct MeshForm {
    MeshTransport transport = MeshTransport::kDefault;
    uint32_t normal_bits = 16;  ///< even, kLeastNormalBits..kMostNormalBits
    codec::mesh::MeshTopology topology = codec::mesh::MeshTopology::kIndices;
    PositionPrecision precision = PositionPrecision::kAdaptive;
    /// 1..kMostMeshSteps, wherever there can be as many; not given: of each tile as many as pay, kMostChosenSteps at
    /// most. Each more makes the first step smaller and the sum larger. Chiyoda's 11,581 buildings, bytes of the first
    /// steps and of all: 1: 450,442; 2: 339,766 and 507,722; 3: 287,542 and 577,800; 4: 215,776 and 638,047; chosen:
    /// 333,450 and 495,355. Ingolstadt: 336,547; 333,840 and 394,056; 318,401 and 426,556; 303,996 and 438,216; chosen:
    /// 334,539 and 334,568.
    std::optional<uint32_t> steps = {};

    /// For a tile: metres of the geometry's own error, grid units of its side, and texels of its charts
    /// (MeshConstraint::chart_size).
    codec::mesh::MeshLayerOptions layer_options(float geometric_error, int64_t side,
                                                std::function<std::array<uint32_t, 2>(uint32_t)> chart_size) const;
};

/// Error: normal bits or steps, one line.
Status check_mesh_form(const MeshForm& form);

/// What is not as by default, for Manifest::build_options: " mesh-transport=draco normal-bits=24", empty: all is.
std::string to_string(const MeshForm& form);

}  // namespace citystream::tiles::layers
