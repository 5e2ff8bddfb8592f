// The radiance layer of a tile: receivers and what they see, as steps on the wire, and as words in GPU memory that give
// the light at any point of the tile's surfaces. FORMAT.md, "The layer".
//
// On the wire: where the receivers are (place_wire.h) and visibility bits (visibility_wire.h), or in their place the
// matrix (radiance_transport.h). In GPU memory, behind each other:
//   receiver table   (RECEIVERS.md; its entries are its last words)
//   irradiance       IRRADIANCE_WORDS a receiver (radiance_layer_layout.h), zeros until the light passes have run
//   matrix           biclusters of the distinct rows, or the rows themselves (radiance_resident.h)
// A prefix of steps has all three, its visibility being coarser. So a longer prefix replaces the words of a shorter
// one. A matrix has no prefixes: its layer is one step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/matrix_words.h"
#include "codec/radiance/radiance_transport.h"
#include "codec/radiance/receiver_table.h"
#include "codec/radiance/visibility_bits.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// What a tile's layer is made of.
struct RadianceTile {
    uint32_t spacing_log2 = 0;  ///< of the lattice, in grid units
    /// Sorted; counted from the tile's minimum corner and base height. Depths are multiples of a 64th of the spacing
    /// once they have been coded (place_wire.h, rounded_depth).
    std::vector<ReceiverPlace> places;
    VisibilityTile visibility;  ///< of the receivers in their order; frames follow from places (frame_of_place)
    friend bool operator==(const RadianceTile&, const RadianceTile&) = default;
};

/// The frame of a receiver: its class and tilts, no turn.
uint32_t frame_of_place(const ReceiverPlace& place);

struct RadianceLayerStep {
    std::vector<std::byte> wire;
    /// Of this step alone, so that a prefix's sum is at least what its words take, whatever the form of the matrix: a
    /// multiple of 4.
    uint32_t decoded_bytes = 0;
    /// Of the prefix: greatest part of the light of a uniform sky that a receiver gets wrong, relative radiance
    /// (visibility_wire.h in hemispheres).
    float error = 0;
};

/// `local_side`: m of the local directions (local_directions.h), 1..kMostLocalSide. `bake_hash`: what the layer depends
/// on (tiles/radiance/visibility_bake.h), kept in the first step. `bits_error`: that the tile's bits have already
/// (visibility_smoothing.h), which each step's error has more. Deterministic. Error: what write_receiver_table
/// reports; depths beyond kMostDepth; frames that are not those of the places; more than 2^24 receivers times local
/// directions. Takes as long as decoding each of the prefixes with kRows; kBiclusters as long as with kBiclusters.
Result<std::vector<RadianceLayerStep>> encode_radiance_layer(
    const RadianceTile& tile, uint32_t local_side, uint64_t bake_hash, double bits_error = 0,
    RadianceTransport transport = RadianceTransport::kVisibility);

/// Of a first step; any bytes are safe.
Result<uint64_t> read_bake_hash(std::span<const std::byte> first_step);
Result<RadianceTransport> read_radiance_transport(std::span<const std::byte> first_step);

/// How many receivers a first step of so many decoded bytes tells of; any bytes are safe. O(receivers).
Result<uint32_t> read_receiver_count(std::span<const std::byte> first_step, uint64_t decoded_bytes);

/// What the first steps of a layer that travels as visibility say; of others, which have no bits, an error.
/// `decoded_bytes`: of the prefix, as the directory has them: there are no more receivers than have room in it, of
/// which each takes 3 n^2 bytes of bits here. Any bytes are safe.
Result<RadianceTile> decode_radiance_tile(std::span<const std::span<const std::byte>> steps, uint64_t decoded_bytes);

/// The words of a prefix, at most decoded_bytes / 4: an error where the rows would take more in any form. Any bytes are
/// safe. Deterministic. With 24,576 samples and 8 x 8 local directions 0.07 to 0.12 ms a receiver for rows, 0.16 to
/// 0.41 ms for biclusters. Meanwhile it holds, besides the distinct rows, 3 MB of models, 10 n^2 bytes for each of up
/// to 256 receivers and tables of up to 256 frames.
/// Whatever the transport, the words are the same: biclusters that travelled are those that a search at arrival would
/// find, and are used as they are where that is what `options` ask for.
/// `loss`: filled where there is one.
/// Once the options' `stop` is set: stopped_error() (codec/stop.h); looked at after each receiver of bits and each
/// cluster of a search.
Result<std::vector<uint32_t>> decode_radiance_layer(std::span<const std::span<const std::byte>> steps,
                                                    uint64_t decoded_bytes, const MatrixOptions& options,
                                                    MatrixLoss* loss = nullptr);

/// Where the parts of a layer's words are.
struct RadianceLayerShape {
    uint32_t receivers = 0, irradiance_word = 0, matrix_word = 0;
    friend bool operator==(const RadianceLayerShape&, const RadianceLayerShape&) = default;
};
/// From the header of the receiver table, RECEIVER_HEADER_WORDS of `words` words. Error: parts that end behind them.
Result<RadianceLayerShape> radiance_layer_shape(std::span<const uint32_t> table_header, uint64_t words);

/// A layer's words, checked in linear time: neither the view nor a shader can read outside them, whatever they are.
/// Borrows them.
class RadianceLayerView {
  public:
    static Result<RadianceLayerView> create(std::span<const uint32_t> words);

    uint32_t receivers() const { return shape_.receivers; }
    uint32_t irradiance_word() const { return shape_.irradiance_word; }  ///< first of them
    uint32_t matrix_word() const { return shape_.matrix_word; }          ///< first of the matrix
    std::span<const uint32_t> table() const { return words_.first(shape_.irradiance_word); }
    std::span<const uint32_t> irradiance() const {
        return words_.subspan(shape_.irradiance_word, shape_.matrix_word - shape_.irradiance_word);
    }
    std::span<const uint32_t> matrix() const { return words_.subspan(shape_.matrix_word); }

  private:
    std::span<const uint32_t> words_;
    RadianceLayerShape shape_;
};

}  // namespace citystream::codec::radiance
