// What a 32-bit word of a stream is expected to take once zstd has compressed the stream, so that an encoder can prefer
// words that take less. Costs in sixteenths of a bit, whole numbers, the same everywhere.
//
// The model: a word that occurred before is a match, dearer with its distance, and almost free where the word before it
// was matched at the same distance; any other word is four literals, each by the frequency of its byte so far.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/atlas/word_positions.h"

namespace citystream::codec::atlas {

/// log2(value) in sixteenths, within one of them; value >= 1.
uint32_t log2_sixteenths(uint64_t value);

class WordRate {
  public:
    /// Remembers the latest `window` distinct words for recent().
    explicit WordRate(uint32_t window);

    /// The bytes of `words` are taken into account for byte frequencies, as if seen: a first guess of what is to come.
    void expect(std::span<const uint32_t> words);

    /// Cost of `word` as the next one.
    uint32_t cost(uint32_t word) const;
    /// Cost of each byte value as a literal, kept up to date every few hundred words.
    std::span<const uint32_t, 256> byte_costs() const { return byte_costs_; }

    void append(uint32_t word);
    uint32_t size() const { return static_cast<uint32_t>(words_.size()); }
    uint32_t operator[](uint32_t position) const { return words_[position]; }

    /// The latest distinct words, the last one first.
    std::span<const uint32_t> recent() const { return recent_words_; }
    /// Costs of all of recent(), in its order, times `scale`.
    void recent_costs(std::vector<uint32_t>& costs, uint32_t scale = 1) const;
    /// What any word costs at least as the next one.
    uint32_t least_cost() const;
    /// The same of a word that recent() does not have and that makes no match longer.
    uint32_t least_other_cost() const;
    /// The word that would make the match that the last word was in one word longer; false if it was in none.
    bool continuation(uint32_t& word) const;

  private:
    uint32_t literal_sum(uint32_t word) const;
    uint32_t literal_cost(uint32_t word) const;
    uint32_t cost_of(uint32_t word, uint32_t position) const;
    size_t place_of(uint32_t word) const;
    void update_costs();
    void remember(uint32_t word, uint32_t position);

    uint32_t window_;
    std::vector<uint32_t> words_;
    /// Of the latest distinct words: where each last occurred, and its literal_sum.
    std::vector<uint32_t> recent_words_, recent_positions_, recent_literals_;
    WordPositions last_position_;
    std::array<uint64_t, 256> counts_ = {};
    std::array<uint32_t, 256> byte_costs_;
    uint32_t least_byte_cost_ = 0;
    uint32_t last_distance_ = 0;  ///< of the latest match
    bool in_match_ = false;       ///< the last word was one
};

}  // namespace citystream::codec::atlas
