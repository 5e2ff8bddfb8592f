// A camera path frame by frame, whoever draws it: files of the frames, statistics, progress on a terminal, and an end
// when a signal comes.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <string>

#include "client/fly/fly_options.h"
#include "client/path/camera_path.h"
#include "client/render/frame.h"
#include "client/select/camera.h"
#include "client/stream/flight_statistics.h"
#include "codec/result.h"

namespace citystream::client {

/// A frame, and what is worth saying of it.
struct FlownFrame {
    FrameImage image;
    std::string remark;
};
/// Draws what a camera sees and fills what it took. Nothing when the flight was stopped meanwhile.
using DrawFrame = std::function<Result<std::optional<FlownFrame>>(const Camera& camera, FlightFrame& frame)>;

/// Draws the path and puts the frames out. `stop`: set by a signal handler, ends after the frame under way. Error: what
/// could not be drawn, with its frame, or written.
Status fly_path(const FlyOptions& options, const CameraPath& path, bool realtime, const std::atomic<bool>& stop,
                const DrawFrame& draw, FlightStatistics& statistics);

/// Of the statistics' head.
FlightDescription describe_flight(const FlyOptions& options, const std::string& device);

/// What is left to do when a path was flown: statistics to a file and to stdout. Error: the file cannot be written, or
/// the validation layer had something to say.
Status conclude_flight(const FlyOptions& options, const FlightStatistics& statistics, const FlightTotals& totals);

/// A line for people, on stderr.
void say(const std::string& line);

}  // namespace citystream::client
