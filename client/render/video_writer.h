// Frames as an MP4 film: H.264, 4:2:0, made with libavcodec and libx264. One thread and fixed settings: the same frames
// give the same bytes.
#pragma once

#include <memory>
#include <string>

#include "client/render/frame.h"
#include "codec/result.h"

namespace citystream::client {

struct VideoOptions {
    uint32_t width = 0, height = 0;  ///< of the frames; an odd last column or row is left out of the film
    uint32_t frames_per_second = 30;
    int quality = 20;  ///< x264's constant rate factor: 0 best, 51 worst
};

class VideoWriter {
  public:
    /// Creates the file. Fails when it cannot be written or no H.264 encoder is there.
    static Result<std::unique_ptr<VideoWriter>> create(const std::string& path, const VideoOptions& options);
    virtual ~VideoWriter() = default;
    virtual Status add(const FrameImage& frame) = 0;
    /// Writes what is still inside the encoder and the index. Without it the file cannot be played. No calls after it.
    virtual Status finish() = 0;
};

}  // namespace citystream::client
