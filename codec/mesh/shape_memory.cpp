#include "codec/mesh/shape_memory.h"

namespace citystream::codec::mesh {

namespace {

uint64_t shape_key(const GatePlaces& g, uint32_t tolerance) {
    uint64_t key = 0;
    for (size_t k = 0; k < 3; ++k) {
        for (const int64_t side : {int64_t{g.b[k]} - g.a[k], int64_t{g.c[k]} - g.a[k]}) {
            const int64_t rounded = (side + (int64_t{1} << tolerance >> 1)) >> tolerance;
            key = (key ^ static_cast<uint64_t>(rounded)) * 0x9e3779b97f4a7c15;
            key ^= key >> 29;
        }
    }
    return key == 0 ? 1 : key;
}

}  // namespace

size_t ShapeMemory::Memory::slot_of(uint64_t key) const {
    const size_t mask = slots_.size() - 1, first = (key ^ key >> 32) & mask;
    for (size_t step = 0; step < kMostSteps; ++step) {
        const size_t at = (first + step) & mask;
        if (slots_[at].key == key || slots_[at].key == 0) return at;
    }
    return first;
}

const Vector* ShapeMemory::Memory::find(uint64_t key) const {
    const Slot& slot = slots_[slot_of(key)];
    return slot.key == key ? &slot.place : nullptr;
}

void ShapeMemory::Memory::set(uint64_t key, const Vector& place) {
    Slot& slot = slots_[slot_of(key)];
    used_ += slot.key == 0 ? 1 : 0;
    slot = {key, place};
    if (2 * used_ > slots_.size()) grow();
}

void ShapeMemory::Memory::grow() {
    std::vector<Slot> before(2 * slots_.size());
    before.swap(slots_);
    used_ = 0;
    for (const Slot& slot : before) {
        if (slot.key == 0) continue;
        Slot& to = slots_[slot_of(slot.key)];
        used_ += to.key == 0 ? 1 : 0;
        to = slot;
    }
}

std::optional<ShapeMemory::Recalled> ShapeMemory::recall(const GatePlaces& g) {
    for (size_t k = 0; k < 3; ++k) centre_[k] = (double{1} * g.a[k] + g.b[k] + g.c[k]) / 3;
    keys_ = {shape_key(g, kFine), shape_key(g, kCoarse)};
    for (size_t i = 0; i < keys_.size(); ++i) {
        const Vector* known = memories_[i].find(keys_[i]);
        if (known == nullptr) continue;
        Recalled recalled{centre_, i == 0};
        for (size_t k = 0; k < 3; ++k) recalled.place[k] += (*known)[k];
        return recalled;
    }
    return std::nullopt;
}

void ShapeMemory::remember(const GridPoint& apex) {
    Vector from_centre{};
    for (size_t k = 0; k < 3; ++k) from_centre[k] = apex[k] - centre_[k];
    for (size_t i = 0; i < keys_.size(); ++i) memories_[i].set(keys_[i], from_centre);
}

}  // namespace citystream::codec::mesh
