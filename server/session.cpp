#include "server/session.h"

#include <array>
#include <boost/asio/as_tuple.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <ctime>
#include <utility>

namespace citystream::server {
namespace {

namespace net = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;
using Parser = http::request_parser<http::empty_body>;
constexpr auto kAwait = net::as_tuple(net::use_awaitable);

constexpr auto kLingerTime = std::chrono::milliseconds(1000);
constexpr size_t kLingerBytes = 1 << 20;
/// Beyond one head there is room for pipelined requests that came along with it.
constexpr size_t kPipelineBytes = 16 * 1024;

Method method_of(http::verb verb) {
    switch (verb) {
        case http::verb::get:
            return Method::kGet;
        case http::verb::head:
            return Method::kHead;
        case http::verb::options:
            return Method::kOptions;
        default:
            return Method::kOther;
    }
}

/// A field's value; several lines of one name are one list (RFC 9110 section 5.3).
std::string joined(const Parser& parser, http::field name) {
    std::string value;
    const auto [begin, end] = parser.get().equal_range(name);
    for (auto line = begin; line != end; ++line) {
        if (!value.empty()) value += ", ";
        value += std::string_view(line->value().data(), line->value().size());
    }
    return value;
}

/// Owns the text that RequestFields looks at.
struct RequestText {
    std::string target, range, if_range, if_match, if_none_match;
};

RequestFields fields_of(const Parser& parser, RequestText& text) {
    const auto& message = parser.get();
    text.target = std::string(message.target().data(), message.target().size());
    text.range = joined(parser, http::field::range);
    text.if_range = joined(parser, http::field::if_range);
    text.if_match = joined(parser, http::field::if_match);
    text.if_none_match = joined(parser, http::field::if_none_match);
    RequestFields fields;
    fields.method = method_of(message.method());
    fields.target = text.target;
    fields.range = text.range;
    fields.if_range = text.if_range;
    fields.if_match = text.if_match;
    fields.if_none_match = text.if_none_match;
    fields.http_1_0 = message.version() < 11;
    fields.has_host = message.count(http::field::host) == 1;
    fields.has_body = parser.chunked() || (parser.content_length() && *parser.content_length() > 0);
    fields.keep_alive = message.keep_alive();
    return fields;
}

}  // namespace

std::string_view SessionHome::current_date() {
    const auto now = static_cast<int64_t>(std::time(nullptr));
    if (now != date_second) {
        date_second = now;
        date = http_date(now);
    }
    return date;
}

Session::Session(net::ip::tcp::socket socket, SessionHome& home)
    : socket_(std::move(socket)), home_(home), buffer_(home.max_head_bytes + kPipelineBytes) {
    home_.sessions.insert(this);
    home_.metrics.connection_opened();
}

Session::~Session() {
    home_.sessions.erase(this);
    home_.metrics.connection_closed();
}

void Session::set_deadline(Phase phase, Clock::duration allowance) {
    phase_ = phase;
    deadline_ = Clock::now() + allowance;
}

void Session::check_deadline(Clock::time_point now) {
    if (now < deadline_) return;
    deadline_ = Clock::time_point::max();
    timed_out_ = true;
    error_code ignored;
    socket_.cancel(ignored);
}

void Session::wind_down() {
    if (phase_ == Phase::kWaiting && buffer_.size() == 0) {
        error_code ignored;
        socket_.cancel(ignored);
    }
}

void Session::cut_off() {
    error_code ignored;
    socket_.close(ignored);
}

net::awaitable<void> Session::serve() {
    error_code ignored;
    socket_.set_option(net::ip::tcp::no_delay(true), ignored);
    bool more = true;
    while (more) {
        if (home_.stopping && buffer_.size() == 0) break;
        more = co_await serve_one();
    }
    co_await linger();
}

net::awaitable<bool> Session::serve_one() {
    set_deadline(Phase::kWaiting, home_.idle_timeout);
    Parser parser;
    parser.header_limit(static_cast<std::uint32_t>(home_.max_head_bytes));
    const auto [error, count] = co_await http::async_read_header(socket_, buffer_, parser, kAwait);
    if (error) {
        co_await answer_read_error(error, parser.got_some());
        co_return false;
    }
    const auto received = Clock::now();
    home_.metrics.request_started();
    RequestText text;
    const RequestFields fields = fields_of(parser, text);
    const Response response = respond(fields, home_.site, home_.current_date(), home_.stopping);
    const bool taken = co_await send(response, received);
    co_return taken && !response.close;
}

net::awaitable<void> Session::answer_read_error(error_code error, bool head_began) {
    unsigned status = 400;
    std::string_view message = "this is no HTTP/1.1 request";
    if (error == net::error::operation_aborted) {
        if (!timed_out_ || !head_began) co_return;
        home_.metrics.request_timed_out();
        status = 408;
        message = "the request's head did not arrive in time";
    } else if (error == http::error::header_limit || error == http::error::buffer_overflow) {
        status = 431;
        message = "the request's head is too large";
    } else if (error == http::error::bad_version) {
        status = 505;
        message = "only HTTP/1.0 and HTTP/1.1 are spoken here";
    } else if (error.category() != http::make_error_code(http::error::bad_target).category() ||
               error == http::error::end_of_stream || error == http::error::partial_message) {
        co_return;
    }
    home_.metrics.request_started();
    const Response response = refuse(status, message, home_.current_date());
    co_await send(response, Clock::now());
}

net::awaitable<bool> Session::send(const Response& response, Clock::time_point received) {
    const auto body = response.body();
    std::array<net::const_buffer, 2> parts = {net::buffer(response.head), net::buffer(body.data(), body.size())};
    while (net::buffer_size(parts) > 0) {
        set_deadline(Phase::kAnswering, home_.idle_timeout);
        const auto [error, count] = co_await socket_.async_write_some(parts, kAwait);
        if (error) {
            if (timed_out_) home_.metrics.request_timed_out();
            home_.metrics.answer_broken_off();
            co_return false;
        }
        const size_t of_head = std::min(count, parts[0].size());
        parts[0] += of_head;
        parts[1] += count - of_head;
    }
    const double seconds = std::chrono::duration<double>(Clock::now() - received).count();
    home_.metrics.count_request(response.city, response.status, body.size(), response.head.size() + body.size(),
                                seconds);
    co_return true;
}

net::awaitable<void> Session::linger() {
    error_code ignored;
    socket_.shutdown(net::ip::tcp::socket::shutdown_send, ignored);
    set_deadline(Phase::kLingering, kLingerTime);
    timed_out_ = false;
    std::array<std::byte, 4096> dropped;
    for (size_t total = 0; total < kLingerBytes && !timed_out_;) {
        const auto [error, count] = co_await socket_.async_read_some(net::buffer(dropped), kAwait);
        if (error) break;
        total += count;
    }
    socket_.close(ignored);
}

net::awaitable<void> Session::turn_away() {
    home_.metrics.request_started();
    const Response response = refuse(503, "too many connections are open; try again in a moment", home_.current_date());
    co_await send(response, Clock::now());
    co_await linger();
}

}  // namespace citystream::server
