// Strip streams (codec/mesh/strip_layout.h) decoded to index lists by the GPU: all meshes of a batch, one large or
// thousands of small ones, in the same few dispatches (Meyer 2012, sections 5.4 to 5.7; the notes' T8 to T10).
//
// The paper's scans over single codes are scans over words here, 28 codes, 32 references or 16 to 32 steps at a time,
// and the meshes of a batch are segments of one scan. Two of its arrays, the scattered differences and the vertex list
// V, are never in memory: a triangle's references are looked up in U and in the ranks of INC. Passes: codes and
// increments; steps and triangles. With look-back that is two dispatches, in passes four.
//
// Temporary memory: |U| words and one word for 32 references, and the states of the scans. That is below the |V| words
// of T10 where 31 of 32 references or fewer are explicit and the batch is of some thousands of references (otherwise at
// most |V| / 32 and one block's states of each scan above it).
//
// Streams are checked by the CPU when they arrive (check_strip_code); the shaders clamp besides, so that words that lie
// anyway give wrong triangles of the same mesh's vertices, and nothing is read or written elsewhere.
//
// Errors: of plans: Result; Vulkan's: VulkanError.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "client/render/scan.h"
#include "client/render/strip_decoder_layout.h"
#include "codec/mesh/strip_code.h"
#include "codec/result.h"

namespace citystream::client {

/// A stream in GPU memory.
struct StripStream {
    VkDeviceAddress layer = 0;  ///< reference as in TileConstants: paged, or in one piece with LAYER_REF_DIRECT set
    uint32_t first_word = 0;    ///< of the layer
    codec::mesh::StripHeader header;  ///< as read_strip_header gives it for words that are really there
};

/// What a batch comes to.
struct StripSizes {
    std::array<uint32_t, STRIP_KINDS> words{};  ///< of all streams
    uint32_t temporary_words = 0;               ///< without the scans' states
    uint64_t corner_words = 0;                  ///< output: three a triangle
    uint64_t references = 0;

    /// Workgroups.
    uint32_t blocks(uint32_t kind) const { return (words[kind] + SCAN_LANES - 1) / SCAN_LANES; }
};

/// What the passes of one batch need, and where its meshes' corners go.
struct StripPlan {
    std::vector<StripRecord> records;  ///< to be copied to where the GPU reads them
    std::vector<uint64_t> corners_at;  ///< of every stream of the batch: words of the output
    StripSizes sizes;
};

/// Adds one more mesh. Fails, and changes nothing, where the batch would be too large for one set of dispatches (about
/// 8 million words of all kinds: some 100 million triangles), and for a header whose counts cannot be.
Status append_stream(StripPlan& plan, const StripStream& stream);
/// All streams as one batch.
Result<StripPlan> plan_strips(std::span<const StripStream> streams);

struct StripDecoder {
    ScanTuning tuning;
    std::array<Pass, 4> passes{};  ///< with look-back the first two
};

StripDecoder create_strip_decoder(const Device& device, const ScanTuning& tuning);
void destroy_strip_decoder(const Device& device, StripDecoder& decoder);

/// All temporary memory of a batch.
uint64_t strip_temporary_words(const StripDecoder& decoder, const StripSizes& sizes);

/// A part of a buffer.
struct BufferRange {
    const Buffer* buffer = nullptr;
    uint64_t offset = 0;  ///< bytes, a multiple of 8
};

/// Where a batch's data lie; none overlap. `records`: plan.records; `corners`: corner_words words.
struct StripPlaces {
    BufferRange records, temporary, corners;
};

/// Records the batch's passes (nothing for a batch without triangles), with the barriers between them. The caller's
/// make records and streams visible before, and corners after, and keep earlier users of the temporary memory apart.
void record_strip_decode(VkCommandBuffer commands, const StripDecoder& decoder, const StripPlan& plan,
                         const StripPlaces& places);

/// Between decoding and drawing, either way round: corners that were decoded may be drawn as indices or by vertex
/// shaders that read them, and memory whose corners were drawn may be decoded into.
void strip_barrier(VkCommandBuffer commands);

}  // namespace citystream::client
