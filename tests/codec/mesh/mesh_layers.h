// Mesh layers of tests: tiles through the real encoder and back.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <span>
#include <vector>

#include "codec/mesh/mesh_layer.h"
#include "codec/mesh/mesh_triangles.h"

namespace citystream::codec::mesh::test {

inline std::vector<std::span<const std::byte>> wire_of(const std::vector<MeshLayerStep>& steps, size_t count = 99) {
    std::vector<std::span<const std::byte>> wire;
    for (size_t i = 0; i < std::min(count, steps.size()); ++i) wire.emplace_back(steps[i].wire);
    return wire;
}

inline std::vector<uint32_t> decoded_bytes_of(const std::vector<MeshLayerStep>& steps, size_t count = 99) {
    std::vector<uint32_t> bytes;
    for (size_t i = 0; i < std::min(count, steps.size()); ++i) bytes.push_back(steps[i].decoded_bytes);
    return bytes;
}

/// The first `count` steps as a client has them.
inline MeshLayer decoded(const std::vector<MeshLayerStep>& steps, size_t count = 99) {
    auto layer = decode_mesh_layer(wire_of(steps, count), decoded_bytes_of(steps, count), kAnyMeshChart);
    EXPECT_TRUE(layer.ok()) << (layer ? "" : layer.error().text());
    return layer ? std::move(*layer) : MeshLayer{};
}

/// A tile's layer with all its steps.
inline MeshLayer layer_of(const MeshTile& tile, const MeshLayerOptions& options = {}) {
    return decoded(encode_mesh_layer(tile, options));
}

}  // namespace citystream::codec::mesh::test
