#include "tests/tiles/layers/memory_count.h"

#ifdef CITYSTREAM_COUNTS_MEMORY

#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

namespace citystream::tiles::layers::memory_count {
namespace {

std::atomic<int64_t> held = 0, most = 0, before = 0;

void* take(size_t size) {
    void* memory = std::malloc(size);
    if (memory == nullptr) throw std::bad_alloc();
    const int64_t now = held += static_cast<int64_t>(malloc_usable_size(memory));
    for (int64_t seen = most; now > seen && !most.compare_exchange_weak(seen, now);) continue;
    return memory;
}

void give(void* memory) noexcept {
    if (memory == nullptr) return;
    held -= static_cast<int64_t>(malloc_usable_size(memory));
    std::free(memory);
}

}  // namespace

void start() {
    before = held.load();
    most = held.load();
}

uint64_t peak() {
    return static_cast<uint64_t>(most - before);
}

TEST(MemoryCount, SeesWhatIsHeldAtATime) {
    start();
    { const std::vector<char> first(1 << 20); }
    EXPECT_GE(peak(), uint64_t{1} << 20);
    EXPECT_LT(peak(), (uint64_t{1} << 20) + 65536);
    const std::vector<char> second(1 << 20), third(1 << 20);
    EXPECT_GE(peak(), uint64_t{2} << 20);
}

}  // namespace citystream::tiles::layers::memory_count

void* operator new(size_t size) {
    return citystream::tiles::layers::memory_count::take(size);
}
void operator delete(void* memory) noexcept {
    citystream::tiles::layers::memory_count::give(memory);
}
void operator delete(void* memory, size_t /*size*/) noexcept {
    citystream::tiles::layers::memory_count::give(memory);
}

#endif
