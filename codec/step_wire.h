// A step of an atlas or of facades between its decoded words and the frame that travels: one zstd frame, of the words
// themselves or, where that is smaller, of a packed form of them that the frame's content names (atlas/FORMAT.md, "On
// the wire"). Meshes have a wire form of their own (mesh/mesh_layer.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/layer_steps.h"
#include "codec/result.h"

namespace citystream::codec {

/// The frames of a layer's steps. Deterministic for one zstd version.
std::vector<std::vector<std::byte>> encode_steps(const LayerSteps& steps, int level = 19);

/// The step's words. `decoded_bytes` is what the directory says of them: content of that size is the words, content of
/// another size has to be a packed form that unpacks to it. Allocates no more than a fixed multiple of it.
Result<std::vector<uint32_t>> decode_step(std::span<const std::byte> frame, size_t decoded_bytes);

}  // namespace citystream::codec
