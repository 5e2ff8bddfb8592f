// A thread's place in a memory gate, held until it goes.
#pragma once

#include "tiles/layers/memory_gate.h"

namespace citystream::tiles::layers {

class MemoryPass {
  public:
    MemoryPass(MemoryGate& gate, uint64_t bytes) : gate_(gate), bytes_(bytes) { gate_.enter(bytes_); }
    ~MemoryPass() { gate_.leave(bytes_); }
    /// Waits until `bytes` fit instead. What was announced before does not count meanwhile, so that no two wait for
    /// each other.
    void change(uint64_t bytes) {
        gate_.leave(bytes_);
        bytes_ = 0;
        gate_.enter(bytes);
        bytes_ = bytes;
    }
    MemoryPass(const MemoryPass&) = delete;
    MemoryPass& operator=(const MemoryPass&) = delete;

  private:
    MemoryGate& gate_;
    uint64_t bytes_;
};

}  // namespace citystream::tiles::layers
