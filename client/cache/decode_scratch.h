// Host memory that decoding a prefix takes for the time.
#pragma once

#include <cstdint>

#include "tiles/tileset/directory.h"

namespace citystream::client {

/// `decoded_bytes`: of the prefix, as the directory has them. Words are made of words, twice as many bytes at a time. A
/// mesh, which is a few bytes a triangle on the GPU, takes up to 60 times as many while it is read (the most that
/// decode_mesh_layer held at a time on all tiles of Chiyoda, Delft and generated cities); the models of its reader,
/// 0.3 to 1 MiB, are not counted.
constexpr uint64_t decode_scratch_bytes(tiles::tileset::Layer layer, uint64_t decoded_bytes) {
    return (layer == tiles::tileset::Layer::kMesh ? 60 : 2) * decoded_bytes;
}

}  // namespace citystream::client
