// Host memory that decoding a prefix takes for the time.
#pragma once

#include <cstdint>

#include "tiles/tileset/directory.h"

namespace citystream::client {

/// Of a layer other than radiance. `decoded_bytes`: of the prefix, as the directory has them. Words are made of words,
/// twice as many bytes at a time. A mesh, which is a few bytes a triangle on the GPU, takes up to 60 times as many
/// while it is read (the most that decode_mesh_layer held at a time on all tiles of Chiyoda, Delft and generated
/// cities); the models of its reader, 0.3 to 1 MiB, are not counted.
constexpr uint64_t decode_scratch_bytes(tiles::tileset::Layer layer, uint64_t decoded_bytes) {
    return (layer == tiles::tileset::Layer::kMesh ? 60 : 2) * decoded_bytes;
}

/// The same of a radiance layer, of which a thread has a copy of the wire bytes, too: what is kept of each source texel
/// (counters of the search, bits of 256 receivers, tables of frames), and the most beside it that
/// decode_radiance_layer held at a time on the tiles of generated cities. `texels_across`: of the source, as the
/// manifest has it.
constexpr uint64_t light_scratch_bytes(uint64_t texels_across, uint64_t decoded_bytes, uint64_t wire_bytes) {
    constexpr uint64_t kBytesPerTexel = 2 << 10, kFacesOfACube = 6, kBytesPerDecodedByte = 10;
    return kBytesPerTexel * kFacesOfACube * texels_across * texels_across + kBytesPerDecodedByte * decoded_bytes +
           wire_bytes;
}

}  // namespace citystream::client
