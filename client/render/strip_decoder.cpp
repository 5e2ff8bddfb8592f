#include "client/render/strip_decoder.h"

#include <cstring>

#include "codec/bits/bit_stream.h"
#include "shaders/strip_scan.comp.h"
#include "shaders/strip_scan_subgroups.comp.h"
#include "shaders/strip_triangles.comp.h"
#include "shaders/strip_triangles_subgroups.comp.h"

namespace citystream::client {
namespace {

using codec::mesh::StripHeader;

using KindWords = std::array<uint64_t, STRIP_KINDS>;

KindWords kind_words(const StripHeader& header) {
    const uint32_t step_bits = header.mode == STRIP_MODE_DEGENERATES ? 1 : 2;
    return {header.code_words, codec::bits::words_for(header.references, 1),
            codec::bits::words_for(header.triangles, step_bits)};
}

// What the shaders rely on; the rest they clamp.
bool counts_are_sound(const StripHeader& header) {
    return header.vertices > 0 && header.references > 0 && header.explicit_references <= header.references &&
           header.mode <= STRIP_MODE_DEGENERATES && header.prediction <= 1;
}

uint32_t low_word(uint64_t value) {
    return static_cast<uint32_t>(value);
}

// Words of all kinds whose blocks one dispatch has, and words that 32 bits number.
constexpr uint64_t kMostWords = uint64_t{SCAN_MOST_BLOCKS - STRIP_KINDS} * SCAN_LANES;
constexpr uint64_t kMostWordNumber = ~uint32_t{0};

StripRecord record_of(const StripStream& stream, const StripSizes& before) {
    const StripHeader& header = stream.header;
    const std::array<size_t, STRIP_KINDS> parts = {header.codes_at, header.increments_at, header.steps_at};
    StripRecord record{};
    std::memcpy(record.layer, &stream.layer, 8);
    for (size_t kind = 0; kind < STRIP_KINDS; ++kind) {
        record.part_at[kind] = low_word(stream.first_word + parts[kind]);
        record.first[kind] = before.words[kind];
    }
    record.triangles = header.triangles;
    record.references = header.references;
    record.explicit_references = header.explicit_references;
    record.vertices = header.vertices;
    record.mode = header.mode | header.prediction << STRIP_PREDICTION_BIT;
    record.explicit_at = before.temporary_words;
    record.ranks_at = before.temporary_words + header.explicit_references;
    record.corners_at = low_word(before.corner_words);
    return record;
}

// The states follow what the shaders write by number, at an even word.
uint64_t state_begin(const StripSizes& sizes) {
    return (uint64_t{sizes.temporary_words} + 1) / 2 * 2;
}

uint64_t first_state_words(const ScanTuning& tuning, const StripSizes& sizes) {
    const uint64_t early = uint64_t{sizes.blocks(STRIP_KIND_CODES)} + sizes.blocks(STRIP_KIND_INCREMENTS);
    return tuning.path == ScanPath::kLookBack ? SCAN_TICKET_WORDS + SCAN_STATE_WORDS * early
                                              : SCAN_SUM_WORDS * (early + sizes.blocks(STRIP_KIND_STEPS));
}

uint64_t steps_state_words(const ScanTuning& tuning, const StripSizes& sizes) {
    if (tuning.path != ScanPath::kLookBack) return 0;
    return SCAN_TICKET_WORDS + SCAN_STATE_WORDS * uint64_t{sizes.blocks(STRIP_KIND_STEPS)};
}

}  // namespace

Status append_stream(StripPlan& plan, const StripStream& stream) {
    const StripHeader& header = stream.header;
    if (header.triangles == 0) {
        plan.corners_at.push_back(plan.sizes.corner_words);
        return Done{};
    }
    if (!counts_are_sound(header)) return Error{"strip counts cannot be"};
    const StripSizes& before = plan.sizes;
    const KindWords own = kind_words(header);
    StripSizes after = before;
    uint64_t words = 0;
    for (size_t kind = 0; kind < STRIP_KINDS; ++kind) {
        words += before.words[kind] + own[kind];
        after.words[kind] = low_word(before.words[kind] + own[kind]);
    }
    const uint64_t temporary = before.temporary_words + header.explicit_references + own[STRIP_KIND_INCREMENTS];
    after.temporary_words = low_word(temporary);
    after.corner_words += uint64_t{3} * header.triangles;
    after.references += header.references;
    if (words > kMostWords || temporary > kMostWordNumber || after.corner_words > kMostWordNumber)
        return Error{"strips are too many for one batch"};
    plan.records.push_back(record_of(stream, before));
    plan.corners_at.push_back(before.corner_words);
    plan.sizes = after;
    return Done{};
}

Result<StripPlan> plan_strips(std::span<const StripStream> streams) {
    StripPlan plan;
    for (const StripStream& stream : streams) {
        const Status status = append_stream(plan, stream);
        if (!status) return status.error();
    }
    return plan;
}

namespace {

Pass create_strip_pass(const Device& device, const ScanTuning& tuning, uint32_t phase, bool triangles) {
    const std::span<const uint32_t> code =
        triangles ? std::span<const uint32_t>(k_strip_triangles_comp) : std::span<const uint32_t>(k_strip_scan_comp);
    const std::span<const uint32_t> with_subgroups = triangles
                                                         ? std::span<const uint32_t>(k_strip_triangles_subgroups_comp)
                                                         : std::span<const uint32_t>(k_strip_scan_subgroups_comp);
    const ScanPhaseConstants constants(phase, tuning);
    return create_compute_pass(device, tuning.subgroups ? with_subgroups : code, sizeof(StripConstants),
                               &constants.info, tuning.subgroups);
}

}  // namespace

StripDecoder create_strip_decoder(const Device& device, const ScanTuning& tuning) {
    struct Step {
        uint32_t phase;
        bool triangles;
    };
    static constexpr std::array<Step, 2> kLookBack = {{{SCAN_PHASE_LOOK_BACK, false}, {SCAN_PHASE_LOOK_BACK, true}}};
    static constexpr std::array<Step, 4> kPasses = {
        {{SCAN_PHASE_REDUCE, false}, {SCAN_PHASE_SUMS, false}, {SCAN_PHASE_APPLY, false}, {SCAN_PHASE_APPLY, true}}};
    const std::span<const Step> steps =
        tuning.path == ScanPath::kLookBack ? std::span<const Step>(kLookBack) : std::span<const Step>(kPasses);
    StripDecoder decoder;
    decoder.tuning = tuning;
    try {
        for (size_t i = 0; i < steps.size(); ++i)
            decoder.passes[i] = create_strip_pass(device, tuning, steps[i].phase, steps[i].triangles);
    } catch (const VulkanError&) {
        destroy_strip_decoder(device, decoder);
        throw;
    }
    return decoder;
}

void destroy_strip_decoder(const Device& device, StripDecoder& decoder) {
    for (Pass& pass : decoder.passes) destroy_pass(device, pass);
}

uint64_t strip_temporary_words(const StripDecoder& decoder, const StripSizes& sizes) {
    return state_begin(sizes) + first_state_words(decoder.tuning, sizes) + steps_state_words(decoder.tuning, sizes);
}

namespace {

StripConstants strip_constants(const StripDecoder& decoder, const StripPlan& plan, const StripPlaces& places) {
    const VkDeviceAddress records = places.records.buffer->address + places.records.offset;
    const VkDeviceAddress temporary = places.temporary.buffer->address + places.temporary.offset;
    const VkDeviceAddress corners = places.corners.buffer->address + places.corners.offset;
    const VkDeviceAddress state = temporary + 4 * state_begin(plan.sizes);
    const VkDeviceAddress steps_state = state + 4 * first_state_words(decoder.tuning, plan.sizes);
    StripConstants constants{};
    std::memcpy(constants.records, &records, 8);
    std::memcpy(constants.temporary, &temporary, 8);
    std::memcpy(constants.corners, &corners, 8);
    std::memcpy(constants.state, &state, 8);
    std::memcpy(constants.steps_state, &steps_state, 8);
    constants.record_count = static_cast<uint32_t>(plan.records.size());
    for (uint32_t kind = 0; kind < STRIP_KINDS; ++kind) {
        constants.words[kind] = plan.sizes.words[kind];
        constants.blocks[kind] = plan.sizes.blocks(kind);
    }
    return constants;
}

}  // namespace

void record_strip_decode(VkCommandBuffer commands, const StripDecoder& decoder, const StripPlan& plan,
                         const StripPlaces& places) {
    if (plan.records.empty()) return;
    const StripSizes& sizes = plan.sizes;
    const StripConstants constants = strip_constants(decoder, plan, places);
    const auto dispatch = [&](const Pass& pass, uint32_t groups) {
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass.handle);
        vkCmdPushConstants(commands, pass.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
        vkCmdDispatch(commands, groups, 1, 1);
    };
    const uint32_t early_blocks = sizes.blocks(STRIP_KIND_CODES) + sizes.blocks(STRIP_KIND_INCREMENTS);
    if (decoder.tuning.path == ScanPath::kLookBack) {
        const uint64_t states = first_state_words(decoder.tuning, sizes) + steps_state_words(decoder.tuning, sizes);
        clear_scan_state(commands, *places.temporary.buffer, places.temporary.offset + 4 * state_begin(sizes), states);
        dispatch(decoder.passes[0], early_blocks);
        scan_barrier(commands);
        dispatch(decoder.passes[1], sizes.blocks(STRIP_KIND_STEPS));
        return;
    }
    dispatch(decoder.passes[0], early_blocks + sizes.blocks(STRIP_KIND_STEPS));
    scan_barrier(commands);
    dispatch(decoder.passes[1], STRIP_KINDS);
    scan_barrier(commands);
    dispatch(decoder.passes[2], early_blocks);
    scan_barrier(commands);
    dispatch(decoder.passes[3], sizes.blocks(STRIP_KIND_STEPS));
}

void strip_barrier(VkCommandBuffer commands) {
    constexpr VkPipelineStageFlags kDecode = VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
    constexpr VkPipelineStageFlags kDraw = VK_PIPELINE_STAGE_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_VERTEX_SHADER_BIT;
    memory_barrier(commands, kDecode | kDraw, VK_ACCESS_SHADER_WRITE_BIT, kDecode | kDraw,
                   VK_ACCESS_INDEX_READ_BIT | VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT |
                       VK_ACCESS_TRANSFER_WRITE_BIT);
}

}  // namespace citystream::client
