// One connection: reads request heads, answers them in order, keeps to its deadlines. Lives on one worker thread.
#pragma once

#include <boost/asio/awaitable.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/system/error_code.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <unordered_set>

#include "server/metrics.h"
#include "server/responses.h"
#include "server/site.h"

namespace citystream::server {

class Session;
using Clock = std::chrono::steady_clock;

/// What the sessions of one worker thread share. Only that thread touches the members that change.
struct SessionHome {
    const Site& site;
    Metrics& metrics;
    std::chrono::milliseconds idle_timeout;
    size_t max_head_bytes;
    bool stopping = false;
    std::unordered_set<Session*> sessions;
    int64_t date_second = -1;  ///< the second that `date` tells
    std::string date;

    /// The Date field's value, formatted once a second.
    std::string_view current_date();
};

/// Thread contract: everything on the thread of the socket's executor.
class Session : public std::enable_shared_from_this<Session> {
  public:
    /// Registers itself at its home until destroyed.
    Session(boost::asio::ip::tcp::socket socket, SessionHome& home);
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    /// Answers requests until the peer, a deadline or a shutdown ends the connection.
    boost::asio::awaitable<void> serve();
    /// Answers 503 and ends the connection.
    boost::asio::awaitable<void> turn_away();

    /// Called regularly: breaks off what has waited longer than it may.
    void check_deadline(Clock::time_point now);
    /// The server stops: an idle connection ends now, a busy one after its answer.
    void wind_down();
    /// Ends the connection whatever it does.
    void cut_off();

  private:
    enum class Phase : uint8_t { kWaiting, kReadingHead, kAnswering, kLingering };

    /// Reads the next head and answers it; false when the connection is to end.
    boost::asio::awaitable<bool> serve_one();
    /// Answers what could not be read as a request, where an answer makes sense.
    boost::asio::awaitable<void> answer_read_error(boost::system::error_code error, bool head_began);
    /// Writes an answer and counts it; false when the peer did not take it.
    boost::asio::awaitable<bool> send(const Response& response, Clock::time_point received);
    /// Closes our side, then reads and drops what the peer still sends for a moment, so that our last bytes are not
    /// lost to a reset.
    boost::asio::awaitable<void> linger();
    void set_deadline(Phase phase, Clock::duration allowance);

    boost::asio::ip::tcp::socket socket_;
    SessionHome& home_;
    boost::beast::flat_buffer buffer_;  ///< received and not yet answered: pipelined requests wait here
    Phase phase_ = Phase::kWaiting;
    Clock::time_point deadline_ = Clock::time_point::max();
    bool timed_out_ = false;
};

}  // namespace citystream::server
