#include "client/load/measuring_fetcher.h"

#include <gtest/gtest.h>

#include <deque>
#include <thread>

namespace citystream::client {
namespace {

using namespace std::chrono_literals;

/// Answers when told to.
class ScriptedFetcher final : public Fetcher {
  public:
    void submit(FetchRequest request) override { waiting.push_back(std::move(request)); }
    void cancel(uint64_t id) override { ready.push_back({id, Error{"cancelled"}, true, 0, 0}); }
    std::vector<FetchResult> poll() override { return std::exchange(ready, {}); }
    std::vector<FetchResult> wait(std::chrono::milliseconds) override { return poll(); }
    size_t pending() const override { return waiting.size() + ready.size(); }
    FetcherStatistics statistics() const override { return {}; }
    void answer_first() {
        ready.push_back({waiting.front().id, std::vector<std::byte>(waiting.front().length), false, 1, 0.001});
        waiting.pop_front();
    }
    std::deque<FetchRequest> waiting;
    std::vector<FetchResult> ready;
};

struct Recorder final : FetchObserver {
    struct Seen {
        std::string path;
        LoadClock::duration latency;
        bool cancelled;
    };
    void on_submit(const FetchRequest& request, LoadClock::time_point) override { submitted.push_back(request.path); }
    void on_result(const FetchRequest& request, LoadClock::time_point intended, const FetchResult& result,
                   LoadClock::time_point seen) override {
        results.push_back({request.path, seen - intended, result.cancelled});
    }
    std::vector<std::string> submitted;
    std::vector<Seen> results;
};

FetchRequest request(uint64_t id, const std::string& path) {
    FetchRequest made;
    made.id = id;
    made.path = path;
    made.length = 3;
    return made;
}

TEST(MeasuringFetcher, CountsLatencyFromTheIntendedTimeNotFromTheSubmission) {
    ScriptedFetcher inner;
    Recorder recorder;
    MeasuringFetcher fetcher(inner, recorder);
    fetcher.set_intended(LoadClock::now() - 5s);  // the caller is five seconds late
    fetcher.submit(request(1, "a"));
    inner.answer_first();
    EXPECT_EQ(fetcher.poll().size(), 1u);
    ASSERT_EQ(recorder.results.size(), 1u);
    EXPECT_GE(recorder.results[0].latency, 5s);
    EXPECT_LT(recorder.results[0].latency, 6s);
}

TEST(MeasuringFetcher, TimesAnAnswerWhenItIsCollectedAndKeepsItForTheStreamer) {
    ScriptedFetcher inner;
    Recorder recorder;
    MeasuringFetcher fetcher(inner, recorder);
    fetcher.set_intended(LoadClock::now());
    fetcher.submit(request(1, "a"));
    inner.answer_first();
    fetcher.collect();
    std::this_thread::sleep_for(60ms);
    const auto results = fetcher.poll();
    ASSERT_EQ(results.size(), 1u);
    EXPECT_EQ(results[0].bytes->size(), 3u);
    EXPECT_LT(recorder.results.at(0).latency, 50ms) << "the time until the streamer polls is no latency of the network";
    EXPECT_TRUE(fetcher.poll().empty()) << "each answer is given once";
}

TEST(MeasuringFetcher, KnowsWhatIsStillUnanswered) {
    ScriptedFetcher inner;
    Recorder recorder;
    MeasuringFetcher fetcher(inner, recorder);
    const auto first = LoadClock::now(), second = first + 1s;
    fetcher.set_intended(first);
    fetcher.submit(request(1, "a"));
    fetcher.submit(request(2, "b"));
    fetcher.set_intended(second);
    fetcher.submit(request(3, "c"));
    fetcher.cancel(2);
    fetcher.collect();
    EXPECT_EQ(fetcher.unanswered(), (std::vector{first, second}));
    EXPECT_TRUE(recorder.results.at(0).cancelled);
    EXPECT_EQ(recorder.submitted, (std::vector<std::string>{"a", "b", "c"}));
}

}  // namespace
}  // namespace citystream::client
