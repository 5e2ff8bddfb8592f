// Meshes as glTF 2.0 files (.glb) with positions and triangles, as bench_mesh compares with them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/mesh/grid_mesh.h"

namespace citystream::bench {

enum class GlbForm : uint8_t {
    kFloats,  ///< float32 positions and indices of 16 or 32 bits, as exporters write them
    /// EXT_meshopt_compression of 16-bit positions (KHR_mesh_quantization), of whole numbers as float32 where 16 bits
    /// are too few: that extension has no wider integers.
    kMeshopt
};

/// `step`: of the grid; files have positions in its unit, by a node's scale in kMeshopt. At least one triangle.
std::vector<std::byte> write_glb(const codec::mesh::GridMesh& mesh, double step, uint32_t bits, GlbForm form);

/// What write_glb wrote; false for other bytes.
bool read_glb(std::span<const std::byte> bytes, double step, codec::mesh::GridMesh& out);

}  // namespace citystream::bench
