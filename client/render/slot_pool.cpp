#include "client/render/slot_pool.h"

#include <algorithm>
#include <cstring>
#include <optional>

namespace citystream::client {
namespace {

constexpr uint64_t kSlotWords = kSlotBytes / 4;
constexpr uint64_t kStagingBytes = 1 << 20;

uint64_t slots_for(uint64_t words) {
    return (words + kSlotWords - 1) / kSlotWords;
}

Error no_room(const SlotPool& pool, uint64_t needed) {
    return Error{"GPU budget exhausted: " + std::to_string(needed) + " slots needed, " +
                 std::to_string(free_slots(pool)) + " free"};
}

// Slots of chunk `chunk`; the last chunk is smaller when the budget is no multiple of the chunk.
uint64_t slots_of_chunk(const SlotPool& pool, uint64_t chunk) {
    return std::min(kSlotsPerChunk, pool.slot_count - chunk * kSlotsPerChunk);
}

void add_chunk(SlotPool& pool) {
    const uint64_t slots = slots_of_chunk(pool, pool.chunks.size());
    const BufferPlace place = pool.direct ? BufferPlace::kDeviceHost : BufferPlace::kDevice;
    pool.chunks.push_back(create_buffer(*pool.device, slots * kSlotBytes, place));
    pool.used.resize(pool.used.size() + slots, 0);
}

// First run of `count` free slots in one chunk of those allocated.
std::optional<uint64_t> find_free_run(const SlotPool& pool, uint64_t count) {
    if (count > kSlotsPerChunk) return std::nullopt;
    uint64_t run = 0;
    for (uint64_t slot = pool.first_free_hint; slot < pool.used.size(); ++slot) {
        if (slot % kSlotsPerChunk == 0) run = 0;
        run = pool.used[slot] != 0 ? 0 : run + 1;
        if (run == count) return slot + 1 - count;
    }
    return std::nullopt;
}

void take_slot(SlotPool& pool, SlotLayer& layer, uint64_t slot) {
    pool.used[slot] = 1;
    ++pool.slots_used;
    layer.slots.push_back(static_cast<uint32_t>(slot));
}

void advance_hint(SlotPool& pool) {
    while (pool.first_free_hint < pool.used.size() && pool.used[pool.first_free_hint] != 0) ++pool.first_free_hint;
}

// The slots that follow the layer's last one, if they are free and enough: a refined layer stays in one piece.
bool extend_in_place(SlotPool& pool, SlotLayer& layer, uint64_t count) {
    if (layer.slots.empty()) return false;
    const uint64_t begin = layer.slots.back() + uint64_t{1};
    const uint64_t end = begin + count;
    if (end > pool.used.size() || (end - 1) / kSlotsPerChunk != layer.slots.back() / kSlotsPerChunk) return false;
    if (std::any_of(pool.used.begin() + begin, pool.used.begin() + end, [](uint8_t u) { return u != 0; })) return false;
    for (uint64_t slot = begin; slot < end; ++slot) take_slot(pool, layer, slot);
    return true;
}

// Takes `count` slots, in one run where there is one; new chunks only when the free slots do not suffice. The caller
// has checked that the budget holds them.
void take_slots(SlotPool& pool, SlotLayer& layer, uint64_t count) {
    if (count == 0 || extend_in_place(pool, layer, count)) return;
    while (pool.used.size() - pool.slots_used < count) add_chunk(pool);
    if (const std::optional<uint64_t> begin = find_free_run(pool, count)) {
        for (uint64_t slot = *begin; slot < *begin + count; ++slot) take_slot(pool, layer, slot);
        return;
    }
    for (uint64_t slot = pool.first_free_hint; count > 0; ++slot) {
        if (pool.used[slot] != 0) continue;
        take_slot(pool, layer, slot);
        --count;
    }
}

void write_staged(SlotPool& pool, uint64_t chunk, uint64_t byte, std::span<const uint32_t> words) {
    if (pool.staging.handle == VK_NULL_HANDLE) {
        pool.staging = create_buffer(*pool.device, kStagingBytes, BufferPlace::kUpload);
    }
    std::memcpy(pool.staging.mapped, words.data(), words.size_bytes());
    submit_and_wait(*pool.device, [&](VkCommandBuffer commands) {
        const VkBufferCopy copy{0, byte, words.size_bytes()};
        vkCmdCopyBuffer(commands, pool.staging.handle, pool.chunks[chunk].handle, 1, &copy);
        memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT);
    });
}

// Writes inside one chunk.
void write_chunk(SlotPool& pool, uint64_t chunk, uint64_t byte, std::span<const uint32_t> words) {
    if (!pool.direct) {
        write_staged(pool, chunk, byte, words);
        return;
    }
    std::memcpy(static_cast<std::byte*>(pool.chunks[chunk].mapped) + byte, words.data(), words.size_bytes());
}

// Words from the layer's end to where its memory stops being in one piece.
uint64_t words_in_one_piece(const SlotLayer& layer) {
    uint64_t slot = layer.words / kSlotWords;
    uint64_t words = kSlotWords - layer.words % kSlotWords;
    while (slot + 1 < layer.slots.size() && layer.slots[slot + 1] == layer.slots[slot] + 1 &&
           layer.slots[slot + 1] % kSlotsPerChunk != 0) {
        words += kSlotWords;
        ++slot;
    }
    return words;
}

}  // namespace

SlotPool create_slot_pool(const Device& device, uint64_t budget_bytes, bool allow_direct) {
    SlotPool pool;
    pool.device = &device;
    pool.slot_count = budget_bytes / kSlotBytes;
    pool.direct = allow_direct && has_device_host_memory(device, budget_bytes);
    return pool;
}

void destroy_slot_pool(SlotPool& pool) {
    for (Buffer& chunk : pool.chunks) destroy_buffer(*pool.device, chunk);
    if (pool.device != nullptr) destroy_buffer(*pool.device, pool.staging);
    pool = {};
}

LayerId create_layer(SlotPool& pool) {
    LayerId id = static_cast<LayerId>(pool.layers.size());
    if (pool.free_layers.empty()) {
        pool.layers.emplace_back();
    } else {
        id = pool.free_layers.back();
        pool.free_layers.pop_back();
    }
    pool.layers[id].live = true;
    return id;
}

Result<SlotLayer> move_layer(SlotPool& pool, LayerId id, uint64_t words) {
    if (!is_live(pool, id)) return Error{"a layer that does not exist cannot move"};
    const uint64_t needed = slots_for(words);
    if (needed > free_slots(pool)) return no_room(pool, needed);
    SlotLayer moved;
    moved.live = true;
    moved.words = words;
    take_slots(pool, moved, needed);
    advance_hint(pool);
    std::swap(pool.layers[id], moved);
    return moved;
}

uint64_t slots_to_append(const SlotPool& pool, LayerId id, uint64_t words) {
    if (!is_live(pool, id)) return 0;
    const SlotLayer& layer = pool.layers[id];
    return slots_for(layer.words + words) - layer.slots.size();
}

Status append_words(SlotPool& pool, LayerId id, std::span<const uint32_t> words) {
    if (!is_live(pool, id)) return Error{"append to a layer that does not exist"};
    SlotLayer& layer = pool.layers[id];
    const uint64_t needed = slots_to_append(pool, id, words.size());
    if (needed > free_slots(pool)) return no_room(pool, needed);
    take_slots(pool, layer, needed);
    advance_hint(pool);
    while (!words.empty()) {
        const uint32_t slot = layer.slots[layer.words / kSlotWords];
        const uint64_t byte = slot % kSlotsPerChunk * kSlotBytes + layer.words % kSlotWords * 4;
        const uint64_t count = std::min({words.size(), words_in_one_piece(layer), kStagingBytes / 4});
        write_chunk(pool, slot / kSlotsPerChunk, byte, words.first(count));
        layer.words += count;
        words = words.subspan(count);
    }
    return Done{};
}

std::vector<uint32_t> read_words(const SlotPool& pool, LayerId id, uint64_t count, uint64_t first) {
    if (!is_live(pool, id) || first >= pool.layers[id].words || count == 0) return {};
    const SlotLayer& layer = pool.layers[id];
    std::vector<uint32_t> words(std::min(count, layer.words - first));
    const uint64_t begin = first / kSlotWords, end = slots_for(first + words.size());
    const auto byte_of = [](uint32_t slot) { return slot % kSlotsPerChunk * kSlotBytes; };
    const auto copy_out = [&](uint64_t i, const std::byte* from) {
        const uint64_t at = std::max(first, i * kSlotWords);
        const uint64_t here = std::min((i + 1) * kSlotWords, first + words.size()) - at;
        std::memcpy(&words[at - first], from + at % kSlotWords * 4, here * 4);
    };
    if (pool.direct) {
        for (uint64_t i = begin; i < end; ++i) {
            const Buffer& chunk = pool.chunks[layer.slots[i] / kSlotsPerChunk];
            copy_out(i, static_cast<const std::byte*>(chunk.mapped) + byte_of(layer.slots[i]));
        }
        return words;
    }
    Buffer buffer = create_buffer(*pool.device, (end - begin) * kSlotBytes, BufferPlace::kReadback);
    submit_and_wait(*pool.device, [&](VkCommandBuffer commands) {
        for (uint64_t i = begin; i < end; ++i) {
            const VkBufferCopy copy{byte_of(layer.slots[i]), (i - begin) * kSlotBytes, kSlotBytes};
            vkCmdCopyBuffer(commands, pool.chunks[layer.slots[i] / kSlotsPerChunk].handle, buffer.handle, 1, &copy);
        }
        memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    });
    for (uint64_t i = begin; i < end; ++i) {
        copy_out(i, static_cast<const std::byte*>(buffer.mapped) + (i - begin) * kSlotBytes);
    }
    destroy_buffer(*pool.device, buffer);
    return words;
}

void free_slots_of(SlotPool& pool, const SlotLayer& layer) {
    for (const uint32_t slot : layer.slots) {
        pool.used[slot] = 0;
        pool.first_free_hint = std::min(pool.first_free_hint, slot);
    }
    pool.slots_used -= layer.slots.size();
}

void destroy_layer(SlotPool& pool, LayerId id) {
    if (!is_live(pool, id)) return;
    free_slots_of(pool, pool.layers[id]);
    pool.layers[id] = {};
    pool.free_layers.push_back(id);
}

bool is_live(const SlotPool& pool, LayerId id) {
    return id < pool.layers.size() && pool.layers[id].live;
}

VkDeviceAddress slot_address(const SlotPool& pool, uint32_t slot) {
    return pool.chunks[slot / kSlotsPerChunk].address + slot % kSlotsPerChunk * kSlotBytes;
}

bool is_contiguous(const SlotPool& pool, const SlotLayer& layer) {
    for (size_t i = 1; i < layer.slots.size(); ++i) {
        if (slot_address(pool, layer.slots[i]) != slot_address(pool, layer.slots[i - 1]) + kSlotBytes) return false;
        if (layer.slots[i] / kSlotsPerChunk != layer.slots[0] / kSlotsPerChunk) return false;
    }
    return true;
}

uint64_t allocated_bytes(const SlotPool& pool) {
    uint64_t bytes = 0;
    for (const Buffer& chunk : pool.chunks) bytes += chunk.bytes;
    return bytes;
}

}  // namespace citystream::client
