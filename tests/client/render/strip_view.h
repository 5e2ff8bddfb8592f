// Draws decoded corners into a frame, for the test of drawing in rounds and the bench of the strip decoder.
#pragma once

#include "client/render/frame_target.h"
#include "client/render/strip_decoder.h"
#include "tests/shaders/strip_view_layout.h"

namespace citystream::client {

/// One mesh of a draw.
struct StripDraw {
    uint64_t first_corner = 0;  ///< words from where the corners begin
    uint32_t corners = 0;
    uint32_t first_vertex = 0;
};

struct StripView {
    FrameTarget target;
    Pass pass;
};

StripView create_strip_view(const Device& device, uint32_t width, uint32_t height);
void destroy_strip_view(const Device& device, StripView& view);

/// One render pass; `first`: of the frame, which it clears.
void record_strip_view(VkCommandBuffer commands, const StripView& view, const StripViewConstants& constants,
                       const BufferRange& corners, std::span<const StripDraw> draws, bool first);
/// Behind the frame's last pass: its pixels go to target.readback.
void finish_strip_view(VkCommandBuffer commands, const StripView& view);

}  // namespace citystream::client
