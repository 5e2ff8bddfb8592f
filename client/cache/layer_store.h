// What holds decoded layers for drawing: the seam between streaming (which decides) and rendering (which owns GPU
// memory).
#pragma once

#include <cstdint>
#include <span>

#include "codec/result.h"

namespace citystream::client {

using LayerId = uint32_t;
inline constexpr LayerId kNoLayer = ~LayerId{0};

/// Bytes of a slot in every store of this client. Small, as most facade maps take less: a dictionary of thousands of
/// maps must not cost a multiple of itself.
inline constexpr uint64_t kSlotBytes = 1 << 10;

/// A store of append-only word arrays in fixed-size slots under a hard budget. Implemented by the Vulkan renderer and,
/// for tests and load clients, in host memory.
class LayerStore {
  public:
    virtual ~LayerStore() = default;
    virtual uint64_t slot_bytes() const = 0;
    virtual uint64_t slot_count() const = 0;  ///< budget / slot_bytes
    virtual uint64_t slots_used() const = 0;
    /// Slots that an array of `bytes` takes.
    uint64_t slots_for(uint64_t bytes) const { return (bytes + slot_bytes() - 1) / slot_bytes(); }
    virtual LayerId create() = 0;
    /// Appends; fails when the slots do not suffice (the caller plans so that this never happens; it is asserted in
    /// tests).
    virtual Status append(LayerId layer, std::span<const uint32_t> words) = 0;
    /// Frees its slots; safe while earlier frames still read them (the store waits or defers).
    virtual void destroy(LayerId layer) = 0;
};

}  // namespace citystream::client
