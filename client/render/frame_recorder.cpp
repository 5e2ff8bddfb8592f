#include "client/render/frame_recorder.h"

#include <algorithm>
#include <cstddef>

#include "client/render/lighting_layout.h"

namespace citystream::client {
namespace {

constexpr VkShaderStageFlags kDrawStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

// Vertices of a draw on a software driver: llvmpipe shades 4,096 at a time and, when one of them is clipped, hands all
// to a slow path whose time grows with their square. Measured on a street flight: 1,536 take half the time of one draw
// a tile, 384 and 4,096 more.
constexpr uint32_t kSoftwarePiece = 1536;
static_assert(kSoftwarePiece % 3 == 0);
/// Indices of a draw of prisms.
constexpr uint32_t kPrismPiece = 12288;

void split(VkDeviceAddress address, uint32_t out[2]) {
    out[0] = static_cast<uint32_t>(address);
    out[1] = static_cast<uint32_t>(address >> 32);
}

}  // namespace

// Binds the pass unless it is `bound`.
void FrameRecorder::bind_for(VkCommandBuffer commands, const Pass& pass, const TileConstants& tile,
                             VkPipeline& bound) const {
    if (bound != pass.handle) vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pass.handle);
    bound = pass.handle;
    const DrawConstants constants{frame_.constants, tile};
    vkCmdPushConstants(commands, pass.layout, kDrawStages, 0, sizeof constants, &constants);
}

void FrameRecorder::record_triangles(VkCommandBuffer commands, uint32_t first, uint32_t count) const {
    const uint32_t piece = sources_.device->is_cpu ? kSoftwarePiece : 3 * count;
    for (uint32_t begin = 0; begin < 3 * count; begin += piece) {
        vkCmdDraw(commands, std::min(piece, 3 * count - begin), 1, 3 * first + begin, 0);
        ++mesh_draws_;
    }
}

// One draw for each run of a range, its chart in the push constants. Returns the first run of a later range.
const ChartRun* FrameRecorder::record_runs(VkCommandBuffer commands, const Pass& pass, uint32_t range,
                                           const ChartRun* run, const ChartRun* end) const {
    constexpr uint32_t kChart = offsetof(DrawConstants, tile) + offsetof(TileConstants, shared_charts);
    for (; run != end && run->range == range; ++run) {
        vkCmdPushConstants(commands, pass.layout, kDrawStages, kChart, sizeof run->words, run->words.data());
        record_triangles(commands, run->first, run->triangles);
    }
    return run;
}

// The ranges that the round draws: all but strip code in the first, strip code when its corners are there.
void FrameRecorder::record_tile(VkCommandBuffer commands, const DrawnTile& drawn, uint32_t round,
                                VkPipeline& bound) const {
    const auto& ranges = drawn.tile->mesh_ranges;
    const bool dressed = !has_facades(*drawn.tile);
    size_t strip = drawn.first_strip;
    const ChartRun* run = drawn.runs != nullptr ? drawn.runs->data() : nullptr;
    const ChartRun* runs_end = drawn.runs != nullptr ? run + drawn.runs->size() : nullptr;
    TileConstants constants = drawn.constants;
    for (uint32_t range = 0; range < ranges.size(); ++range) {
        if (ranges[range].dressed && !dressed) continue;
        const bool is_strips = ranges[range].kind == RESIDENT_KIND_STRIP_CODE;
        const StripPlace place = is_strips ? sources_.strips->place(strip++) : StripPlace();
        if (place.round != round) continue;
        while (run != runs_end && run->range < range) ++run;
        const MeshDrawConstants draw = sources_.mesh_draws->of(drawn.tile->mesh, range);
        const Pass& pass = sources_.passes->mesh(frame_.kind, drawn.mesh_of(draw));
        split(sources_.draw_records->add(draw, place.corners, drawn.radiance), constants.mesh_draw);
        bind_for(commands, pass, constants, bound);
        if (drawn.runs != nullptr) {
            run = record_runs(commands, pass, range, run, runs_end);
        } else if ((draw.form & 255) == RESIDENT_KIND_PRISMS) {
            mesh_draws_ += sources_.prism_indices->record(commands, draw, ranges[range].triangles,
                                                          sources_.device->is_cpu ? kSoftwarePiece : kPrismPiece);
        } else {
            record_triangles(commands, 0, ranges[range].triangles);
        }
    }
}

void FrameRecorder::record_meshes(VkCommandBuffer commands, uint32_t round) const {
    VkPipeline bound = VK_NULL_HANDLE;
    for (const DrawnTile& drawn : frame_.tiles) {
        if (drawn.tile->mesh != kNoLayer) record_tile(commands, drawn, round, bound);
    }
}

// Behind the backs of opaque facades nothing is cast.
void FrameRecorder::record_occluders(VkCommandBuffer commands) const {
    VkPipeline bound = VK_NULL_HANDLE;
    vkCmdBindIndexBuffer(commands, sources_.passes->facade_indices(), 0, VK_INDEX_TYPE_UINT16);
    for (const DrawnTile& drawn : frame_.tiles) {
        if (drawn.casters == 0) continue;
        bind_for(commands, sources_.passes->occluder(drawn.occluder()), drawn.constants, bound);
        vkCmdDrawIndexed(commands, kOccluderIndices, drawn.placements(), 0, 0, 0);
    }
}

void FrameRecorder::record_facades(VkCommandBuffer commands) const {
    const FrameTarget& target = *sources_.target;
    const FramePasses& passes = *sources_.passes;
    if (passes.is_keyed()) {
        vkCmdFillBuffer(commands, passes.keys().handle, 0, VK_WHOLE_SIZE, 0);
        memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_SHADER_WRITE_BIT);
    }
    barrier_between_passes(commands);
    begin_pass(commands, target, target.load_pass, sources_.clear.data());
    vkCmdBindIndexBuffer(commands, passes.facade_indices(), 0, VK_INDEX_TYPE_UINT16);
    for (uint32_t caster = 0; caster < FACADE_RENDERER_COUNT; ++caster) {
        VkPipeline bound = VK_NULL_HANDLE;
        for (const DrawnTile& drawn : frame_.tiles) {
            if ((drawn.casters >> caster & 1) == 0) continue;
            bind_for(commands, passes.facade(caster, drawn.facade()), drawn.constants, bound);
            vkCmdDrawIndexed(commands, kFacadeIndices, drawn.placements(), 0, 0, 0);
        }
    }
    vkCmdEndRenderPass(commands);
    if (passes.is_keyed()) record_resolve(commands);
}

void FrameRecorder::record_resolve(VkCommandBuffer commands) const {
    const FrameTarget& target = *sources_.target;
    const Pass& resolve = sources_.passes->resolve();
    memory_barrier(commands, VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                   VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
    barrier_between_passes(commands);
    begin_pass(commands, target, target.load_pass, sources_.clear.data());
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, resolve.handle);
    vkCmdPushConstants(commands, resolve.layout, kDrawStages, 0, sizeof frame_.facades, &frame_.facades);
    vkCmdDraw(commands, 3, 1, 0, 0);
    vkCmdEndRenderPass(commands);
}

void FrameRecorder::record_readback(VkCommandBuffer commands) const {
    const FrameTarget& target = *sources_.target;
    copy_colour(commands, target, target.scale > 1 ? target.samples : target.readback);
    if (target.scale > 1) {
        memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                       VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_READ_BIT);
        FilterConstants constants{{}, {}, target.width, target.height, target.scale, 0};
        split(target.samples.address, constants.source);
        split(target.readback.address, constants.target);
        const Pass& filter = *sources_.filter;
        vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, filter.handle);
        vkCmdPushConstants(commands, filter.layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof constants, &constants);
        vkCmdDispatch(commands, (target.width + 7) / 8, (target.height + 7) / 8, 1);
    }
    memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT | VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT,
                   VK_ACCESS_TRANSFER_WRITE_BIT | VK_ACCESS_SHADER_WRITE_BIT, VK_PIPELINE_STAGE_HOST_BIT,
                   VK_ACCESS_HOST_READ_BIT);
}

}  // namespace citystream::client
