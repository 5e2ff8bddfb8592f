// From wire bytes to checked words: what travelled is undone, then the codec's own view checks, so that nothing
// unchecked reaches the GPU.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/atlas_form.h"
#include "codec/facade/facade_layer.h"
#include "codec/mesh/mesh_layer.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/result.h"
#include "tiles/tileset/directory.h"

namespace citystream::client {

/// The concatenated words of a prefix, and how many words each step has.
struct DecodedPrefix {
    std::vector<uint32_t> words;
    std::vector<uint32_t> step_words;
};

/// What the renderer must know of a layer beside its words.
struct LayerFacts {
    codec::atlas::AtlasFacts atlas;
    std::vector<codec::facade::Placement> placements;
    std::vector<uint32_t> facade_maps;  ///< sorted, distinct
};

/// No limit on chart indices: the tile has no atlas, or it is not here yet.
inline constexpr uint32_t kAnyChart = ~uint32_t{0};

/// How many there are of what a layer names.
struct NameLimits {
    uint32_t charts = kAnyChart;  ///< of the tile's atlas (mesh and facade)
    uint32_t facade_maps = 0;     ///< of the facade dictionary (facade)
    uint64_t shared_charts = 0;   ///< of the chart dictionary (atlas)
};

/// A radiance layer's words, and what its matrix has left out.
struct DecodedLight {
    std::vector<uint32_t> words;
    codec::radiance::MatrixLoss loss;
};

/// Where decoding failed: the step whose bytes are bad.
struct DecodeFailure {
    uint32_t step = 0;
    std::string message;
};

/// Decompresses steps [0, count) of a layer that is neither mesh nor light. `wire[i]` are the bytes of step i. On
/// failure `failure` names the step.
bool decompress_prefix(std::span<const std::vector<std::byte>> wire, std::span<const tiles::tileset::StepRecord> steps,
                       DecodedPrefix& out, DecodeFailure& failure);

/// Decodes steps [0, steps.size()) of a mesh. On failure `failure` names the first step without which the steps before
/// it are good.
bool decode_mesh(std::span<const std::vector<std::byte>> wire, std::span<const tiles::tileset::StepRecord> steps,
                 uint32_t chart_count, codec::mesh::MeshLayer& out, DecodeFailure& failure);

/// The words of steps [0, steps.size()) of a radiance layer. On failure `failure` names the first step without which
/// the steps before it are good; once `matrix.stop` is set it names none, and the steps may all be good.
bool decode_light(std::span<const std::vector<std::byte>> wire, std::span<const tiles::tileset::StepRecord> steps,
                  const codec::radiance::MatrixOptions& matrix, DecodedLight& out, DecodeFailure& failure);

/// What the first steps of a mesh say, without making words of them.
Result<codec::mesh::MeshContent> decode_mesh_content(std::span<const std::vector<std::byte>> wire,
                                                     std::span<const tiles::tileset::StepRecord> steps);

/// Checks the words of a prefix as the codec of `layer` (neither mesh nor light) does.
Result<LayerFacts> check_layer(tiles::tileset::Layer layer, const DecodedPrefix& prefix, const NameLimits& limits);

/// Both, and on failure the first step without which the prefix before it is good.
bool decode_layer(tiles::tileset::Layer layer, std::span<const std::vector<std::byte>> wire,
                  std::span<const tiles::tileset::StepRecord> steps, const NameLimits& limits, DecodedPrefix& out,
                  LayerFacts& facts, DecodeFailure& failure);

}  // namespace citystream::client
