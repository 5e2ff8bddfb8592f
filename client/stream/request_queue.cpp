#include "client/stream/request_queue.h"

#include <cmath>
#include <utility>

namespace citystream::client {

void RequestQueue::submit(FetchRequest request) {
    {
        const std::lock_guard lock(mutex_);
        const Order order{std::isnan(request.priority) ? 0 : request.priority, next_serial_++};
        ++statistics_.requests;
        order_of_.emplace(request.id, order);
        waiting_.emplace(order, std::move(request));
    }
    requests_arrived_.notify_one();
}

void RequestQueue::cancel(uint64_t id) {
    const std::lock_guard lock(mutex_);
    if (const auto waiting = order_of_.find(id); waiting != order_of_.end()) {
        waiting_.erase(waiting->second);
        order_of_.erase(waiting);
        push_result({id, Error{"cancelled"}, true, 0, 0});
    } else if (const auto under_way = under_way_.find(id); under_way != under_way_.end()) {
        under_way->second = true;
    }
}

void RequestQueue::push_result(FetchResult result) {
    if (result.cancelled) {
        ++statistics_.cancelled;
    } else if (!result.bytes) {
        ++statistics_.failures;
    }
    results_.push_back(std::move(result));
    results_arrived_.notify_one();
}

std::vector<FetchResult> RequestQueue::poll() {
    const std::lock_guard lock(mutex_);
    return std::exchange(results_, {});
}

std::vector<FetchResult> RequestQueue::wait(std::chrono::milliseconds timeout) {
    std::unique_lock lock(mutex_);
    results_arrived_.wait_for(lock, timeout, [&] { return !results_.empty() || closed_; });
    return std::exchange(results_, {});
}

size_t RequestQueue::pending() const {
    const std::lock_guard lock(mutex_);
    return waiting_.size() + under_way_.size() + results_.size();
}

FetcherStatistics RequestQueue::statistics() const {
    const std::lock_guard lock(mutex_);
    return statistics_;
}

std::optional<FetchRequest> RequestQueue::take_locked() {
    if (waiting_.empty() || closed_) return std::nullopt;
    FetchRequest request = std::move(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
    order_of_.erase(request.id);
    under_way_.emplace(request.id, false);
    return request;
}

std::optional<FetchRequest> RequestQueue::take() {
    const std::lock_guard lock(mutex_);
    return take_locked();
}

std::optional<FetchRequest> RequestQueue::take_wait(std::chrono::steady_clock::time_point until) {
    std::unique_lock lock(mutex_);
    const auto ready = [&] { return !waiting_.empty() || closed_; };
    if (until == std::chrono::steady_clock::time_point::max()) {
        requests_arrived_.wait(lock, ready);
    } else {
        requests_arrived_.wait_until(lock, until, ready);
    }
    return take_locked();
}

bool RequestQueue::is_cancelled(uint64_t id) const {
    const std::lock_guard lock(mutex_);
    const auto found = under_way_.find(id);
    return found != under_way_.end() && found->second;
}

void RequestQueue::deliver(FetchResult result) {
    const std::lock_guard lock(mutex_);
    const auto found = under_way_.find(result.id);
    if (found == under_way_.end()) return;
    if (found->second) {
        result.bytes = Error{"cancelled"};
        result.cancelled = true;
    }
    under_way_.erase(found);
    push_result(std::move(result));
}

void RequestQueue::count_retry() {
    const std::lock_guard lock(mutex_);
    ++statistics_.retries;
}

void RequestQueue::count_bytes(uint64_t header, uint64_t body) {
    const std::lock_guard lock(mutex_);
    statistics_.header_bytes += header;
    statistics_.body_bytes += body;
}

void RequestQueue::close() {
    {
        const std::lock_guard lock(mutex_);
        closed_ = true;
    }
    results_arrived_.notify_all();
    requests_arrived_.notify_all();
}

bool RequestQueue::closed() const {
    const std::lock_guard lock(mutex_);
    return closed_;
}

}  // namespace citystream::client
