// Files of finished frames, written on a thread of its own. Takes at most kMostWaiting frames ahead: memory stays
// bounded.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "client/path/frame_size.h"
#include "client/render/frame.h"
#include "client/render/video_writer.h"
#include "codec/result.h"

namespace citystream::client {

class FrameOutput {
  public:
    /// `folder`: of frame_00000.png and so on, made where it is missing; `video`: a film of the frames. Each may be
    /// empty. Error: the folder cannot be made, the film not be begun.
    static Result<std::unique_ptr<FrameOutput>> open(const std::string& folder, const std::string& video,
                                                     const FrameSize& size, double frames_per_second);
    ~FrameOutput() { (void)finish(); }
    FrameOutput(const FrameOutput&) = delete;
    FrameOutput& operator=(const FrameOutput&) = delete;

    /// Waits where too many frames wait. Error: of this frame or of one before.
    Status add(FrameImage image);
    /// After the last frame. Error: of any frame, or of the film's end.
    Status finish();

  private:
    static constexpr size_t kMostWaiting = 3;

    FrameOutput(std::string folder, std::unique_ptr<VideoWriter> video)
        : folder_(std::move(folder)), video_(std::move(video)), thread_([this] { work(); }) {}
    void work();
    Status write(const FrameImage& image, uint64_t index);

    std::string folder_;
    std::unique_ptr<VideoWriter> video_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<FrameImage> waiting_;
    std::optional<Error> failed_;
    bool done_ = false;
    std::thread thread_;
};

}  // namespace citystream::client
