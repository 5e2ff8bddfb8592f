// A thread's place in a memory gate, held until it goes.
#pragma once

#include "tiles/layers/memory_gate.h"

namespace citystream::tiles::layers {

class MemoryPass {
  public:
    MemoryPass(MemoryGate& gate, uint64_t bytes) : gate_(gate), bytes_(bytes) { gate_.enter(bytes_); }
    ~MemoryPass() { gate_.leave(bytes_); }
    MemoryPass(const MemoryPass&) = delete;
    MemoryPass& operator=(const MemoryPass&) = delete;

  private:
    MemoryGate& gate_;
    uint64_t bytes_;
};

}  // namespace citystream::tiles::layers
