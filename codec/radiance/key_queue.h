// Items sorted by small whole numbers, all calls in constant time: the operations of a bicluster search by what they
// gain. Buckets are doubly linked lists through two arrays; of items with one key the last that got it comes first.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace citystream::codec::radiance {

class KeyQueue {
  public:
    explicit KeyQueue(uint32_t items) : links_(items) {}

    bool empty() const { return count_ == 0; }
    bool has(uint32_t item) const { return links_[item].key != kNone; }
    uint32_t key(uint32_t item) const { return links_[item].key; }
    /// Preconditions: not in the queue.
    void add(uint32_t item, uint32_t key) {
        if (key >= heads_.size()) heads_.resize(2 * size_t{key} + 2, kNone);
        Link& link = links_[item];
        link = {kNone, heads_[key], key};
        if (link.next != kNone) links_[link.next].previous = item;
        heads_[key] = item;
        least_ = count_ == 0 ? key : std::min(least_, key);
        most_ = count_ == 0 ? key : std::max(most_, key);
        ++count_;
    }
    /// Preconditions: in the queue, as for what follows.
    void remove(uint32_t item) {
        Link& link = links_[item];
        if (link.previous == kNone)
            heads_[link.key] = link.next;
        else
            links_[link.previous].next = link.next;
        if (link.next != kNone) links_[link.next].previous = link.previous;
        link.key = kNone;
        --count_;
    }
    void change(uint32_t item, uint32_t key) {
        remove(item);
        add(item, key);
    }
    /// An item with the least or the greatest key. Not of an empty queue. Amortised over the changes of keys.
    uint32_t least() {
        while (heads_[least_] == kNone) ++least_;
        return heads_[least_];
    }
    uint32_t most() {
        while (heads_[most_] == kNone) --most_;
        return heads_[most_];
    }

  private:
    static constexpr uint32_t kNone = ~0u;
    struct Link {
        uint32_t previous = kNone, next = kNone, key = kNone;
    };
    std::vector<Link> links_;
    std::vector<uint32_t> heads_;
    uint32_t least_ = 0, most_ = 0, count_ = 0;
};

}  // namespace citystream::codec::radiance
