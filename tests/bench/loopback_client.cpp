#include "tests/bench/loopback_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <strings.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <thread>

namespace citystream::bench {
namespace {

using Clock = std::chrono::steady_clock;
constexpr size_t kMostHeadBytes = 8192;

double seconds_since(Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
}

class Connection {
  public:
    explicit Connection(uint16_t port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        const int on = 1;
        setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
        const timeval patience{10, 0};
        setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
        open_ = connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    }
    ~Connection() {
        if (socket_ >= 0) close(socket_);
    }
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;
    bool open() const { return open_; }

    /// Asks for [offset, offset + length) and fills `body`. Returns what is wrong, or nothing.
    std::string get_range(const std::string& path, uint64_t offset, uint64_t length, std::vector<char>& body) {
        const std::string request = "GET " + path +
                                    " HTTP/1.1\r\nHost: 127.0.0.1\r\nRange: bytes=" + std::to_string(offset) + "-" +
                                    std::to_string(offset + length - 1) + "\r\n\r\n";
        if (send(socket_, request.data(), request.size(), MSG_NOSIGNAL) != static_cast<ssize_t>(request.size()))
            return "cannot send";
        size_t have = 0, head = 0;
        body.resize(kMostHeadBytes + length);
        while (head == 0) {
            const ssize_t count = recv(socket_, body.data() + have, body.size() - have, 0);
            if (count <= 0) return "the connection ended in an answer's head";
            have += static_cast<size_t>(count);
            const size_t end = std::string_view(body.data(), std::min(have, kMostHeadBytes)).find("\r\n\r\n");
            if (end != std::string_view::npos) head = end + 4;
            if (head == 0 && have >= kMostHeadBytes) return "an answer's head is too long";
        }
        const std::string_view answer(body.data(), head);
        if (!answer.starts_with("HTTP/1.1 206")) return "answer: " + std::string(answer.substr(0, answer.find('\r')));
        if (have > head + length) return "more bytes than asked for";
        while (have < head + length) {
            const ssize_t count = recv(socket_, body.data() + have, head + length - have, 0);
            if (count <= 0) return "the connection ended in an answer's body";
            have += static_cast<size_t>(count);
        }
        body_begin_ = head;
        return {};
    }
    size_t body_begin() const { return body_begin_; }

  private:
    int socket_;
    bool open_ = false;
    size_t body_begin_ = 0;
};

void drive_connection(const RangeLoad& load, std::span<const ServedFile> files, uint64_t first, RangeResult& result) {
    Connection connection(load.port);
    if (!connection.open()) {
        result.failure = "cannot connect";
        return;
    }
    std::vector<char> body;
    const auto begin = Clock::now();
    for (uint64_t i = first; seconds_since(begin) < load.seconds; ++i) {
        const ServedFile& file = files[i % files.size()];
        const uint64_t length = std::min<uint64_t>(load.range_bytes, file.content.size());
        const uint64_t offset = i * 40503 % (file.content.size() - length + 1);
        const auto asked = Clock::now();
        result.failure = connection.get_range(file.path, offset, length, body);
        if (!result.failure.empty()) return;
        result.latencies.push_back(seconds_since(asked));
        if (std::memcmp(body.data() + connection.body_begin(), file.content.data() + offset, length) != 0) {
            result.failure = file.path + ": wrong bytes";
            return;
        }
        result.bytes += length;
        ++result.answers;
    }
}

}  // namespace

RangeResult load_ranges(const RangeLoad& load, std::span<const ServedFile> files) {
    std::vector<RangeResult> parts(static_cast<size_t>(load.connections));
    const auto begin = Clock::now();
    {
        std::vector<std::jthread> threads;
        for (size_t i = 0; i < parts.size(); ++i)
            threads.emplace_back([&, i] { drive_connection(load, files, 977 * i, parts[i]); });
    }
    RangeResult sum;
    sum.seconds = seconds_since(begin);
    for (const RangeResult& part : parts) {
        sum.bytes += part.bytes;
        sum.answers += part.answers;
        sum.latencies.insert(sum.latencies.end(), part.latencies.begin(), part.latencies.end());
        if (sum.failure.empty()) sum.failure = part.failure;
    }
    return sum;
}

bool wait_for_port(uint16_t port, double seconds) {
    const auto begin = Clock::now();
    while (seconds_since(begin) < seconds) {
        if (Connection(port).open()) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
}

}  // namespace citystream::bench
