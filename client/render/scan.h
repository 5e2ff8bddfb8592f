// Scans on the GPU: out[i] = A[0] op ... op A[i - 1] (exclusive, 0 where there is nothing) or with A[i] (inclusive),
// sum modulo 2^32 or maximum, over a stream of elements of 1..32 bits to which a function is applied as they are loaded
// (Meyer 2012, section 5.4.1; the notes' T8). Any number of segments are scanned at once, each on its own. The strip
// decoder has scans of its own kind, made of the same parts (shaders/scan_workgroup.glsl, shaders/scan_look_back.glsl).
//
// Two ways, same results: in one pass, where each block of elements looks back at those before it (no block waits for
// another that may not run: what it does not say is worked out again), or in three passes. Both are O(n) work; the one
// pass reads its input once and has one barrier less to wait at.
//
// Errors: VulkanError.
#pragma once

#include <array>
#include <optional>

#include "client/render/buffer.h"
#include "client/render/pipelines.h"
#include "client/render/scan_layout.h"

namespace citystream::client {

enum class ScanPath { kLookBack, kPasses };

/// How scans are run; the results do not depend on it.
struct ScanTuning {
    ScanPath path = ScanPath::kPasses;
    bool subgroups = false;   ///< precondition: subgroups_fit_scans(device)
    uint32_t patience = 256;  ///< looks at a block that says nothing before its total is worked out again
    uint32_t silent = 0;      ///< n > 0: every n-th block says nothing, as one that is never run (tests)
};

/// Whether the device shuffles in subgroups that fill a scan's workgroup.
bool subgroups_fit_scans(const Device& device);
/// Subgroups where they fit; look-back where they do and the device is not a software driver, which runs one workgroup
/// after the other.
ScanTuning choose_scan_tuning(const Device& device);

/// The specialization constants of a scan's phase, then those of its own from number SCAN_OPERATION_CONSTANT on.
struct ScanPhaseConstants {
    static constexpr size_t kMost = 7;
    std::array<uint32_t, kMost> values{};
    std::array<VkSpecializationMapEntry, kMost> entries{};
    VkSpecializationInfo info{};
    ScanPhaseConstants(uint32_t phase, const ScanTuning& tuning, std::span<const uint32_t> own = {});
    ScanPhaseConstants(const ScanPhaseConstants&) = delete;
    ScanPhaseConstants& operator=(const ScanPhaseConstants&) = delete;
};

struct ScanKind {
    uint32_t operation = SCAN_OPERATION_SUM;
    bool inclusive = false;
    uint32_t element_bits = 32;  ///< 1, 2, 4, 8, 16, 32: packed from the least significant bit of each word up
    uint32_t transform = SCAN_TRANSFORM_NONE;
};

struct Scan {
    ScanTuning tuning;
    std::array<Pass, 3> passes{};  ///< of the one pass only the first
};

Scan create_scan(const Device& device, const ScanKind& kind, const ScanTuning& tuning);
void destroy_scan(const Device& device, Scan& scan);

/// The most elements of one scan.
constexpr uint32_t kMostScanElements = uint32_t{SCAN_MOST_BLOCKS} * SCAN_BLOCK_ELEMENTS;
/// Working memory of a scan of so many elements; aligned to 8 bytes.
uint64_t scan_state_words(const ScanTuning& tuning, uint32_t count);

/// Where a scan's data lie; none overlap.
struct ScanPlaces {
    VkDeviceAddress elements = 0;
    VkDeviceAddress output = 0;  ///< a word an element
    VkDeviceAddress segments =
        0;  ///< first elements of segments, ascending (equal ones: empty segments); may be 0 when there are none
    uint32_t segment_count = 0;  ///< 0: one segment
    const Buffer* state = nullptr;
    uint64_t state_offset = 0;  ///< bytes, a multiple of 8
};

/// 0 < count <= kMostScanElements. The caller's barriers make the input visible before and the output after.
void record_scan(VkCommandBuffer commands, const Scan& scan, const ScanPlaces& places, uint32_t count);

/// Between passes of one scan.
void scan_barrier(VkCommandBuffer commands);
/// Zeroes the state of a scan with look-back, and makes that visible to it.
void clear_scan_state(VkCommandBuffer commands, const Buffer& state, uint64_t offset, uint64_t words);

}  // namespace citystream::client
