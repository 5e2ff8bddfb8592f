// The transfer matrix of a tile in whole numbers: how much of each source texel's light reaches each local direction of
// each receiver (Sun et al. 2011, section 4.1, equation 2: L* = T L).
//
// Row: receiver * M + local direction. Column: source texel. Entries are *quarters*, 0..4 at first; biclustering leaves
// residuals beyond that, which is why they are signed. T holds visibility, turning and down-sampling and nothing else:
// solid angles belong to the light (source_light.h), cosines and materials to what is done with L*.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "codec/radiance/local_directions.h"
#include "codec/radiance/visibility_bits.h"

namespace citystream::codec::radiance {

/// One quarter of a texel.
inline constexpr float kQuarter = 0.25F;

/// Sparse rows: entries row_begin[j]..row_begin[j + 1] are row j, columns rising, quarters not 0.
struct Transfer {
    uint32_t columns = 0;             ///< at most 2^16
    std::vector<uint32_t> row_begin;  ///< rows + 1
    std::vector<uint16_t> column;
    std::vector<int8_t> quarters;
    friend bool operator==(const Transfer&, const Transfer&) = default;

    uint32_t rows() const { return static_cast<uint32_t>(row_begin.size()) - 1; }
    uint64_t nonzeros() const { return column.size(); }
    /// Of a product by entries: a multiplication and an addition each.
    uint64_t flops() const { return 2 * nonzeros(); }
};

enum class TransferRule : uint8_t {
    /// Every visible sample adds a quarter to the local direction that is nearest to the sample.
    kSamples,
    /// As the paper's text has it: all visible samples of a texel go to what is nearest to the texel's centre.
    kTexels
};

/// For a frame: which local direction each sample goes to; of samples below its plane, any. 0.2 ms for 32 texels on a
/// side and 8 x 8 local directions.
std::vector<uint16_t> local_of_samples(const Frame& frame, uint32_t side, const LocalDirections& local,
                                       TransferRule rule = TransferRule::kSamples);

/// Bits below the receivers' planes count as 0, whatever they are. O(samples of the tile + frames x samples).
Transfer make_transfer(const VisibilityTile& tile, const LocalDirections& local,
                       TransferRule rule = TransferRule::kSamples);

/// Rows that are equal kept once.
struct DistinctRows {
    Transfer rows;                 ///< in the order of first use
    std::vector<uint32_t> row_of;  ///< of each row of the whole
};
DistinctRows distinct_rows(const Transfer& transfer);
/// Makes distinct_rows(make_transfer(tile)) receiver by receiver: neither all bits nor the whole matrix are ever there.
class DistinctRowMaker {
  public:
    /// `local` outlives it.
    DistinctRowMaker(uint32_t side, const LocalDirections& local);
    ~DistinctRowMaker();

    /// `bits`: of the next receiver, whose frame has this number among those of the tile. O(samples / 32 + entries of
    /// the rows that are not those of the last receiver with this frame).
    void add(uint32_t frame, uint32_t frame_code, std::span<const uint32_t> bits);
    /// Of the distinct rows so far.
    uint64_t nonzeros() const { return distinct_.rows.nonzeros(); }
    /// Without room to grow.
    DistinctRows take();

  private:
    struct FrameTable;
    FrameTable& table_of(uint32_t frame, uint32_t frame_code);
    void combine(std::span<const uint32_t> bits);
    void gather(const FrameTable& table, uint32_t local);
    uint32_t number_of_row();
    void grow_places();

    uint32_t side_;
    const LocalDirections& local_;
    std::vector<FrameTable> tables_;  ///< of the frames that were asked for last
    DistinctRows distinct_;
    /// Of the rows: their hashes, and a table of 1 + their numbers by the hashes' upper bits, 0 where there is none.
    std::vector<uint64_t> hashes_;
    std::vector<uint32_t> places_;
    uint32_t places_log2_ = 0;
    /// Of the receiver: two rows of 32 samples, the upper one in the lower half, for each 16 texels.
    std::vector<uint64_t> pieces_;
    std::vector<uint32_t> entries_;  ///< of one row: column << 8 | quarters
};
/// The whole again.
Transfer all_rows(const DistinctRows& distinct);

}  // namespace citystream::codec::radiance
