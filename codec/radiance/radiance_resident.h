// A tile's transfer matrix in GPU memory: biclusters as two passes read them, and which row each local direction of
// each receiver is (Sun et al. 2011, section 6.1.3, algorithm 2). FORMAT.md, "In GPU memory".
//
// First pass, a cluster each: sum of quarters times the light of its columns. Second pass, a row each: sum of its
// clusters. Rows are kept once, so a receiver's local light is read through a table of row numbers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/radiance/biclusters.h"
#include "codec/radiance/radiance_resident_layout.h"
#include "codec/radiance/transfer_product.h"
#include "codec/result.h"

namespace citystream::codec::radiance {

/// `clusters` of the distinct rows; `row_of` for each row of the whole, receivers * local_count of them. Empty where it
/// is more than a layer can hold: 2^32 bits of anything.
std::vector<uint32_t> make_resident_radiance(const Biclusters& clusters, std::span<const uint32_t> row_of,
                                             uint32_t local_count);

/// Whether a header (RADIANCE_HEADER_WORDS of `words` words) is one, its parts lying one behind the other to the end.
Status check_resident_header(std::span<const uint32_t> header, uint64_t words);

/// A checked view: neither it nor a shader that is bounded by the same words can read outside them, whatever they are.
class ResidentRadianceView {
  public:
    /// Looks at everything, in linear time. Borrows the words.
    static Result<ResidentRadianceView> create(std::span<const uint32_t> words);

    uint32_t receivers() const { return words_[RADIANCE_WORD_RECEIVERS]; }
    uint32_t locals() const { return words_[RADIANCE_WORD_LOCALS]; }
    uint32_t columns() const { return words_[RADIANCE_WORD_COLUMNS]; }
    uint32_t rows() const { return words_[RADIANCE_WORD_ROWS]; }
    uint32_t clusters() const { return words_[RADIANCE_WORD_CLUSTERS]; }

    struct Term {
        uint32_t column = 0;
        int32_t quarters = 0;
    };
    uint32_t term_start(uint32_t cluster) const;  ///< cluster 0..clusters()
    uint32_t link_start(uint32_t row) const;      ///< row 0..rows()
    Term term(uint32_t i) const;
    uint32_t link(uint32_t i) const;
    uint32_t row_of(uint32_t receiver, uint32_t local) const;

    /// What the two passes give: the light of each row, in quarters.
    template <typename Number>
    std::vector<Channels<Number>> product(std::span<const Channels<Number>> light) const {
        std::vector<Channels<Number>> sums(clusters()), local(rows());
        for (uint32_t i = 0; i < clusters(); ++i) {
            for (uint32_t m = term_start(i); m < term_start(i + 1); ++m)
                add_scaled(sums[i], term(m).quarters, light[term(m).column]);
        }
        for (uint32_t j = 0; j < rows(); ++j) {
            for (uint32_t m = link_start(j); m < link_start(j + 1); ++m) add_scaled(local[j], 1, sums[link(m)]);
        }
        return local;
    }

  private:
    uint32_t bits(uint32_t word, uint32_t shift) const { return words_[word] >> shift & 0xff; }
    uint32_t field(uint32_t offset_word, uint32_t i, uint32_t bits) const;
    uint32_t start(uint32_t offset_word, uint32_t i, uint32_t count, uint32_t bits) const;
    Status check_content() const;

    std::span<const uint32_t> words_;
};

}  // namespace citystream::codec::radiance
