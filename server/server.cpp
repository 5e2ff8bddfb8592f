#include "server/server.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/signal_set.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <csignal>
#include <exception>
#include <thread>
#include <utility>
#include <vector>

#include "server/metrics.h"
#include "server/session.h"
#include "server/site.h"

namespace citystream::server {
namespace {

namespace net = boost::asio;
using boost::system::error_code;
using net::ip::tcp;
constexpr auto kAwait = net::as_tuple(net::use_awaitable);

/// Connections that are being told 503; beyond these they are closed without a word.
constexpr uint32_t kMaxTurnedAway = 256;
/// Descriptors that are not connections: archives, epoll, timers, standard streams.
constexpr uint32_t kReservedDescriptors = 128;
constexpr auto kAcceptPause = std::chrono::milliseconds(50);
constexpr auto kLongestTick = std::chrono::milliseconds(250);
/// While stopping, what has ended is noticed sooner.
constexpr auto kStoppingTick = std::chrono::milliseconds(10);

/// Raises the limit of open descriptors as far as `wanted` connections need; returns how many connections then fit.
uint32_t fit_connections(uint32_t wanted) {
    rlimit limit{};
    if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return wanted;
    const rlim_t needed = rlim_t{wanted} + kMaxTurnedAway + kReservedDescriptors;
    if (limit.rlim_cur < needed) {
        limit.rlim_cur = std::min(needed, limit.rlim_max);
        setrlimit(RLIMIT_NOFILE, &limit);
        getrlimit(RLIMIT_NOFILE, &limit);
    }
    if (limit.rlim_cur >= needed) return wanted;
    const rlim_t spare = kMaxTurnedAway + kReservedDescriptors;
    return limit.rlim_cur > spare ? static_cast<uint32_t>(limit.rlim_cur - spare) : 1;
}

/// One thread with an event loop of its own. A connection stays on the worker that it was given to, so sessions need no
/// locks.
class Worker {
  public:
    Worker(const Site& site, Metrics& metrics, const ServerOptions& options)
        : home_{site, metrics, options.idle_timeout, options.max_head_bytes, false, {}, -1, {}},
          tick_(std::clamp(options.idle_timeout / 8, std::chrono::milliseconds(5), kLongestTick)),
          grace_(options.shutdown_grace) {}

    net::io_context& context() { return context_; }

    void start() {
        net::co_spawn(context_, watch_deadlines(), net::detached);
        thread_ = std::thread([this] { context_.run(); });
    }

    /// On this worker's thread: begins serving (or turning away) a connection.
    void adopt(tcp::socket socket, bool welcome, std::atomic<uint32_t>& counted) {
        if (home_.stopping) {
            counted.fetch_sub(1, std::memory_order_relaxed);
            return;
        }
        auto session = std::make_shared<Session>(std::move(socket), home_);
        const auto done = [session, &counted](const std::exception_ptr&) {
            counted.fetch_sub(1, std::memory_order_relaxed);
        };
        net::co_spawn(context_, welcome ? session->serve() : session->turn_away(), done);
    }

    /// From any thread.
    void request_stop() {
        net::post(context_, [this] {
            home_.stopping = true;
            cut_off_at_ = Clock::now() + grace_;
            for (Session* session : home_.sessions) session->wind_down();
            ticker_.cancel();
        });
    }
    /// From any thread: what is under way ends now.
    void cut_off() {
        net::post(context_, [this] {
            home_.stopping = true;
            cut_off_at_ = Clock::now();
            ticker_.cancel();
        });
    }
    void join() {
        if (thread_.joinable()) thread_.join();
    }

  private:
    net::awaitable<void> watch_deadlines() {
        while (!home_.stopping || !home_.sessions.empty()) {
            ticker_.expires_after(home_.stopping ? kStoppingTick : tick_);
            co_await ticker_.async_wait(kAwait);
            const auto now = Clock::now();
            for (Session* session : home_.sessions) session->check_deadline(now);
            if (home_.stopping && now >= cut_off_at_) {
                for (Session* session : home_.sessions) session->cut_off();
            }
        }
    }

    SessionHome home_;
    std::chrono::milliseconds tick_, grace_;
    Clock::time_point cut_off_at_ = Clock::time_point::max();
    net::io_context context_{1};  ///< after home_: the sessions that it destroys still use it
    net::steady_timer ticker_{context_};
    std::thread thread_;
};

class AsioServer final : public Server {
  public:
    AsioServer(ArchiveCatalog catalog, const ServerOptions& options)
        : metrics_(labels_of(catalog)),
          site_(std::move(catalog), metrics_),
          max_connections_(fit_connections(options.max_connections)) {
        const uint32_t threads =
            options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
        for (uint32_t i = 0; i < threads; ++i) workers_.push_back(std::make_unique<Worker>(site_, metrics_, options));
    }
    ~AsioServer() override {
        request_stop();
        wait();
    }

    Status listen(const ListenAddress& address);
    void run() {
        net::co_spawn(front_, accept_connections(), net::detached);
        for (auto& worker : workers_) worker->start();
        front_thread_ = std::thread([this] { front_.run(); });
    }

    uint16_t port() const override { return endpoint_.port(); }
    std::string url() const override {
        const std::string host = endpoint_.address().to_string();
        return endpoint_.address().is_v6() ? fmt::format("http://[{}]:{}", host, port())
                                           : fmt::format("http://{}:{}", host, port());
    }
    uint32_t max_connections() const override { return max_connections_; }
    ServerSummary summary() const override { return {metrics_.requests(), metrics_.sent_bytes()}; }

    void stop_on_signals() override {
        net::post(front_, [this] {
            signals_.add(SIGINT);
            signals_.add(SIGTERM);
            await_signal();
        });
    }
    void request_stop() override {
        if (stopping_.exchange(true)) return;
        net::post(front_, [this] {
            error_code ignored;
            acceptor_.close(ignored);
            pause_.cancel();
        });
        for (auto& worker : workers_) worker->request_stop();
    }
    void wait() override {
        for (auto& worker : workers_) worker->join();
        net::post(front_, [this] { signals_.cancel(); });
        if (front_thread_.joinable()) front_thread_.join();
    }

  private:
    static std::vector<Metrics::CityLabel> labels_of(const ArchiveCatalog& catalog) {
        std::vector<Metrics::CityLabel> labels;
        for (const City& city : catalog.cities()) labels.push_back({city.name, city.archive->file_size()});
        return labels;
    }

    void await_signal() {
        signals_.async_wait([this](error_code error, int) {
            if (error) return;
            if (stopping_) {
                for (auto& worker : workers_) worker->cut_off();
            }
            request_stop();
            await_signal();
        });
    }

    net::awaitable<void> accept_connections();
    void hand_over(Worker& worker, tcp::socket socket);

    Metrics metrics_;
    Site site_;
    uint32_t max_connections_;
    std::vector<std::unique_ptr<Worker>> workers_;
    std::atomic<bool> stopping_{false};
    std::atomic<uint32_t> served_{0}, turned_away_{0};  ///< connections now
    net::io_context front_{1};
    tcp::acceptor acceptor_{front_};
    net::steady_timer pause_{front_};
    net::signal_set signals_{front_};
    tcp::endpoint endpoint_;
    std::thread front_thread_;
};

Status AsioServer::listen(const ListenAddress& address) {
    const auto failed = [&](const error_code& error) {
        return Error{fmt::format("cannot listen on {}:{}: {}", address.host, address.port, error.message())};
    };
    error_code error;
    tcp::resolver resolver(front_);
    const auto found = resolver.resolve(address.host, std::to_string(address.port), tcp::resolver::passive, error);
    if (error) return failed(error);
    const tcp::endpoint wanted = found.begin()->endpoint();
    acceptor_.open(wanted.protocol(), error);
    if (error) return failed(error);
    acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(wanted, error);
    if (!error) acceptor_.listen(net::socket_base::max_listen_connections, error);
    if (!error) endpoint_ = acceptor_.local_endpoint(error);
    if (error) return failed(error);
    return Done{};
}

net::awaitable<void> AsioServer::accept_connections() {
    for (size_t next = 0; acceptor_.is_open(); next = (next + 1) % workers_.size()) {
        Worker& worker = *workers_[next];
        auto [error, socket] = co_await acceptor_.async_accept(worker.context(), kAwait);
        if (!error) {
            hand_over(worker, std::move(socket));
        } else if (acceptor_.is_open()) {
            // Out of descriptors or memory: the queue of the kernel holds newcomers until some are free.
            pause_.expires_after(kAcceptPause);
            co_await pause_.async_wait(kAwait);
        }
    }
}

void AsioServer::hand_over(Worker& worker, tcp::socket socket) {
    const bool welcome = served_.load(std::memory_order_relaxed) < max_connections_;
    std::atomic<uint32_t>& counted = welcome ? served_ : turned_away_;
    if (!welcome) {
        metrics_.connection_refused();
        if (turned_away_.load(std::memory_order_relaxed) >= kMaxTurnedAway) return;
    }
    counted.fetch_add(1, std::memory_order_relaxed);
    net::post(worker.context(), [&worker, &counted, welcome, moved = std::move(socket)]() mutable {
        worker.adopt(std::move(moved), welcome, counted);
    });
}

}  // namespace

Result<std::unique_ptr<Server>> Server::start(ArchiveCatalog catalog, const ServerOptions& options) {
    auto server = std::make_unique<AsioServer>(std::move(catalog), options);
    if (const Status listening = server->listen(options.listen); !listening) return listening.error();
    server->run();
    return std::unique_ptr<Server>(std::move(server));
}

}  // namespace citystream::server
