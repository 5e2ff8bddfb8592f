// From the payloads of facade maps to checked resident words, in the form that the renderer reads; many at once, on all
// cores.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "codec/facade/facade_form.h"

namespace citystream::client {

/// One level of a map to prepare. `wire` stays the caller's and must outlive the call.
struct MapJob {
    std::span<const std::byte> wire;
    uint32_t resident_bytes = 0;  ///< of the form in which it arrives
};

struct PreparedMap {
    std::vector<uint32_t> words;  ///< empty: the payload is bad
    std::string failure;          ///< why, when it is
    bool converted = false;       ///< to the form asked for
    bool refused = false;         ///< that form does not pay: the words are raw
    bool opaque = false;          ///< no open cells
    double convert_ms = 0;        ///< of one core
};

/// What the renderer reads. A map that the form refuses becomes raw words, for the uncompressed renderer with the same
/// stepper.
struct MapTarget {
    codec::facade::FacadeForm form = codec::facade::FacadeForm::kPatch;
    bool boxes = true;  ///< raw words hold free boxes
};

/// Expands, checks and, with a target, converts. Results are those of the jobs in their order, whatever the number of
/// threads (0: one a core). Expanding is about as fast as reading memory; binary factors take seconds a map.
std::vector<PreparedMap> prepare_maps(std::span<const MapJob> jobs, const std::optional<MapTarget>& target,
                                      uint32_t threads);

/// Host bytes that preparing a map takes at most, with its result: an estimate from its size in texels where it is
/// converted.
uint64_t preparing_bytes(uint32_t resident_bytes, uint32_t width, uint32_t height,
                         const std::optional<MapTarget>& target);

}  // namespace citystream::client
