#include "client/stream/local_fetcher.h"

#include <algorithm>
#include <thread>

#include "client/stream/network_shape.h"
#include "client/stream/request_queue.h"

namespace citystream::client {
namespace {

using Clock = ShapedLink::Clock;

class LocalFetcher final : public Fetcher {
  public:
    LocalFetcher(ByteSource source, const FetcherOptions& options)
        : source_(std::move(source)), connections_(std::max(1u, options.connections)), link_(options.shape) {
        worker_ = std::thread([this] { work(); });
    }
    ~LocalFetcher() override {
        queue_.close();
        worker_.join();
    }
    LocalFetcher(const LocalFetcher&) = delete;
    LocalFetcher& operator=(const LocalFetcher&) = delete;

    void submit(FetchRequest request) override { queue_.submit(std::move(request)); }
    void cancel(uint64_t id) override { queue_.cancel(id); }
    std::vector<FetchResult> poll() override { return queue_.poll(); }
    std::vector<FetchResult> wait(std::chrono::milliseconds timeout) override { return queue_.wait(timeout); }
    size_t pending() const override { return queue_.pending(); }
    FetcherStatistics statistics() const override { return queue_.statistics(); }

  private:
    struct Travelling {
        Clock::time_point arrives;
        uint64_t serial = 0;
        FetchResult result;
        bool operator<(const Travelling& other) const {
            return arrives != other.arrives ? arrives > other.arrives : serial > other.serial;
        }
    };

    void work() {
        while (!queue_.closed()) {
            const bool may_take = travelling_.size() < connections_;
            const Clock::time_point next = travelling_.empty() ? Clock::time_point::max() : travelling_.front().arrives;
            if (may_take) {
                if (auto request = queue_.take_wait(next)) send(*request);
            } else {
                std::this_thread::sleep_until(std::min(next, Clock::now() + std::chrono::milliseconds(50)));
            }
            deliver_arrived();
        }
    }

    void send(const FetchRequest& request) {
        const Clock::time_point sent = Clock::now();
        FetchResult result{request.id, source_(request), false, 1, 0};
        const uint64_t size = result.bytes ? result.bytes->size() : 0;
        queue_.count_bytes(0, size);
        const Clock::time_point answered = sent + 2 * link_.half_round_trip();
        const Clock::time_point arrives = link_.shaped() ? link_.reserve(size, answered) : sent;
        result.seconds = std::chrono::duration<double>(std::max(arrives, Clock::now()) - sent).count();
        travelling_.push_back({arrives, serial_++, std::move(result)});
        std::push_heap(travelling_.begin(), travelling_.end());
    }

    void deliver_arrived() {
        while (!travelling_.empty() && travelling_.front().arrives <= Clock::now()) {
            std::pop_heap(travelling_.begin(), travelling_.end());
            queue_.deliver(std::move(travelling_.back().result));
            travelling_.pop_back();
        }
    }

    ByteSource source_;
    size_t connections_;
    ShapedLink link_;
    RequestQueue queue_;
    std::vector<Travelling> travelling_;  ///< heap, earliest first
    uint64_t serial_ = 0;
    std::thread worker_;
};

}  // namespace

Result<ByteRange> range_within(const FetchRequest& request, uint64_t entry_size) {
    if (request.length == 0) {
        if (entry_size > request.limit) {
            return Error{request.path + ": " + std::to_string(entry_size) + " bytes, more than the " +
                         std::to_string(request.limit) + " allowed"};
        }
        return ByteRange{0, entry_size};
    }
    if (request.offset > entry_size || request.length > entry_size - request.offset) {
        return Error{request.path + ": ends before the range that the directory names", entry_size};
    }
    return ByteRange{request.offset, request.length};
}

bool is_safe_path(const std::string& path) {
    size_t begin = 0;
    while (true) {
        const size_t end = std::min(path.find('/', begin), path.size());
        const std::string part = path.substr(begin, end - begin);
        if (part.empty() || part == "." || part == "..") return false;
        if (part.find('\\') != std::string::npos || part.find('\0') != std::string::npos) return false;
        if (end == path.size()) return true;
        begin = end + 1;
    }
}

std::unique_ptr<Fetcher> make_local_fetcher(ByteSource source, const FetcherOptions& options) {
    return std::make_unique<LocalFetcher>(std::move(source), options);
}

}  // namespace citystream::client
