// How long each stage of a build took: on the clock, and of all processors.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace citystream::tiles::layers {

struct StageTime {
    std::string stage;
    double seconds = 0, processor_seconds = 0;  ///< processor: of the whole process, all threads
};

class StageClock {
  public:
    StageClock();
    /// The time since the last lap, or since construction, was spent on `stage`.
    void lap(std::string_view stage);
    const std::vector<StageTime>& times() const { return times_; }

  private:
    double wall_, processor_;  // at the last lap
    std::vector<StageTime> times_;
};

}  // namespace citystream::tiles::layers
