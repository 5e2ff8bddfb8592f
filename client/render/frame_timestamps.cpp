#include "client/render/frame_timestamps.h"

#include <array>

namespace citystream::client {

FrameTimestamps::FrameTimestamps(const Device& device) : device_(device) {
    auto queries = vk_struct<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = kTimestampCount;
    vk_check(vkCreateQueryPool(device.handle, &queries, nullptr, &queries_), "vkCreateQueryPool");
}

void FrameTimestamps::reset(VkCommandBuffer commands) const {
    if (device_.timestamp_nanoseconds != 0) vkCmdResetQueryPool(commands, queries_, 0, kTimestampCount);
}

void FrameTimestamps::mark(VkCommandBuffer commands, Timestamp stamp) const {
    if (device_.timestamp_nanoseconds == 0) return;
    const VkPipelineStageFlagBits stage =
        stamp == kBegin ? VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT : VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT;
    vkCmdWriteTimestamp(commands, stage, queries_, stamp);
}

void FrameTimestamps::read(bool lit, FrameTimings& timings) const {
    if (device_.timestamp_nanoseconds == 0) return;
    std::array<uint64_t, kTimestampCount> ticks{};
    const uint32_t count = lit ? kTimestampCount : kPlainTimestamps;
    vk_check(vkGetQueryPoolResults(device_.handle, queries_, 0, count, sizeof ticks, ticks.data(), sizeof ticks[0],
                                   VK_QUERY_RESULT_64_BIT),
             "vkGetQueryPoolResults");
    const auto between = [&](Timestamp from, Timestamp to) {
        return static_cast<double>(ticks[to] - ticks[from]) * device_.timestamp_nanoseconds * 1e-6;
    };
    timings.gpu_mesh_ms = between(kBegin, kMeshDone);
    timings.gpu_facade_ms = between(kMeshDone, kFacadesDone);
    timings.gpu_total_ms = between(kBegin, kEnd);
    timings.gpu_light_ms = between(kLightBegin, kLightDone);
}

}  // namespace citystream::client
