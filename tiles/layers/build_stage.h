// One stage of a build: the same work on many things, on all the threads the build may use, with progress and an early
// end where something fails or the user interrupts.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "tiles/layers/build_city.h"

namespace citystream::tiles::layers {

class BuildStage {
  public:
    /// `total`: things in all, over all calls of run.
    BuildStage(const BuildOptions& options, std::string_view name, uint64_t total)
        : options_(options), name_(name), total_(total) {}

    /// Calls work(i) for every i below `count`, in any order, and waits for all of them. Of several errors the one that
    /// came first; "interrupted" where options.cancel was set.
    Status run(size_t count, const std::function<Status(size_t)>& work);

  private:
    bool stopped();
    void finish_one(const Status& status);

    const BuildOptions& options_;
    std::string name_;
    uint64_t total_, done_ = 0;
    std::mutex mutex_;
    std::optional<Error> error_;
};

}  // namespace citystream::tiles::layers
