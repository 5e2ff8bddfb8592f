#include "client/fly/frame_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "client/render/frame_file.h"

namespace citystream::client {

Result<std::unique_ptr<FrameOutput>> FrameOutput::open(const std::string& folder, const std::string& video,
                                                       const FrameSize& size, double frames_per_second) {
    if (!folder.empty()) {
        std::error_code failure;
        std::filesystem::create_directories(folder, failure);
        if (failure) return Error{folder + ": cannot make the folder: " + failure.message()};
    }
    std::unique_ptr<VideoWriter> writer;
    if (!video.empty()) {
        const auto rate = static_cast<uint32_t>(std::max(1.0, std::round(frames_per_second)));
        auto created = VideoWriter::create(video, {size.width, size.height, rate, VideoOptions{}.quality});
        if (!created) return created.error();
        writer = std::move(*created);
    }
    return std::unique_ptr<FrameOutput>(new FrameOutput(folder, std::move(writer)));
}

Status FrameOutput::add(FrameImage image) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_.size() < kMostWaiting || failed_; });
    if (failed_) return *failed_;
    waiting_.push_back(std::move(image));
    changed_.notify_all();
    return Done{};
}

Status FrameOutput::finish() {
    if (thread_.joinable()) {
        {
            const std::lock_guard lock(mutex_);
            done_ = true;
        }
        changed_.notify_all();
        thread_.join();
        if (video_ && !failed_) {
            const Status finished = video_->finish();
            if (!finished) failed_ = finished.error();
        }
    }
    if (failed_) return *failed_;
    return Done{};
}

void FrameOutput::work() {
    for (uint64_t index = 0;; ++index) {
        FrameImage image;
        {
            std::unique_lock lock(mutex_);
            changed_.wait(lock, [&] { return !waiting_.empty() || done_; });
            if (waiting_.empty()) return;
            image = std::move(waiting_.front());
            waiting_.pop_front();
        }
        changed_.notify_all();
        const Status written = write(image, index);
        if (written) continue;
        const std::lock_guard lock(mutex_);
        failed_ = written.error();
        changed_.notify_all();
        return;
    }
}

Status FrameOutput::write(const FrameImage& image, uint64_t index) {
    if (!folder_.empty()) {
        Status png = write_png(fmt::format("{}/frame_{:05}.png", folder_, index), image);
        if (!png) return png;
    }
    return video_ ? video_->add(image) : Status(Done{});
}

}  // namespace citystream::client
