// Chart words (codec/chart_word.h) as range coded decisions: mostly the word that stands next to it, or one used
// shortly before, or a chart that has not been used yet: the first of these, the next one after or before the last
// word's, or one of a number not far from it.
//
// One template for writer and reader (range_coder.h). Reading damaged bytes gives some word; whether it names a chart
// that there is, is for the caller to say. O(kRecent) a word, and the
// logarithm of how many charts there are.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <set>

#include "codec/bits/mixed_bits.h"
#include "codec/bits/range_coder.h"
#include "codec/chart_word.h"

namespace citystream::codec::mesh {

class ChartWordCode {
  public:
    static constexpr uint32_t kNone = ~uint32_t{0};  ///< no chart word
    static constexpr uint32_t kPlaces = 64;          ///< kinds of places that the caller tells apart
    static constexpr uint32_t kCandidates = 3;

    /// `place`: what is known of the thing that the word is of, below kPlaces. `candidates`: likely words, the
    /// likeliest first; kNone where there is none.
    template <typename Coder>
    uint32_t code(Coder& coder, uint32_t place, const std::array<uint32_t, kCandidates>& candidates, uint32_t word = 0);
    /// The last word coded was none of the candidates and none of those met shortly before.
    bool last_was_new() const { return last_was_new_; }

  private:
    static constexpr uint32_t kRecent = 128;
    /// How a chart is named that is not among the recent words.
    enum Naming : uint32_t { kFirstUnused, kNextUnused, kUnusedBefore, kAboveAll, kNear, kAny, kBeyond, kNamings };
    template <typename Coder>
    uint32_t code_other(Coder& coder, uint32_t place, uint32_t word);
    template <typename Coder>
    uint32_t code_chart(Coder& coder, uint32_t chart);
    template <typename Coder>
    uint32_t code_colour(Coder& coder, uint32_t colour);
    /// The chart that a naming alone names.
    uint32_t named(Naming naming) const;
    void meet(uint32_t word);

    bits::MixedBits candidate_{{kCandidates * kPlaces * 4, kCandidates * 64 * 4, kCandidates * 4}, 1};
    bits::BitModel is_new_[kPlaces], is_colour_[2];
    bits::MixedNumbers rank_{{kPlaces, 8}};
    std::array<bits::BitTree, kNamings> naming_ = {
        bits::BitTree(kNamings), bits::BitTree(kNamings), bits::BitTree(kNamings), bits::BitTree(kNamings),
        bits::BitTree(kNamings), bits::BitTree(kNamings), bits::BitTree(kNamings)};
    bits::NumberModel near_, beyond_;
    uint32_t last_naming_ = 0, last_rank_ = 0;
    /// Of the three channels, most significant bit first; made when the first colour comes.
    std::optional<bits::MixedBits> channels_;
    uint32_t last_colour_ = 0;
    std::set<uint32_t> used_;  ///< charts
    uint32_t first_unused_ = 0, above_all_ = 0, last_chart_ = 0;
    std::array<uint32_t, kRecent> recent_{};  ///< newest first
    uint32_t recent_count_ = 0;
    uint32_t history_ = 0;  ///< two bits a word: which candidate it was
    bool last_was_new_ = false;
    uint32_t last_new_is_colour_ = 1;
};

template <typename Coder>
uint32_t ChartWordCode::code(Coder& coder, uint32_t place, const std::array<uint32_t, kCandidates>& candidates,
                             uint32_t word) {
    uint32_t told = kNone, outcome = kCandidates;
    for (uint32_t i = 0; i < kCandidates && told == kNone; ++i) {
        const uint32_t candidate = candidates[i];
        if (candidate == kNone ||
            std::find(candidates.begin(), candidates.begin() + i, candidate) != candidates.begin() + i)
            continue;
        uint32_t alike = names_colour(candidate) ? 1 : 0;
        for (uint32_t j = i + 1; j < kCandidates; ++j) alike |= candidates[j] == candidate ? 2 : 0;
        candidate_.set_contexts(
            {(i * kPlaces + place) * 4 + alike, (i * 64 + (history_ & 63)) * 4 + alike, i * 4 + alike});
        if (candidate_.code(coder, 0, word == candidate ? 1 : 0) != 0) {
            told = candidate;
            outcome = i;
        }
    }
    history_ = history_ << 2 | outcome;
    last_was_new_ = false;
    if (told == kNone) told = code_other(coder, place, word);
    meet(told);
    return told;
}

/// A word that is no candidate.
template <typename Coder>
uint32_t ChartWordCode::code_other(Coder& coder, uint32_t place, uint32_t word) {
    uint32_t rank = 0;
    if constexpr (!Coder::kDecodes)
        rank =
            static_cast<uint32_t>(std::find(recent_.begin(), recent_.begin() + recent_count_, word) - recent_.begin());
    last_was_new_ = recent_count_ == 0 || coder.bit(is_new_[place], rank == recent_count_ ? 1 : 0) != 0;
    if (!last_was_new_) {
        rank_.set_contexts({place, last_rank_});
        rank = rank_.code(coder, rank);
        last_rank_ = std::min(static_cast<uint32_t>(std::bit_width(rank)), 7u);
        return recent_[std::min(rank, recent_count_ - 1)];
    }
    last_new_is_colour_ = coder.bit(is_colour_[last_new_is_colour_], names_colour(word) ? 1 : 0);
    if (last_new_is_colour_ != 0) return code_colour(coder, word);
    return code_chart(coder, word);
}

template <typename Coder>
uint32_t ChartWordCode::code_chart(Coder& coder, uint32_t chart) {
    constexpr uint32_t kFarthest = 64;
    const uint32_t step = bits::zigzag(static_cast<int32_t>(chart - last_chart_));
    uint32_t naming = 0;
    if constexpr (!Coder::kDecodes) {
        while (naming < kNear && chart != named(static_cast<Naming>(naming))) ++naming;
        if (naming == kNear && step > kFarthest) naming = chart < above_all_ ? kAny : kBeyond;
    }
    naming = naming_[last_naming_].code(coder, naming);
    last_naming_ = naming;
    if (naming < kNear)
        chart = named(static_cast<Naming>(naming));
    else if (naming == kNear)
        chart = last_chart_ + static_cast<uint32_t>(bits::unzigzag(near_.code(coder, step)));
    else if (naming == kAny)
        chart = coder.plain_bits(static_cast<uint32_t>(std::bit_width(above_all_)), chart);
    else
        chart = above_all_ + beyond_.code(coder, chart - above_all_);
    return chart & ~CHART_WORD_COLOUR;
}

/// Channel by channel: colours of one city have few values of each, and channels that go with each other.
template <typename Coder>
uint32_t ChartWordCode::code_colour(Coder& coder, uint32_t colour) {
    if (!channels_) channels_.emplace(std::initializer_list<uint32_t>{3, 3 * 16, 3 * 16}, 256);
    uint32_t told = 0, before = 0;
    for (uint32_t channel = 0; channel < 3; ++channel) {
        const uint32_t value = colour >> 8 * channel & 0xff, last = last_colour_ >> 8 * channel & 0xff;
        channels_->set_contexts({channel, channel * 16 + before / 16, channel * 16 + last / 16});
        uint32_t node = 1;
        for (uint32_t bit = 8; bit-- > 0;) node = 2 * node + channels_->code(coder, node, value >> bit & 1);
        before = node & 0xff;
        told |= before << 8 * channel;
    }
    last_colour_ = told;
    return CHART_WORD_COLOUR | told;
}

inline uint32_t ChartWordCode::named(Naming naming) const {
    constexpr int kMostSteps = 32;
    if (naming == kFirstUnused) return first_unused_;
    if (naming == kAboveAll) return above_all_;
    const uint32_t step = naming == kNextUnused ? 1 : ~0u;
    uint32_t chart = last_chart_ + step;
    for (int i = 0; i < kMostSteps && used_.count(chart) != 0; ++i) chart += step;
    return chart;
}

inline void ChartWordCode::meet(uint32_t word) {
    auto at =
        static_cast<uint32_t>(std::find(recent_.begin(), recent_.begin() + recent_count_, word) - recent_.begin());
    if (at == recent_count_) {
        recent_count_ = std::min(recent_count_ + 1, kRecent);
        at = recent_count_ - 1;
    }
    for (; at > 0; --at) recent_[at] = recent_[at - 1];
    recent_[0] = word;
    if (names_colour(word)) return;
    last_chart_ = word;
    above_all_ = std::max(above_all_, word + 1);
    used_.insert(word);
    while (used_.count(first_unused_) != 0) ++first_unused_;
}

}  // namespace citystream::codec::mesh
