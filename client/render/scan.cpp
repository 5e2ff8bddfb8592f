#include "client/render/scan.h"

#include <algorithm>
#include <cstring>

#include "shaders/scan.comp.h"
#include "shaders/scan_subgroups.comp.h"

namespace citystream::client {

bool subgroups_fit_scans(const Device& device) {
    return device.shuffle_lanes > 1 && SCAN_LANES % device.shuffle_lanes == 0;
}

ScanTuning choose_scan_tuning(const Device& device) {
    ScanTuning tuning;
    tuning.subgroups = subgroups_fit_scans(device);
    tuning.path = tuning.subgroups && !device.is_cpu ? ScanPath::kLookBack : ScanPath::kPasses;
    return tuning;
}

ScanPhaseConstants::ScanPhaseConstants(uint32_t phase, const ScanTuning& tuning, std::span<const uint32_t> own) {
    constexpr size_t kShared = SCAN_OPERATION_CONSTANT - SCAN_PHASE_CONSTANT;
    values = {phase, tuning.patience, tuning.silent};
    std::copy(own.begin(), own.end(), values.begin() + kShared);
    const auto count = static_cast<uint32_t>(kShared + own.size());
    for (uint32_t i = 0; i < count; ++i) entries[i] = {SCAN_PHASE_CONSTANT + i, i * 4, 4};
    info = {count, entries.data(), count * sizeof(uint32_t), values.data()};
}

Scan create_scan(const Device& device, const ScanKind& kind, const ScanTuning& tuning) {
    const std::array<uint32_t, 4> own = {kind.operation, kind.inclusive ? 1u : 0u, kind.element_bits, kind.transform};
    const bool single = tuning.path == ScanPath::kLookBack;
    Scan scan;
    scan.tuning = tuning;
    try {
        for (size_t i = 0; i < (single ? 1u : 3u); ++i) {
            const uint32_t phase = single ? SCAN_PHASE_LOOK_BACK : SCAN_PHASE_REDUCE + static_cast<uint32_t>(i);
            const ScanPhaseConstants constants(phase, tuning, own);
            scan.passes[i] =
                tuning.subgroups
                    ? create_compute_pass(device, k_scan_subgroups_comp, sizeof(ScanConstants), &constants.info, true)
                    : create_compute_pass(device, k_scan_comp, sizeof(ScanConstants), &constants.info);
        }
    } catch (const VulkanError&) {
        destroy_scan(device, scan);
        throw;
    }
    return scan;
}

void destroy_scan(const Device& device, Scan& scan) {
    for (Pass& pass : scan.passes) destroy_pass(device, pass);
}

namespace {

uint32_t block_count(uint32_t count) {
    return count / SCAN_BLOCK_ELEMENTS + (count % SCAN_BLOCK_ELEMENTS != 0 ? 1 : 0);
}

}  // namespace

uint64_t scan_state_words(const ScanTuning& tuning, uint32_t count) {
    const uint64_t blocks = block_count(count);
    return tuning.path == ScanPath::kLookBack ? SCAN_TICKET_WORDS + SCAN_STATE_WORDS * blocks : SCAN_SUM_WORDS * blocks;
}

void scan_barrier(VkCommandBuffer commands) {
    memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                   VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

void clear_scan_state(VkCommandBuffer commands, const Buffer& state, uint64_t offset, uint64_t words) {
    vkCmdFillBuffer(commands, state.handle, offset, 4 * words, 0);
    memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                   VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
}

void record_scan(VkCommandBuffer commands, const Scan& scan, const ScanPlaces& places, uint32_t count) {
    const VkDeviceAddress state = places.state->address + places.state_offset;
    ScanConstants constants{};
    std::memcpy(constants.elements, &places.elements, 8);
    std::memcpy(constants.output_words, &places.output, 8);
    std::memcpy(constants.segments, &places.segments, 8);
    std::memcpy(constants.state, &state, 8);
    constants.count = count;
    constants.segment_count = places.segment_count;
    constants.blocks = block_count(count);
    const auto dispatch = [&](const Pass& pass, uint32_t groups) {
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass.handle);
        vkCmdPushConstants(commands, pass.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
        vkCmdDispatch(commands, groups, 1, 1);
    };
    if (scan.tuning.path == ScanPath::kLookBack) {
        clear_scan_state(commands, *places.state, places.state_offset, scan_state_words(scan.tuning, count));
        dispatch(scan.passes[0], constants.blocks);
        return;
    }
    dispatch(scan.passes[0], constants.blocks);
    scan_barrier(commands);
    dispatch(scan.passes[1], 1);
    scan_barrier(commands);
    dispatch(scan.passes[2], constants.blocks);
}

}  // namespace citystream::client
