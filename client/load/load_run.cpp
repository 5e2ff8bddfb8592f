#include "client/load/load_run.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <queue>
#include <random>
#include <thread>
#include <utility>

#include "client/cache/directory_pool.h"

namespace citystream::client {
namespace {

using Clients = std::vector<std::unique_ptr<LoadClient>>;

constexpr auto kCollectInterval = std::chrono::microseconds(500);
constexpr auto kProgressInterval = std::chrono::milliseconds(200);
constexpr uint32_t kOpeningThreads = 32;
/// Requests are handed to the fetcher when they are first wanted, so that the wait in its queue is measured too.
constexpr uint32_t kMostRequestsInFlight = 1024;

LoadClock::duration seconds(double value) {
    return std::chrono::duration_cast<LoadClock::duration>(std::chrono::duration<double>(value));
}

uint32_t driving_threads(const LoadOptions& options) {
    const uint32_t wanted = options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    return std::min(wanted, std::max(1u, options.clients));
}

/// What makes a streamer a load client: it counts instead of decoding, never waits, and shares what does not differ
/// between clients.
LoadOptions completed(LoadOptions options) {
    StreamerOptions& streamer = options.client.streamer;
    streamer.decode = false;
    streamer.wait_for_selection = false;
    streamer.max_requests_in_flight = kMostRequestsInFlight;
    streamer.directory_pool = std::make_shared<DirectoryPool>();
    options.client.fetcher.network = std::make_shared<NetworkThreads>(driving_threads(options));
    return options;
}

/// Opens clients on several threads at once, for opening waits for the network.
Clients open_clients(const LoadOptions& options, CityIndex& index, const std::atomic<bool>& stop,
                     LoadOutcome& outcome) {
    Clients clients(options.clients);
    std::atomic<uint32_t> next{0};
    std::mutex mutex;
    const auto work = [&] {
        LoadMeasurements measured;
        uint32_t failed = 0;
        for (uint32_t i = next++; i < options.clients && !stop; i = next++) {
            auto client = LoadClient::open(options.client, index, measured);
            if (client) {
                clients[i] = std::move(*client);
            } else {
                ++failed;
                if (measured.first_error.empty()) measured.first_error = client.error().text();
                // A server that is not there will not be there for the others either.
                if (measured.answers == 0) break;
            }
        }
        const std::lock_guard lock(mutex);
        outcome.measured.merge(measured);
        outcome.clients_failed += failed;
    };
    std::vector<std::thread> threads;
    for (uint32_t i = 0; i < std::min(kOpeningThreads, options.clients); ++i) threads.emplace_back(work);
    for (auto& thread : threads) thread.join();
    std::erase(clients, nullptr);
    outcome.clients_opened = static_cast<uint32_t>(clients.size());
    return clients;
}

/// One driving thread: the next due update of any of its clients, and in between a look at what has arrived.
class Driver {
  public:
    Driver(const LoadOptions& options, const CameraPath& path, const std::atomic<bool>& stop,
           LoadClock::time_point begin)
        : options_(options), path_(path), stop_(stop), begin_(begin), end_(begin + seconds(options.duration_seconds)) {}

    void add(LoadClient& client, uint32_t index) {
        const ClientStart start = start_of_client(index, options_, path_.duration());
        client.measure_into(measured_);
        replays_.push_back({&client, start, 0});
        due_.push({begin_ + seconds(start.delay_seconds), replays_.size() - 1});
    }
    void run() {
        while (!stop_ && !due_.empty()) {
            const Due next = due_.top();
            const auto now = LoadClock::now();
            if (now >= collect_at_) collect(now);
            if (next.time >= end_) break;
            if (next.time > now) {
                std::this_thread::sleep_until(std::min(next.time, collect_at_));
                continue;
            }
            due_.pop();
            update(next);
        }
        while (!stop_ && LoadClock::now() < end_) collect_and_pause();
        const auto now = LoadClock::now();
        for (Replay& replay : replays_) replay.client->finish(now);
        answers_ = measured_.answers;
    }
    uint64_t answers() const { return answers_; }
    const LoadMeasurements& measured() const { return measured_; }

  private:
    struct Replay {
        LoadClient* client;
        ClientStart start;
        uint64_t updates;
    };
    struct Due {
        LoadClock::time_point time;
        size_t replay;
        bool operator<(const Due& other) const { return time > other.time; }  // earliest on top
    };

    void update(const Due& due) {
        Replay& replay = replays_[due.replay];
        const double flown = static_cast<double>(replay.updates) / options_.updates_per_second;
        const double duration = path_.duration();
        const double along = duration > 0 ? std::fmod(replay.start.path_seconds + flown, duration) : 0;
        replay.client->update(path_.at(path_.samples.front().t + along), due.time);
        ++replay.updates;
        const double next =
            replay.start.delay_seconds + static_cast<double>(replay.updates) / options_.updates_per_second;
        due_.push({begin_ + seconds(next), due.replay});
    }
    void collect(LoadClock::time_point now) {
        for (Replay& replay : replays_) replay.client->collect();
        answers_ = measured_.answers;
        collect_at_ = now + kCollectInterval;
    }
    void collect_and_pause() {
        collect(LoadClock::now());
        std::this_thread::sleep_until(std::min(end_, collect_at_));
    }

    const LoadOptions& options_;
    const CameraPath& path_;
    const std::atomic<bool>& stop_;
    LoadClock::time_point begin_, end_, collect_at_{};
    std::vector<Replay> replays_;
    std::priority_queue<Due> due_;
    LoadMeasurements measured_;
    std::atomic<uint64_t> answers_{0};
};

void report_progress(const std::vector<std::unique_ptr<Driver>>& drivers, std::atomic<uint32_t>& running,
                     LoadClock::time_point begin, const std::function<void(double, uint64_t)>& progress) {
    while (running > 0) {
        std::this_thread::sleep_for(kProgressInterval);
        uint64_t answers = 0;
        for (const auto& driver : drivers) answers += driver->answers();
        if (progress) progress(std::chrono::duration<double>(LoadClock::now() - begin).count(), answers);
    }
}

}  // namespace

ClientStart start_of_client(uint32_t index, const LoadOptions& options, double path_duration) {
    std::seed_seq seeds{static_cast<uint32_t>(options.seed), static_cast<uint32_t>(options.seed >> 32), index};
    std::mt19937_64 random(seeds);
    // 53 bits to [0, 1): the same on every platform, which std::uniform_real_distribution does not promise.
    const auto unit = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
    ClientStart start;
    start.path_seconds = unit() * path_duration;
    start.delay_seconds = unit() * std::min(options.ramp_seconds, options.duration_seconds / 2);
    return start;
}

LoadOutcome run_load(const LoadOptions& wanted, const CameraPath& path, const std::atomic<bool>& stop,
                     const std::function<void(double, uint64_t)>& progress) {
    const LoadOptions options = completed(wanted);
    LoadOutcome outcome;
    CityIndex index;
    Clients clients = open_clients(options, index, stop, outcome);
    const auto begin = LoadClock::now();
    std::vector<std::unique_ptr<Driver>> drivers;
    for (uint32_t i = 0; i < driving_threads(options); ++i)
        drivers.push_back(std::make_unique<Driver>(options, path, stop, begin));
    for (uint32_t i = 0; i < clients.size(); ++i) drivers[i % drivers.size()]->add(*clients[i], i);

    std::atomic<uint32_t> running{clients.empty() ? 0 : static_cast<uint32_t>(drivers.size())};
    std::vector<std::thread> threads;
    if (!clients.empty()) {
        for (auto& driver : drivers) {
            threads.emplace_back([&driver, &running] {
                driver->run();
                --running;
            });
        }
    }
    report_progress(drivers, running, begin, progress);
    for (auto& thread : threads) thread.join();
    outcome.elapsed_seconds = std::chrono::duration<double>(LoadClock::now() - begin).count();
    for (const auto& driver : drivers) outcome.measured.merge(driver->measured());
    outcome.interrupted = stop;
    return outcome;
}

}  // namespace citystream::client
