#include "client/stream/http_fetcher.h"

#include <atomic>
#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/error.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/write.hpp>
#include <thread>

#include "client/stream/network_shape.h"
#include "client/stream/request_queue.h"

namespace citystream::client {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using Clock = ShapedLink::Clock;

struct NetworkThreads::Implementation {
    asio::io_context context;
    asio::executor_work_guard<asio::io_context::executor_type> work{context.get_executor()};
    std::vector<std::thread> threads;
};

NetworkThreads::NetworkThreads(uint32_t threads) : implementation_(std::make_unique<Implementation>()) {
    for (uint32_t i = 0; i < std::max(1u, threads); ++i) {
        implementation_->threads.emplace_back([this] { implementation_->context.run(); });
    }
}

NetworkThreads::~NetworkThreads() {
    implementation_->work.reset();
    for (std::thread& thread : implementation_->threads) thread.join();
}

namespace {

constexpr auto kTuple = asio::as_tuple(asio::use_awaitable);
constexpr size_t kChunkBytes = 16384;
constexpr uint32_t kHeaderLimit = 16384;
constexpr uint32_t kFirstContactAttempts = 4;        // a server that never answered is given up on sooner
constexpr uint64_t kWorthClosingBytes = 256u << 10;  // of a cancelled answer still to come

/// How one try ended. Final errors are not tried again: the server answered, and would answer the same.
struct Attempt {
    enum class Outcome : uint8_t { kGood, kAgain, kFinal } outcome = Outcome::kAgain;
    std::vector<std::byte> bytes;
    std::string error;
    bool stale_connection = false;  ///< a kept connection had been closed by the server: free to try again at once
};

struct Connection {
    explicit Connection(const asio::any_io_executor& executor) : stream(executor), timer(executor) {}
    beast::tcp_stream stream;
    asio::steady_timer timer;
    beast::flat_buffer buffer;
    bool open = false;
    bool used = false;  ///< has carried an answer
};

/// All state of one fetcher's connections; touched on the strand only, but for the queue and the link, which are
/// thread-safe.
struct HttpState : std::enable_shared_from_this<HttpState> {
    HttpState(asio::io_context& context, HttpPlace where, const FetcherOptions& fetcher_options)
        : strand(asio::make_strand(context)), place(std::move(where)), options(fetcher_options), link(options.shape) {
        // The state may be let go of on an I/O thread, which must not be the one to join itself.
        options.network.reset();
        for (uint32_t i = 0; i < std::max(1u, options.connections); ++i) {
            connections.push_back(std::make_unique<Connection>(strand));
        }
    }

    void start();
    void wake_idle();
    void stop();

    asio::awaitable<void> run(Connection& connection);
    asio::awaitable<FetchResult> fetch(Connection& connection, const FetchRequest& request);
    asio::awaitable<Attempt> attempt(Connection& connection, const FetchRequest& request);
    asio::awaitable<std::string> connect(Connection& connection);
    asio::awaitable<void> read_body(Connection& connection, const FetchRequest& request,
                                    http::response_parser<http::buffer_body>& parser, Attempt& result);
    asio::awaitable<void> sleep_until(Connection& connection, Clock::time_point until);

    uint32_t attempts_allowed() const;
    Clock::duration backoff(uint32_t attempt, uint64_t id) const;
    std::string name_of(const FetchRequest& request) const { return place.text() + request.path; }

    asio::any_io_executor strand;
    HttpPlace place;
    FetcherOptions options;
    ShapedLink link;
    RequestQueue queue;
    std::vector<std::unique_ptr<Connection>> connections;
    std::vector<Connection*> idle;
    std::atomic<bool> stopping = false;
    bool ever_answered = false;
    bool down = false;  ///< the last request gave up on a dead server: the next ones try once until one succeeds
    std::mutex live_mutex;
    std::condition_variable live_changed;
    size_t live = 0;
};

void HttpState::start() {
    live = connections.size();
    for (const auto& connection : connections) {
        asio::co_spawn(
            strand,
            [self = shared_from_this(), &one = *connection]() -> asio::awaitable<void> { co_await self->run(one); },
            [self = shared_from_this()](const std::exception_ptr&) {
                const std::lock_guard lock(self->live_mutex);
                --self->live;
                self->live_changed.notify_all();
            });
    }
}

/// Wakes one idle connection, rather one that is open than one that must connect first.
void HttpState::wake_idle() {
    if (idle.empty()) return;
    auto best = std::find_if(idle.begin(), idle.end(), [](const Connection* c) { return c->open; });
    if (best == idle.end()) best = idle.begin();
    Connection* connection = *best;
    idle.erase(best);
    connection->timer.cancel();
}

/// Ends every coroutine and waits until the last one has returned.
void HttpState::stop() {
    stopping = true;
    queue.close();
    asio::post(strand, [self = shared_from_this()] {
        for (const auto& connection : self->connections) {
            connection->timer.cancel();
            error_code ignored;
            connection->stream.socket().close(ignored);
            connection->stream.cancel();
        }
    });
    std::unique_lock lock(live_mutex);
    live_changed.wait(lock, [&] { return live == 0; });
}

asio::awaitable<void> HttpState::run(Connection& connection) {
    while (!stopping) {
        std::optional<FetchRequest> request = queue.take();
        if (!request) {
            idle.push_back(&connection);
            connection.timer.expires_at(Clock::time_point::max());
            co_await connection.timer.async_wait(kTuple);
            std::erase(idle, &connection);
            continue;
        }
        FetchResult result = co_await fetch(connection, *request);
        queue.deliver(std::move(result));
    }
}

uint32_t HttpState::attempts_allowed() const {
    const uint32_t most = std::max(1u, options.max_attempts);
    if (down) return 1;
    return ever_answered ? most : std::min(most, kFirstContactAttempts);
}

/// Doubles with each attempt; +-25 % from a hash of request and attempt, so that runs repeat and clients do not march
/// in step.
Clock::duration HttpState::backoff(uint32_t attempt, uint64_t id) const {
    uint64_t hash = (id + 1) * 0x9E3779B97F4A7C15u + attempt * 0xD1B54A32D192ED03u;
    hash ^= hash >> 29;
    const double jitter = 0.75 + 0.5 * static_cast<double>(hash & 0xFFFF) / 65536.0;
    const double seconds = options.first_backoff_seconds * static_cast<double>(1u << std::min(attempt, 16u)) * jitter;
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(std::min(seconds, 10.0)));
}

asio::awaitable<FetchResult> HttpState::fetch(Connection& connection, const FetchRequest& request) {
    const Clock::time_point sent = Clock::now();
    uint32_t attempts = 0;
    bool stale_allowed = true;
    Attempt last;
    while (!stopping) {
        last = co_await attempt(connection, request);
        if (last.stale_connection && stale_allowed) {
            stale_allowed = false;
            continue;
        }
        ++attempts;
        if (last.outcome != Attempt::Outcome::kAgain || queue.is_cancelled(request.id)) break;
        if (attempts >= attempts_allowed()) {
            down = true;
            break;
        }
        queue.count_retry();
        co_await sleep_until(connection, Clock::now() + backoff(attempts - 1, request.id));
    }
    FetchResult result{request.id, Error{last.error}, false, std::max(1u, attempts), 0};
    if (last.outcome == Attempt::Outcome::kGood) {
        result.bytes = std::move(last.bytes);
    } else if (attempts > 1) {
        result.bytes = Error{last.error + " (after " + std::to_string(attempts) + " attempts)"};
    }
    result.seconds = std::chrono::duration<double>(Clock::now() - sent).count();
    co_return result;
}

asio::awaitable<void> HttpState::sleep_until(Connection& connection, Clock::time_point until) {
    if (until <= Clock::now() || stopping) co_return;
    connection.timer.expires_at(until);
    co_await connection.timer.async_wait(kTuple);
}

asio::awaitable<std::string> HttpState::connect(Connection& connection) {
    asio::ip::tcp::resolver resolver(strand);
    std::string host = place.host;
    if (host.starts_with('[')) host = host.substr(1, host.size() - 2);
    auto [lookup, endpoints] = co_await resolver.async_resolve(host, place.port, kTuple);
    if (lookup) co_return "cannot find host " + place.host + ": " + lookup.message();
    if (stopping) co_return "stopped";
    connection.stream.expires_after(
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.timeout_seconds)));
    auto [status, endpoint] = co_await connection.stream.async_connect(endpoints, kTuple);
    if (status) co_return "cannot connect: " + status.message();
    error_code ignored;
    connection.stream.socket().set_option(asio::ip::tcp::no_delay(true), ignored);
    co_await sleep_until(connection, Clock::now() + 2 * link.half_round_trip());
    connection.buffer.clear();
    connection.open = true;
    connection.used = false;
    co_return std::string();
}

/// What an answer's head says about its body: nothing for "go on and read it".
struct HeadVerdict {
    Attempt::Outcome outcome = Attempt::Outcome::kGood;
    std::string error;
};

HeadVerdict judge_head(const FetchRequest& request, const http::response_parser<http::buffer_body>& parser) {
    const auto& head = parser.get();
    const unsigned status = head.result_int();
    if (status == 206 && request.length > 0) {
        const auto range = parse_content_range(std::string(head[http::field::content_range]));
        if (!range) return {Attempt::Outcome::kAgain, range.error().text()};
        if (range->first == request.offset && range->last == request.offset + request.length - 1) return {};
        return {Attempt::Outcome::kAgain, "the server sent another range than asked for"};
    }
    if (status == 200) return {};
    const std::string text = "HTTP " + std::to_string(status) + " " + std::string(http::obsolete_reason(head.result()));
    if (status >= 500 || status == 408 || status == 429) return {Attempt::Outcome::kAgain, text};
    return {Attempt::Outcome::kFinal, status == 404 ? text + ": no such city or path on this server" : text};
}

asio::awaitable<void> HttpState::read_body(Connection& connection, const FetchRequest& request,
                                           http::response_parser<http::buffer_body>& parser, Attempt& result) {
    // A server that ignores ranges sends the whole file with 200: skip to the part, stop after it.
    const bool whole_file = parser.get().result_int() == 200 && request.length > 0;
    const uint64_t skip = whole_file ? request.offset : 0;
    const uint64_t most = request.length > 0 ? request.length : request.limit;
    std::vector<char> chunk(kChunkBytes);
    uint64_t seen = 0;
    while (!parser.is_done()) {
        parser.get().body().data = chunk.data();
        parser.get().body().size = chunk.size();
        connection.stream.expires_after(
            std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.timeout_seconds)));
        auto [status, read] = co_await http::async_read_some(connection.stream, connection.buffer, parser, kTuple);
        if (status == http::error::need_buffer) status = {};
        const uint64_t got = chunk.size() - parser.get().body().size;
        queue.count_bytes(read > got ? read - got : 0, got);
        if (status) {
            result.error = "the answer broke off: " + status.message();
            co_return;
        }
        const uint64_t from = std::min(got, skip > seen ? skip - seen : 0);
        const uint64_t take = std::min(got - from, most - std::min<uint64_t>(most, result.bytes.size()));
        const auto* bytes = reinterpret_cast<const std::byte*>(chunk.data());
        result.bytes.insert(result.bytes.end(), bytes + from, bytes + from + take);
        seen += got;
        if (!whole_file && take < got) {
            result.outcome = request.length > 0 ? Attempt::Outcome::kAgain : Attempt::Outcome::kFinal;
            result.error = "the answer is longer than the " + std::to_string(most) + " bytes expected";
            connection.open = false;
            co_return;
        }
        if (whole_file && result.bytes.size() == request.length && !parser.is_done()) break;
        if (queue.is_cancelled(request.id) && request.length > seen + kWorthClosingBytes) break;
        co_await sleep_until(connection, link.reserve(got, Clock::now()));
    }
    connection.open = connection.open && parser.is_done() && parser.keep_alive();
    if (request.length > 0 && result.bytes.size() != request.length) {
        result.error = "the answer is shorter than the " + std::to_string(request.length) + " bytes asked for";
        co_return;
    }
    result.outcome = Attempt::Outcome::kGood;
}

http::request<http::empty_body> make_request(const HttpPlace& place, const FetchRequest& request) {
    http::request<http::empty_body> message(http::verb::get, place.base + request.path, 11);
    message.set(http::field::host, place.port == "80" ? place.host : place.host + ":" + place.port);
    message.set(http::field::user_agent, "citystream");
    message.set(http::field::accept_encoding, "identity");
    if (request.length > 0) {
        message.set(http::field::range, "bytes=" + std::to_string(request.offset) + "-" +
                                            std::to_string(request.offset + request.length - 1));
    }
    return message;
}

asio::awaitable<Attempt> HttpState::attempt(Connection& connection, const FetchRequest& request) {
    Attempt result;
    if (!connection.open) {
        connection.stream.close();
        result.error = co_await connect(connection);
        if (!result.error.empty()) {
            result.error = name_of(request) + ": " + result.error;
            co_return result;
        }
    }
    const http::request<http::empty_body> message = make_request(place, request);
    const Clock::time_point sent = Clock::now();
    connection.stream.expires_after(
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(options.timeout_seconds)));
    auto [write_status, written] = co_await http::async_write(connection.stream, message, kTuple);
    http::response_parser<http::buffer_body> parser;
    parser.body_limit(boost::none);
    parser.header_limit(kHeaderLimit);
    error_code status = write_status;
    if (!status) {
        auto [read_status, header_bytes] =
            co_await http::async_read_header(connection.stream, connection.buffer, parser, kTuple);
        status = read_status;
        queue.count_bytes(header_bytes, 0);
        // First the way there and back, then the link: booked ahead, it would idle while other answers wait.
        co_await sleep_until(connection, sent + 2 * link.half_round_trip());
        co_await sleep_until(connection, link.reserve(header_bytes, Clock::now()));
    }
    if (status) {
        result.stale_connection = connection.used && status != beast::error::timeout;
        result.error = name_of(request) + ": " + status.message();
        connection.open = false;
        co_return result;
    }
    ever_answered = true;
    down = false;
    connection.used = true;
    HeadVerdict verdict = judge_head(request, parser);
    if (verdict.outcome == Attempt::Outcome::kGood) {
        co_await read_body(connection, request, parser, result);
    } else {
        result.outcome = verdict.outcome;
        result.error = std::move(verdict.error);
        connection.open = false;
    }
    if (result.outcome != Attempt::Outcome::kGood) {
        connection.open = false;
        result.bytes.clear();
        result.error = name_of(request) + ": " + result.error;
    }
    co_return result;
}

class HttpFetcher final : public Fetcher {
  public:
    HttpFetcher(const HttpPlace& place, const FetcherOptions& options)
        : network_(options.network ? options.network : std::make_shared<NetworkThreads>(1)),
          state_(std::make_shared<HttpState>(network_->implementation().context, place, options)) {
        state_->start();
    }
    ~HttpFetcher() override { state_->stop(); }
    HttpFetcher(const HttpFetcher&) = delete;
    HttpFetcher& operator=(const HttpFetcher&) = delete;

    /// Only while no request is pending.
    void set_base(const std::string& base) {
        state_->place.base = base;
        state_->place.has_path = true;
    }
    void submit(FetchRequest request) override {
        state_->queue.submit(std::move(request));
        asio::post(state_->strand, [state = state_] { state->wake_idle(); });
    }
    void cancel(uint64_t id) override { state_->queue.cancel(id); }
    std::vector<FetchResult> poll() override { return state_->queue.poll(); }
    std::vector<FetchResult> wait(std::chrono::milliseconds timeout) override { return state_->queue.wait(timeout); }
    size_t pending() const override { return state_->queue.pending(); }
    FetcherStatistics statistics() const override { return state_->queue.statistics(); }

  private:
    std::shared_ptr<NetworkThreads> network_;
    std::shared_ptr<HttpState> state_;
};

/// Asks the server what it has. A plain static server knows no list: then its root is the city.
Status choose_listed_city(HttpFetcher& fetcher, const std::string& url) {
    const auto list = fetch_now(fetcher, "cities.json", 4u << 20);
    if (!list) {
        if (list.error().message.find("HTTP 4") != std::string::npos) return Done{};
        return list.error();
    }
    const auto cities = parse_city_list(*list);
    if (!cities) return Error{url + ": " + cities.error().text()};
    if (cities->empty()) return Error{url + ": the server has no city"};
    if (cities->size() > 1) {
        std::string names;
        for (size_t i = 0; i < cities->size() && i < 10; ++i) names += (i > 0 ? ", " : "") + (*cities)[i].name;
        return Error{url + ": the server has " + std::to_string(cities->size()) +
                     " cities; add one to the address: " + names + (cities->size() > 10 ? ", ..." : "")};
    }
    fetcher.set_base(cities->front().base);
    return Done{};
}

}  // namespace

Result<std::unique_ptr<Fetcher>> open_http_fetcher(const std::string& url, const FetcherOptions& options) {
    const auto place = parse_http_place(url);
    if (!place) return place.error();
    auto fetcher = std::make_unique<HttpFetcher>(*place, options);
    if (!place->has_path) {
        const Status chosen = choose_listed_city(*fetcher, url);
        if (!chosen) return chosen.error();
    }
    return std::unique_ptr<Fetcher>(std::move(fetcher));
}

}  // namespace citystream::client
