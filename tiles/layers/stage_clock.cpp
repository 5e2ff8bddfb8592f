#include "tiles/layers/stage_clock.h"

#include <ctime>

namespace citystream::tiles::layers {
namespace {

double seconds_of(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

StageClock::StageClock() : wall_(seconds_of(CLOCK_MONOTONIC)), processor_(seconds_of(CLOCK_PROCESS_CPUTIME_ID)) {}

void StageClock::lap(std::string_view stage) {
    const double wall = seconds_of(CLOCK_MONOTONIC), processor = seconds_of(CLOCK_PROCESS_CPUTIME_ID);
    times_.push_back({std::string(stage), wall - wall_, processor - processor_});
    wall_ = wall;
    processor_ = processor;
}

}  // namespace citystream::tiles::layers
