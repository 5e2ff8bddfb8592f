// GPU memory for layers: slots of 1 KiB cut from 4 MiB chunks, under a hard budget. A layer is a list of slots that
// grows, or moves to others; a freed slot is the next one given out, so a pool never fragments. Chunks are allocated
// when first needed and never exceed the budget in sum.
//
// Where device memory can be mapped (software drivers, integrated GPUs, large BAR) words are written straight into
// their slots; otherwise through a staging buffer. Not thread safe. Nothing may be in flight on the queue when slots
// are written or freed (VulkanRenderer::draw waits for its frame).
#pragma once

#include <span>
#include <vector>

#include "client/cache/layer_store.h"
#include "client/render/buffer.h"

namespace citystream::client {

constexpr uint64_t kChunkBytes = 4 << 20;
constexpr uint64_t kSlotsPerChunk = kChunkBytes / kSlotBytes;

struct SlotLayer {
    bool live = false;
    uint64_t words = 0;
    std::vector<uint32_t> slots;  ///< slot numbers: chunk * kSlotsPerChunk + place in the chunk
};

struct SlotPool {
    const Device* device = nullptr;
    uint64_t slot_count = 0;  ///< budget / kSlotBytes
    uint64_t slots_used = 0;
    bool direct = true;  ///< chunks are mapped
    std::vector<Buffer> chunks;
    std::vector<uint8_t> used;     ///< one flag a slot of the allocated chunks
    uint32_t first_free_hint = 0;  ///< no slot below it is free
    std::vector<SlotLayer> layers;
    std::vector<LayerId> free_layers;
    Buffer staging;  ///< only when not direct
};

/// `allow_direct` false forces the staging way (tests).
SlotPool create_slot_pool(const Device& device, uint64_t budget_bytes, bool allow_direct = true);
void destroy_slot_pool(SlotPool& pool);

LayerId create_layer(SlotPool& pool);
/// Slots that appending so many words takes; 0 for a layer that is not live.
uint64_t slots_to_append(const SlotPool& pool, LayerId layer, uint64_t words);
inline uint64_t free_slots(const SlotPool& pool) {
    return pool.slot_count - pool.slots_used;
}
/// Appends words, filling the layer's last slot first. Fails, and changes nothing, when free slots do not suffice or
/// `layer` is not live.
Status append_words(SlotPool& pool, LayerId layer, std::span<const uint32_t> words);
void destroy_layer(SlotPool& pool, LayerId layer);
/// Gives the layer other slots, for `words` words that are undefined until something writes them. Returns what it was:
/// its slots stay taken until free_slots_of. Fails, and changes nothing, when free slots do not suffice or `layer` is
/// not live.
Result<SlotLayer> move_layer(SlotPool& pool, LayerId layer, uint64_t words);
void free_slots_of(SlotPool& pool, const SlotLayer& layer);
/// `count` words of the layer from `first` on, back from the GPU's memory; fewer where it has fewer, none of a layer
/// that is not live. Slow where memory is not mapped.
std::vector<uint32_t> read_words(const SlotPool& pool, LayerId layer, uint64_t count, uint64_t first = 0);

bool is_live(const SlotPool& pool, LayerId layer);
VkDeviceAddress slot_address(const SlotPool& pool, uint32_t slot);
/// Whether the layer's slots lie one behind the other in one chunk, so that its first address reaches all its words.
bool is_contiguous(const SlotPool& pool, const SlotLayer& layer);
uint64_t allocated_bytes(const SlotPool& pool);

}  // namespace citystream::client
