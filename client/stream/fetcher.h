// Byte ranges of a city, asynchronously, from a 3TZ file, a folder or an HTTP server: requests in, results out.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "codec/result.h"

namespace citystream::client {

struct NetworkShape {
    double bits_per_second = 0;  ///< 0 = unlimited
    double round_trip_seconds = 0;
    /// "5mbit,38ms"; also kbit, gbit, s.
    static Result<NetworkShape> parse(const std::string& text);
};

class NetworkThreads;

struct FetcherOptions {
    uint32_t connections = 6;
    std::shared_ptr<NetworkThreads>
        network;                        ///< share I/O threads among many HTTP fetchers; null: one thread of its own
    std::optional<NetworkShape> shape;  ///< token bucket on received bytes, half the round trip each way
    uint32_t max_attempts =
        8;  ///< retries with exponential backoff and jitter from a fixed seed; fewer until a server has answered once
    double first_backoff_seconds = 0.1;
    double timeout_seconds = 15;
};

/// Threads that run the connections of any number of HTTP fetchers. Must outlive them (they hold a reference).
class NetworkThreads {
  public:
    explicit NetworkThreads(uint32_t threads);
    ~NetworkThreads();
    NetworkThreads(const NetworkThreads&) = delete;
    NetworkThreads& operator=(const NetworkThreads&) = delete;
    struct Implementation;
    Implementation& implementation() { return *implementation_; }

  private:
    std::unique_ptr<Implementation> implementation_;
};

struct FetchRequest {
    uint64_t id = 0;   ///< the caller's; unique among requests under way
    std::string path;  ///< relative to tileset.json
    uint64_t offset = 0;
    uint64_t length = 0;  ///< 0 = the whole entry, at most `limit` bytes
    uint64_t limit = 64u << 20;
    double priority = 0;  ///< larger first among those not yet sent
};

struct FetchResult {
    uint64_t id = 0;
    Result<std::vector<std::byte>> bytes;
    bool cancelled = false;
    uint32_t attempts = 1;
    double seconds = 0;  ///< from being sent to the last byte
};

struct FetcherStatistics {
    uint64_t requests = 0, retries = 0, failures = 0, cancelled = 0;
    uint64_t body_bytes = 0;  ///< of answers, as received
    uint64_t header_bytes = 0;
};

/// Thread contract: all calls from one thread; work happens on threads of its own.
class Fetcher {
  public:
    /// `place`: "http://host:port[/city[/tileset.json]]", a .3tz file, or an unpacked folder. An HTTP place without a
    /// path asks the server's list (/cities.json) and takes the only city there (an error names them when there are
    /// several).
    static Result<std::unique_ptr<Fetcher>> open(const std::string& place, const FetcherOptions& options);
    virtual ~Fetcher() = default;
    virtual void submit(FetchRequest request) = 0;
    /// Not yet sent: dropped. Under way: its bytes are discarded. Either way one result with `cancelled` follows.
    virtual void cancel(uint64_t id) = 0;
    /// Results so far, without waiting.
    virtual std::vector<FetchResult> poll() = 0;
    /// Waits for at least one result or the timeout.
    virtual std::vector<FetchResult> wait(std::chrono::milliseconds timeout) = 0;
    virtual size_t pending() const = 0;
    virtual FetcherStatistics statistics() const = 0;
};

/// Submits one request and waits for it (start-up).
Result<std::vector<std::byte>> fetch_now(Fetcher& fetcher, const std::string& path, uint64_t limit);

}  // namespace citystream::client
