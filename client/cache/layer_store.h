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

/// A store of word arrays in fixed-size slots under a hard budget: they grow at their ends, and a precision buffer at
/// the end of one can take more bits. Implemented by the Vulkan renderer and, for tests and load clients, in host
/// memory.
class LayerStore {
  public:
    virtual ~LayerStore() = default;
    virtual uint64_t slot_bytes() const = 0;
    virtual uint64_t slot_count() const = 0;  ///< budget / slot_bytes
    virtual uint64_t slots_used() const = 0;  ///< by what the layers hold now
    /// Slots that an array of `bytes` takes.
    uint64_t slots_for(uint64_t bytes) const { return (bytes + slot_bytes() - 1) / slot_bytes(); }
    virtual LayerId create() = 0;
    /// Appends; fails when the slots do not suffice (the caller plans so that this never happens; it is asserted in
    /// tests).
    virtual Status append(LayerId layer, std::span<const uint32_t> words) = 0;
    /// The layer's words from word `begin` to its end are a precision buffer (codec/mesh/adaptive_precision.h): takes
    /// it to `to_level`, not below the one it has, by the planes between, one after the other. Returns the bytes of the
    /// layer then. The old words may have to stay until the new ones are written: as many slots must be free as the
    /// whole layer takes at its new size. Fails, and changes nothing, where they are not, where there is no such buffer
    /// or the number of planes' words is not what its header asks for.
    virtual Result<uint64_t> refine(LayerId layer, uint64_t begin, std::span<const uint32_t> planes,
                                    uint32_t to_level) = 0;
    /// Frees its slots; safe while earlier frames still read them (the store waits or defers).
    virtual void destroy(LayerId layer) = 0;
};

}  // namespace citystream::client
