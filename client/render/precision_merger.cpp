#include "client/render/precision_merger.h"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "shaders/precision_merge.comp.h"

namespace citystream::client {
namespace {

PrecisionMergeJob job_of(const PrecisionChange& change, uint32_t first_word) {
    PrecisionMergeJob job{};
    std::memcpy(job.source, &change.source, sizeof job.source);
    std::memcpy(job.target, &change.target, sizeof job.target);
    std::memcpy(job.planes, &change.planes, sizeof job.planes);
    job.first_word = first_word;
    job.to_level = change.to_level;
    job.words_before = change.words_before;
    uint64_t begin = 0;
    for (uint32_t plane = change.from_level; plane < change.to_level; ++plane) {
        job.plane_begin[plane] = static_cast<uint32_t>(begin);
        job.plane_vertices[plane] = change.shape->plane_vertices(plane);
        begin += change.shape->plane_words(plane);
    }
    return job;
}

}  // namespace

PrecisionMerger::PrecisionMerger(const Device& device)
    : device_(device), pass_(create_compute_pass(device, k_precision_merge_comp, sizeof(PrecisionMergeConstants))) {}

PrecisionMerger::~PrecisionMerger() {
    destroy_pass(device_, pass_);
}

void PrecisionMerger::record(VkCommandBuffer commands, std::span<const PrecisionChange> changes,
                             const Buffer& table) const {
    if (changes.empty()) return;
    assert(table.mapped != nullptr && table.bytes >= table_bytes(changes.size()));
    auto* jobs = static_cast<PrecisionMergeJob*>(table.mapped);
    PrecisionMergeConstants constants{};
    for (const PrecisionChange& change : changes) {
        jobs[constants.job_count++] = job_of(change, constants.words);
        constants.words += change.words_before + static_cast<uint32_t>(change.shape->words_at(change.to_level));
    }
    std::memcpy(constants.jobs, &table.address, sizeof constants.jobs);
    const uint32_t groups = (constants.words + PRECISION_MERGE_GROUP - 1) / PRECISION_MERGE_GROUP;
    const uint32_t rows = (groups + PRECISION_MERGE_ROW_GROUPS - 1) / PRECISION_MERGE_ROW_GROUPS;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass_.handle);
    vkCmdPushConstants(commands, pass_.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
    vkCmdDispatch(commands, std::min<uint32_t>(groups, PRECISION_MERGE_ROW_GROUPS), rows, 1);
}

}  // namespace citystream::client
