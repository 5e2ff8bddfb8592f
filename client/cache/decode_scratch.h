// Host memory that decoding a prefix takes for the time.
#pragma once

#include <cstdint>

#include "tiles/tileset/directory.h"

namespace citystream::client {

/// `decoded_bytes`: of the prefix, as the directory has them. Words are made of words, twice as many bytes at a time. A
/// mesh, which is a few bytes a triangle on the GPU, takes up to 36 times as many while it is read (measured on
/// generated tiles and on Chiyoda's); the models of its reader, 4.4 MB whatever the tile, are not counted.
constexpr uint64_t decode_scratch_bytes(tiles::tileset::Layer layer, uint64_t decoded_bytes) {
    return (layer == tiles::tileset::Layer::kMesh ? 40 : 2) * decoded_bytes;
}

}  // namespace citystream::client
