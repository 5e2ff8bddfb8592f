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

/// Each number that is tried is one encoding more.
inline constexpr uint32_t kMostChosenSteps = 3;

struct MeshForm {
    MeshTransport transport = MeshTransport::kDefault;
    uint32_t normal_bits = 16;  ///< even, kLeastNormalBits..kMostNormalBits
    codec::mesh::MeshTopology topology = codec::mesh::MeshTopology::kIndices;
    PositionPrecision precision = PositionPrecision::kAdaptive;
    /// 1..kMostMeshSteps, wherever there can be as many; not given: of each tile as many as pay (step_choice.h),
    /// kMostChosenSteps at most. Each more makes the first step smaller and the sum larger. Bytes of all steps, without
    /// pictures: Chiyoda's 11,581 buildings: 1: 437,564; 2: 494,992; 3: 565,185; 4: 625,531; chosen: 436,614.
    /// Ingolstadt: 200,109; 227,746; 239,924; 241,838; chosen: 200,109.
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
