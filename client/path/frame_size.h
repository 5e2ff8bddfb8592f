// Sizes of frames as people write them: 1280x720.
#pragma once

#include <cstdint>
#include <string_view>

#include "codec/result.h"

namespace citystream::client {

struct FrameSize {
    uint32_t width = 0, height = 0;
    bool operator==(const FrameSize&) const = default;
};

/// "WIDTHxHEIGHT", each 1 to `greatest_side`. Error: anything else, one line.
Result<FrameSize> parse_frame_size(std::string_view text, uint32_t greatest_side = 16384);

}  // namespace citystream::client
