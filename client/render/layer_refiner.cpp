#include "client/render/layer_refiner.h"

#include <algorithm>
#include <cstring>

namespace citystream::client {
namespace {

// What waits is run when it comes to this many words: memory for planes stays small, and one dispatch numbers all words
// by 32 bits.
constexpr uint64_t kMostPlaneWords = 4 << 20;
constexpr uint64_t kMostTargetWords = uint64_t{1} << 31;
constexpr uint64_t kMostHeaderWords = PRECISION_WORD_BINS + PRECISION_BIN_WORDS * PRECISION_MOST_BINS;

uint64_t rounded_up(uint64_t bytes) {
    return (bytes + 7) / 8 * 8;
}

// Writes page tables behind each other into mapped memory.
class PageWriter {
  public:
    PageWriter(const SlotPool& pool, const Buffer& buffer, uint64_t offset)
        : pool_(pool), buffer_(buffer), offset_(offset) {}

    // The layer's reference (draw_layout.h).
    VkDeviceAddress refer(const SlotLayer& layer) {
        if (is_contiguous(pool_, layer)) return slot_address(pool_, layer.slots[0]) | LAYER_REF_DIRECT;
        const VkDeviceAddress table = buffer_.address + offset_;
        for (const uint32_t slot : layer.slots) {
            const VkDeviceAddress address = slot_address(pool_, slot);
            std::memcpy(static_cast<std::byte*>(buffer_.mapped) + offset_, &address, sizeof address);
            offset_ += sizeof address;
        }
        return table;
    }

  private:
    const SlotPool& pool_;
    const Buffer& buffer_;
    uint64_t offset_;
};

}  // namespace

LayerRefiner::~LayerRefiner() {
    destroy_buffer(device_, upload_);
}

bool LayerRefiner::is_waiting(LayerId layer) const {
    return std::any_of(waiting_.begin(), waiting_.end(), [&](const Waiting& w) { return w.change.layer == layer; });
}

Result<LayerRefinement> LayerRefiner::plan(LayerId layer, uint64_t begin, uint64_t plane_words, uint32_t to_level) {
    if (!is_live(pool_, layer)) return Error{"a layer that does not exist cannot be refined"};
    settle(layer);
    const uint64_t words = pool_.layers[layer].words;
    auto header = codec::mesh::read_precision_header(read_words(pool_, layer, kMostHeaderWords, begin));
    if (!header) return header.error();
    codec::mesh::PrecisionShape& shape = header->shape;
    if (begin + shape.words_at(header->level) != words) return Error{"a precision buffer that is not the layer's rest"};
    if (to_level < header->level || to_level > shape.full_bits) return Error{"layers are refined to higher levels"};
    if (plane_words != shape.words_between(header->level, to_level)) return Error{"precision planes: length"};
    const uint64_t refined = begin + shape.words_at(to_level);
    if (refined > kMostTargetWords) return Error{"the layer is too large to be refined"};
    return LayerRefinement{layer, static_cast<uint32_t>(begin), std::move(shape), header->level, to_level, refined};
}

Status LayerRefiner::add(const LayerRefinement& refinement, std::span<const uint32_t> planes) {
    if (refinement.to_level == refinement.from_level) return Done{};
    if (planes_.size() + planes.size() > kMostPlaneWords || target_words_ + refinement.words > kMostTargetWords) run();
    Result<SlotLayer> old = move_layer(pool_, refinement.layer, refinement.words);
    if (!old) return old.error();
    held_slots_ += old->slots.size();
    target_words_ += refinement.words;
    waiting_.push_back({refinement, std::move(*old), planes_.size()});
    planes_.insert(planes_.end(), planes.begin(), planes.end());
    return Done{};
}

void LayerRefiner::settle(LayerId layer) {
    if (is_waiting(layer)) run();
}

void LayerRefiner::make_room(uint64_t slots) {
    if (is_waiting() && slots > free_slots(pool_)) run();
}

void LayerRefiner::forget(LayerId layer) {
    std::erase_if(waiting_, [&](const Waiting& waiting) {
        if (waiting.change.layer != layer) return false;
        held_slots_ -= waiting.old.slots.size();
        target_words_ -= waiting.change.words;
        free_slots_of(pool_, waiting.old);
        return true;
    });
}

uint64_t LayerRefiner::page_bytes(const SlotLayer& layer) const {
    return is_contiguous(pool_, layer) ? 0 : sizeof(VkDeviceAddress) * layer.slots.size();
}

// The upload buffer: jobs, page tables, planes.
void LayerRefiner::record(VkCommandBuffer commands) {
    if (!is_waiting()) return;
    if (!merger_) merger_.emplace(device_);
    const uint64_t pages_at = rounded_up(PrecisionMerger::table_bytes(waiting_.size()));
    uint64_t planes_at = pages_at;
    for (const Waiting& waiting : waiting_)
        planes_at += page_bytes(waiting.old) + page_bytes(pool_.layers[waiting.change.layer]);
    const uint64_t bytes = planes_at + 4 * planes_.size();
    if (upload_.bytes < bytes) {
        destroy_buffer(device_, upload_);
        upload_ = create_buffer(device_, std::max<uint64_t>(64 << 10, bytes + bytes / 2), BufferPlace::kUpload);
    }
    if (!planes_.empty())
        std::memcpy(static_cast<std::byte*>(upload_.mapped) + planes_at, planes_.data(), 4 * planes_.size());
    PageWriter pages(pool_, upload_, pages_at);
    std::vector<PrecisionChange> changes;
    for (const Waiting& waiting : waiting_) {
        const LayerRefinement& change = waiting.change;
        const VkDeviceAddress planes = upload_.address + planes_at + 4 * waiting.planes_at;
        changes.push_back({&change.shape, change.from_level, change.to_level, pages.refer(waiting.old),
                           planes | LAYER_REF_DIRECT, pages.refer(pool_.layers[change.layer]), change.begin});
    }
    merger_->record(commands, changes, upload_);
    memory_barrier(
        commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
        VK_PIPELINE_STAGE_ALL_COMMANDS_BIT | VK_PIPELINE_STAGE_HOST_BIT,
        VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT | VK_ACCESS_HOST_READ_BIT | VK_ACCESS_HOST_WRITE_BIT);
}

void LayerRefiner::finish() {
    for (const Waiting& waiting : waiting_) free_slots_of(pool_, waiting.old);
    waiting_.clear();
    planes_.clear();
    target_words_ = held_slots_ = 0;
}

void LayerRefiner::run() {
    if (!is_waiting()) return;
    submit_and_wait(device_, [&](VkCommandBuffer commands) { record(commands); });
    finish();
}

}  // namespace citystream::client
