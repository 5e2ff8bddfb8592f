// Where each distinct word of a stream last occurred: a hash table with open addressing, at most half full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace citystream::codec::atlas {

class WordPositions {
  public:
    static constexpr uint32_t kNone = UINT32_MAX;

    /// kNone: the word has not occurred.
    uint32_t find(uint32_t word) const { return slots_[slot_of(word)].position; }

    /// `position` < kNone.
    void set(uint32_t word, uint32_t position) {
        if (2 * (count_ + 1) > slots_.size()) grow();
        Slot& slot = slots_[slot_of(word)];
        if (slot.position == kNone) ++count_;
        slot = {word, position};
    }

  private:
    struct Slot {
        uint32_t word = 0, position = kNone;
    };

    /// The word's slot, or the free one where it would go.
    size_t slot_of(uint32_t word) const {
        const size_t last = slots_.size() - 1;
        size_t at = (word * 0x9e3779b97f4a7c15u) >> shift_;
        while (slots_[at].position != kNone && slots_[at].word != word) at = (at + 1) & last;
        return at;
    }

    void grow() {
        const std::vector<Slot> before = std::move(slots_);
        slots_.assign(2 * before.size(), Slot());
        --shift_;
        for (const Slot& slot : before) {
            if (slot.position != kNone) slots_[slot_of(slot.word)] = slot;
        }
    }

    static constexpr int kFirstBits = 8;
    std::vector<Slot> slots_ = std::vector<Slot>(size_t{1} << kFirstBits);
    int shift_ = 64 - kFirstBits;
    size_t count_ = 0;
};

}  // namespace citystream::codec::atlas
