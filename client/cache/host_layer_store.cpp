#include "client/cache/host_layer_store.h"

#include <algorithm>

#include "codec/mesh/adaptive_precision.h"

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

bool HostLayerStore::has_room(uint64_t slots) {
    if (slots_used_ + slots > slot_count_) {
        ++refused_appends_;
        return false;
    }
    most_slots_used_ = std::max(most_slots_used_, slots_used_ + slots);
    return true;
}

Status HostLayerStore::append(LayerId layer, std::span<const uint32_t> words) {
    const auto found = layers_.find(layer);
    if (found == layers_.end()) return Error{"append to a layer that does not exist"};
    Array& array = found->second;
    const uint64_t grown = array.bytes + words.size_bytes();
    const uint64_t more = slots_for(grown) - slots_for(array.bytes);
    if (!has_room(more)) return Error{"the layer store has no free slots"};
    slots_used_ += more;
    array.bytes = grown;
    if (keep_words_) array.words.insert(array.words.end(), words.begin(), words.end());
    return Done{};
}

Result<uint64_t> HostLayerStore::refine(LayerId layer, uint64_t begin, std::span<const uint32_t> planes,
                                        uint32_t to_level) {
    const auto found = layers_.find(layer);
    if (found == layers_.end()) return Error{"a layer that does not exist cannot be refined"};
    Array& array = found->second;
    if (begin > array.words.size()) return Error{"a precision buffer behind the layer's words"};
    const auto view = codec::mesh::PrecisionView::create(std::span(array.words).subspan(begin));
    if (!view) return view.error();
    if (to_level < view->level()) return Error{"layers are refined to higher levels"};
    const Result<std::vector<uint32_t>> buffer = codec::mesh::change_level(*view, to_level, planes);
    if (!buffer) return buffer.error();
    const uint64_t bytes = sizeof(uint32_t) * (begin + buffer->size());
    if (!has_room(slots_for(bytes))) return Error{"the layer store has no free slots"};
    slots_used_ += slots_for(bytes) - slots_for(array.bytes);
    array.words.resize(begin);
    array.words.insert(array.words.end(), buffer->begin(), buffer->end());
    array.bytes = bytes;
    return bytes;
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
