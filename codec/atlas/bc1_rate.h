// BC1 blocks that the following zstd makes smaller, at a stated loss: rate-distortion optimisation.
//
// Every block weighs its squared error against the bits that its two words are expected to take: J = D + lambda R. What
// is tried beside the best block: endpoints and index words that occurred before (zstd finds them again as matches; the
// latest `window` distinct ones, and matches that would go on), endpoints refitted to
// such index words, and for index words that are new, rows of four texels (bytes) that are frequent. R follows zstd's
// ways closely enough to choose by: bytes by their frequency, matches by their distance, longer matches almost free.
//
// It works best where endpoints and index words lie apart before zstd (block_planes.h), which R assumes.
//
// Deterministic: integers throughout but for fit_bc1_endpoints.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "codec/atlas/bc1.h"

namespace citystream::codec::atlas {

struct Bc1RateOptions {
    Bc1Options encoder;  ///< of the best blocks that it starts from
    /// Squared error (all channels, weighted) that a bit is worth; 0: the best blocks as they are. Photographs, facades
    /// (bench_blocks): 5 saves 11 %, 19 % of the bytes for 0.12, 0.15 dB; 10 saves 20 %, 28 % for 0.4 dB; 40 saves 40
    /// %, 52 % for 1.6, 1.9 dB. At most 2^20.
    uint32_t lambda = 8;
    /// No block's squared error rises by more than this per texel over its best block's: the stated loss.
    uint32_t most_rise_per_texel = 64;
    /// Latest distinct words of either kind that are tried, 1..4096. Time grows with it.
    uint32_t window = 256;
};

/// Sums over all blocks so far.
struct Bc1RateTotals {
    uint64_t blocks = 0;
    uint64_t best_error = 0;    ///< squared error of the best blocks, weighted
    uint64_t error = 0;         ///< of those chosen
    uint64_t largest_rise = 0;  ///< of one block: at most 16 * most_rise_per_texel
};

/// PSNR of an (unweighted) squared error over whole blocks; 99 for none.
double bc1_psnr(uint64_t error, uint64_t blocks);

/// One for all that goes into one zstd frame, in its order: words of an image can be found again in the next.
class Bc1RateEncoder {
  public:
    explicit Bc1RateEncoder(const Bc1RateOptions& options);
    ~Bc1RateEncoder();
    Bc1RateEncoder(const Bc1RateEncoder&) = delete;
    Bc1RateEncoder& operator=(const Bc1RateEncoder&) = delete;

    /// Blocks of an image (bc1_blocks_of), in order: two words each, c0 > c1 or c0 == c1 and indices 0.
    std::vector<uint32_t> encode(std::span<const Bc1Texels> blocks);

    const Bc1RateTotals& totals() const;

    struct State;

  private:
    std::unique_ptr<State> state_;
};

}  // namespace citystream::codec::atlas
