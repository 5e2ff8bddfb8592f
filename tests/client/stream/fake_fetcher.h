// A network that does as it is told: answers from entries in memory, in any order, damaged or missing where the test
// says so.
#pragma once

#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "client/stream/fetcher.h"

namespace citystream::client::test {

class FakeFetcher final : public Fetcher {
  public:
    explicit FakeFetcher(const std::map<std::string, std::vector<std::byte>>& entries) : entries_(entries) {}

    void submit(FetchRequest request) override {
        log.push_back(request);
        ++statistics_.requests;
        waiting_.push_back(std::move(request));
    }
    void cancel(uint64_t id) override {
        ++statistics_.cancelled;
        cancelled_.insert(id);
        cancelled_ids.push_back(id);
    }
    std::vector<FetchResult> poll() override { return deliver(per_poll); }
    std::vector<FetchResult> wait(std::chrono::milliseconds) override { return deliver(per_wait); }
    size_t pending() const override { return waiting_.size(); }
    FetcherStatistics statistics() const override { return statistics_; }

    size_t per_poll = ~size_t{0};  ///< results a poll brings at most
    size_t per_wait = 1;
    bool random_order = false;
    std::mt19937 random{1};
    std::vector<FetchRequest> log;  ///< every request ever submitted
    std::vector<uint64_t> cancelled_ids;
    std::map<std::string, int> damage_times;   ///< path -> how many answers to it come with a flipped byte
    std::map<std::string, int> missing_times;  ///< path -> how many answers to it are errors
    uint64_t damage_at = 0;                    ///< byte of the entry that is flipped, when the answer holds it

    /// Bytes asked for since the last call, by path.
    std::map<std::string, uint64_t> take_bytes() {
        std::map<std::string, uint64_t> bytes;
        for (size_t i = taken_; i < log.size(); ++i) bytes[log[i].path] += log[i].length;
        taken_ = log.size();
        return bytes;
    }

  private:
    std::vector<FetchResult> deliver(size_t most) {
        std::vector<FetchResult> results;
        while (!waiting_.empty() && results.size() < most) {
            const size_t index = random_order ? random() % waiting_.size() : 0;
            results.push_back(answer(waiting_[index]));
            waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(index));
        }
        return results;
    }
    FetchResult answer(const FetchRequest& request) {
        if (cancelled_.contains(request.id)) return {request.id, Error{"cancelled"}, true, 0, 0};
        const auto entry = entries_.find(request.path);
        int& missing = missing_times[request.path];
        if (entry == entries_.end() || missing > 0) {
            --missing;
            ++statistics_.failures;
            return {request.id, Error{request.path + ": no such entry"}, false, 1, 0};
        }
        if (request.length == 0 && entry->second.size() > request.limit)
            return {request.id, Error{request.path + ": more bytes than allowed"}, false, 1, 0};
        const uint64_t begin = request.length == 0 ? 0 : request.offset;
        const uint64_t length = request.length == 0 ? entry->second.size() : request.length;
        if (begin + length > entry->second.size())
            return {request.id, Error{request.path + ": out of range"}, false, 1, 0};
        std::vector<std::byte> bytes(entry->second.begin() + static_cast<std::ptrdiff_t>(begin),
                                     entry->second.begin() + static_cast<std::ptrdiff_t>(begin + length));
        int& damage = damage_times[request.path];
        if (damage > 0 && damage_at >= begin && damage_at < begin + length) {
            --damage;
            bytes[damage_at - begin] ^= std::byte{0x10};
        }
        statistics_.body_bytes += bytes.size();
        return {request.id, std::move(bytes), false, 1, 0};
    }

    const std::map<std::string, std::vector<std::byte>>& entries_;
    std::vector<FetchRequest> waiting_;
    std::set<uint64_t> cancelled_;
    FetcherStatistics statistics_;
    size_t taken_ = 0;
};

}  // namespace citystream::client::test
