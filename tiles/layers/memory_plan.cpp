#include "tiles/layers/memory_plan.h"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace citystream::tiles::layers {
namespace {

constexpr uint64_t kMostFacadeBytes = uint64_t{64} << 20;
constexpr int kLargeBlockBytes = 1 << 20;

}  // namespace

MemoryPlan plan_memory(uint64_t limit, uint64_t resident) {
    const uint64_t free = std::max(limit - std::min(limit, resident), limit / 4);
    return {free / 2, free / 6, std::min(free / 8, kMostFacadeBytes)};
}

void return_freed_memory() {
    mallopt(M_MMAP_THRESHOLD, kLargeBlockBytes);  // a threshold that is set no longer grows
}

uint64_t resident_memory() {
    std::ifstream file("/proc/self/statm");
    uint64_t virtual_pages = 0, resident_pages = 0;
    if (!(file >> virtual_pages >> resident_pages)) return 0;
    return resident_pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

}  // namespace citystream::tiles::layers
