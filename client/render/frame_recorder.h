// Records what a frame draws (drawn_frame.h) as commands: triangles, facades, the readback. The frame's pipelines are
// there (frame_passes.h), its strips planned (strip_ranges.h), its records begun (draw_records.h).
#pragma once

#include <array>

#include "client/render/draw_records.h"
#include "client/render/drawn_frame.h"
#include "client/render/frame_passes.h"
#include "client/render/mesh_draws.h"
#include "client/render/prism_indices.h"
#include "client/render/strip_ranges.h"

namespace citystream::client {

class FrameRecorder {
  public:
    /// What is recorded from; all of it outlives the recorder. `filter`: where the target has more than one sample a
    /// pixel.
    struct Sources {
        const Device* device = nullptr;
        const FrameTarget* target = nullptr;
        const FramePasses* passes = nullptr;
        const MeshDraws* mesh_draws = nullptr;
        const StripRanges* strips = nullptr;
        PrismIndices* prism_indices = nullptr;
        DrawRecords* draw_records = nullptr;
        const Pass* filter = nullptr;
        std::array<float, 4> clear{};
    };
    /// The frame outlives it. `mesh_draws`: draws of triangles are added to it.
    FrameRecorder(const Sources& sources, const DrawnFrame& frame, uint32_t& mesh_draws)
        : sources_(sources), frame_(frame), mesh_draws_(mesh_draws) {}

    /// In a render pass: the ranges of all tiles that the round of strip code draws.
    void record_meshes(VkCommandBuffer commands, uint32_t round) const;
    /// In the same render pass, after the last round: the backs of opaque facades.
    void record_occluders(VkCommandBuffer commands) const;
    /// Outside of render passes, after that.
    void record_facades(VkCommandBuffer commands) const;
    /// Outside of render passes: the picture, filtered, for the host to read.
    void record_readback(VkCommandBuffer commands) const;

  private:
    void record_tile(VkCommandBuffer commands, const DrawnTile& drawn, uint32_t round, VkPipeline& bound) const;
    const ChartRun* record_runs(VkCommandBuffer commands, const Pass& pass, uint32_t range, const ChartRun* run,
                                const ChartRun* end) const;
    void record_triangles(VkCommandBuffer commands, uint32_t first, uint32_t count) const;
    void record_resolve(VkCommandBuffer commands) const;
    void bind_for(VkCommandBuffer commands, const Pass& pass, const TileConstants& tile, VkPipeline& bound) const;

    const Sources& sources_;
    const DrawnFrame& frame_;
    uint32_t& mesh_draws_;
};

}  // namespace citystream::client
