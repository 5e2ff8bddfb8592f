// A fetcher that stands between a streamer and the real fetcher and tells an observer what was asked for when, and when
// it came.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "client/stream/fetcher.h"

namespace citystream::client {

using LoadClock = std::chrono::steady_clock;

/// Told of every request. Calls come from the thread that calls the fetcher.
class FetchObserver {
  public:
    virtual ~FetchObserver() = default;
    virtual void on_submit(const FetchRequest& request, LoadClock::time_point intended) = 0;
    /// `seen`: when the answer was noticed; see MeasuringFetcher::collect for how exact that is.
    virtual void on_result(const FetchRequest& request, LoadClock::time_point intended, const FetchResult& result,
                           LoadClock::time_point seen) = 0;
};

/// Thread contract as Fetcher's. Both references outlive it.
class MeasuringFetcher final : public Fetcher {
  public:
    MeasuringFetcher(Fetcher& inner, FetchObserver& observer) : inner_(inner), observer_(observer) {}

    /// Requests from now on belong to something that was due at this time: latency counts from here, however late the
    /// caller is.
    void set_intended(LoadClock::time_point time) { intended_ = time; }
    /// Takes and times what has arrived, and keeps it for poll() and wait(). Called often between updates, it makes
    /// times as exact as its interval.
    void collect();
    bool idle() const { return under_way_.empty(); }
    /// Requests without an answer yet, each with the time from which its latency counts.
    std::vector<LoadClock::time_point> unanswered() const;

    void submit(FetchRequest request) override;
    void cancel(uint64_t id) override { inner_.cancel(id); }
    std::vector<FetchResult> poll() override;
    std::vector<FetchResult> wait(std::chrono::milliseconds timeout) override;
    size_t pending() const override { return inner_.pending() + arrived_.size(); }
    FetcherStatistics statistics() const override { return inner_.statistics(); }

  private:
    struct UnderWay {
        FetchRequest request;
        LoadClock::time_point intended;
    };
    void take(std::vector<FetchResult> results);

    Fetcher& inner_;
    FetchObserver& observer_;
    LoadClock::time_point intended_{};
    std::map<uint64_t, UnderWay> under_way_;
    std::vector<FetchResult> arrived_;
};

}  // namespace citystream::client
