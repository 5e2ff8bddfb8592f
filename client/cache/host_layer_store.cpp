#include "client/cache/host_layer_store.h"

#include <algorithm>

namespace citystream::client {

HostLayerStore::HostLayerStore(uint64_t budget_bytes, uint64_t slot_bytes, bool keep_words)
    : slot_bytes_(std::max<uint64_t>(1, slot_bytes)),
      slot_count_(budget_bytes / slot_bytes_),
      keep_words_(keep_words) {}

LayerId HostLayerStore::create() {
    while (next_ == kNoLayer || layers_.contains(next_)) ++next_;
    layers_.emplace(next_, Array{});
    return next_++;
}

Status HostLayerStore::append(LayerId layer, std::span<const uint32_t> words) {
    const auto found = layers_.find(layer);
    if (found == layers_.end()) return Error{"append to a layer that does not exist"};
    Array& array = found->second;
    const uint64_t grown = array.bytes + words.size_bytes();
    const uint64_t more = slots_for(grown) - slots_for(array.bytes);
    if (slots_used_ + more > slot_count_) {
        ++refused_appends_;
        return Error{"the layer store has no free slots"};
    }
    slots_used_ += more;
    most_slots_used_ = std::max(most_slots_used_, slots_used_);
    array.bytes = grown;
    if (keep_words_) array.words.insert(array.words.end(), words.begin(), words.end());
    return Done{};
}

void HostLayerStore::destroy(LayerId layer) {
    const auto found = layers_.find(layer);
    if (found == layers_.end()) return;
    slots_used_ -= slots_for(found->second.bytes);
    layers_.erase(found);
}

uint64_t HostLayerStore::bytes_of(LayerId layer) const {
    const auto found = layers_.find(layer);
    return found == layers_.end() ? 0 : found->second.bytes;
}

std::span<const uint32_t> HostLayerStore::words_of(LayerId layer) const {
    const auto found = layers_.find(layer);
    return found == layers_.end() ? std::span<const uint32_t>{} : std::span<const uint32_t>(found->second.words);
}

}  // namespace citystream::client
