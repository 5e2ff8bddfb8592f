#include "client/load/measuring_fetcher.h"

#include <iterator>
#include <utility>

namespace citystream::client {

void MeasuringFetcher::submit(FetchRequest request) {
    observer_.on_submit(request, intended_);
    under_way_.insert_or_assign(request.id, UnderWay{request, intended_});
    inner_.submit(std::move(request));
}

void MeasuringFetcher::take(std::vector<FetchResult> results) {
    const auto now = LoadClock::now();
    for (FetchResult& result : results) {
        if (const auto found = under_way_.find(result.id); found != under_way_.end()) {
            observer_.on_result(found->second.request, found->second.intended, result, now);
            under_way_.erase(found);
        }
        arrived_.push_back(std::move(result));
    }
}

void MeasuringFetcher::collect() {
    if (!under_way_.empty()) take(inner_.poll());
}

std::vector<LoadClock::time_point> MeasuringFetcher::unanswered() const {
    std::vector<LoadClock::time_point> times;
    for (const auto& [id, entry] : under_way_) times.push_back(entry.intended);
    return times;
}

std::vector<FetchResult> MeasuringFetcher::poll() {
    take(inner_.poll());
    return std::exchange(arrived_, {});
}

std::vector<FetchResult> MeasuringFetcher::wait(std::chrono::milliseconds timeout) {
    if (arrived_.empty()) take(inner_.wait(timeout));
    return std::exchange(arrived_, {});
}

}  // namespace citystream::client
