// The HTTP server: threads, listening, limits, shutdown. README.md beside this file follows one request through it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "codec/result.h"
#include "server/archive_catalog.h"

namespace citystream::server {

struct ListenAddress {
    std::string host = "127.0.0.1";
    uint16_t port = 8080;  ///< 0: any free port
    /// "127.0.0.1:8080", "[::1]:8080", "localhost:8080", ":8080" (every IPv4 interface), "8080".
    static Result<ListenAddress> parse(const std::string& text);
};

struct ServerOptions {
    ListenAddress listen = {};
    uint32_t threads = 0;  ///< 0: one per processor
    std::chrono::milliseconds idle_timeout{
        30000};  ///< for a whole request head to arrive, and for each piece of an answer to be taken
    uint32_t max_connections = 4096;  ///< one more is answered with 503; lowered to what the process may open
    size_t max_head_bytes = 16 * 1024;
    std::chrono::milliseconds shutdown_grace{5000};  ///< how long answers under way may take once stopping
};

struct ServerSummary {
    uint64_t requests = 0, sent_bytes = 0;
};

/// Thread contract: request_stop() from any thread; everything else from the thread that called start().
class Server {
  public:
    /// Binds, listens and serves on threads of its own. The error is one line that names the address.
    static Result<std::unique_ptr<Server>> start(ArchiveCatalog catalog, const ServerOptions& options);
    /// Stops as by request_stop() and waits.
    virtual ~Server() = default;

    virtual uint16_t port() const = 0;
    /// "http://127.0.0.1:8080", with the port that was really taken.
    virtual std::string url() const = 0;
    virtual uint32_t max_connections() const = 0;

    /// SIGINT and SIGTERM stop the server; a second one cuts answers off.
    virtual void stop_on_signals() = 0;
    /// Stops accepting, lets answers under way end (at most shutdown_grace), closes idle connections at once.
    virtual void request_stop() = 0;
    /// Returns when the server has stopped.
    virtual void wait() = 0;
    virtual ServerSummary summary() const = 0;
};

/// "30s", "500ms", "2m", "45" (seconds): at least 1 ms, at most a day.
Result<std::chrono::milliseconds> parse_duration(const std::string& text);

}  // namespace citystream::server
