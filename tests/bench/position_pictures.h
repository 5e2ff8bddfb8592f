// What leaving out bits of positions does to the client's own frames.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/render/frame.h"
#include "codec/result.h"
#include "tests/bench/camera_tours.h"

namespace citystream::bench {

struct PositionFlight {
    std::vector<client::FrameImage> frames;
    uint64_t wire_bytes = 0;  ///< of the whole flight
};

/// Flies an archive from an empty cache, 1280 x 720 pixels of four samples. `position_tolerance` 0: all bits.
Result<PositionFlight> fly_with_positions(const std::string& archive, const Tour& tour, double tolerance,
                                          double position_tolerance);

struct PictureDifference {
    double least_db = 99, median_db = 99;  ///< PSNR; 99 for equal frames
};
/// Preconditions: as many frames in both, of one size.
PictureDifference difference_of(const PositionFlight& flight, const PositionFlight& reference);

}  // namespace citystream::bench
