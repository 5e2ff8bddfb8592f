// A client made of nothing but sockets: it sends exactly the bytes a test wants and splits answers by hand.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace citystream::server::test {

struct RawAnswer {
    int status = 0;
    std::string head, body;

    /// A field's value, or nothing.
    std::optional<std::string> field(std::string_view name) const {
        const auto lower = [](std::string text) {
            std::transform(text.begin(), text.end(), text.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
            return text;
        };
        const std::string wanted = "\r\n" + lower(std::string(name)) + ": ";
        const size_t at = lower(head).find(wanted);
        if (at == std::string::npos) return std::nullopt;
        const size_t begin = at + wanted.size();
        return head.substr(begin, head.find("\r\n", begin) - begin);
    }
};

class RawClient {
  public:
    explicit RawClient(uint16_t port, int receive_buffer = 0) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
        if (receive_buffer > 0) ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    }
    ~RawClient() { ::close(socket_); }
    RawClient(const RawClient&) = delete;
    RawClient& operator=(const RawClient&) = delete;

    bool connected() const { return connected_; }

    bool send(std::string_view text) {
        while (!text.empty()) {
            const ssize_t sent = ::send(socket_, text.data(), text.size(), MSG_NOSIGNAL);
            if (sent <= 0) return false;
            text.remove_prefix(static_cast<size_t>(sent));
        }
        return true;
    }
    void get(std::string_view target, std::string_view fields = {}, std::string_view method = "GET") {
        send(std::string(method) + " " + std::string(target) + " HTTP/1.1\r\nHost: test\r\n" + std::string(fields) +
             "\r\n");
    }

    /// Waits for one answer. status 0: the connection ended or 10 s passed. `head_only`: to a HEAD request.
    RawAnswer answer(bool head_only = false) {
        RawAnswer result;
        size_t end;
        while ((end = received_.find("\r\n\r\n")) == std::string::npos) {
            if (!receive()) return result;
        }
        result.head = received_.substr(0, end + 2);
        received_.erase(0, end + 4);
        size_t length = 0;
        if (const auto field = result.field("Content-Length"); field && !head_only) length = std::stoul(*field);
        while (received_.size() < length) {
            if (!receive()) return result;
        }
        result.body = received_.substr(0, length);
        received_.erase(0, length);
        result.status = std::stoi(result.head.substr(9, 3));
        return result;
    }
    RawAnswer ask(std::string_view target, std::string_view fields = {}, std::string_view method = "GET") {
        get(target, fields, method);
        return answer(method == "HEAD");
    }

    /// Whether the server ends the connection within the time, without sending anything more.
    bool ended_within(std::chrono::milliseconds time) {
        if (!received_.empty()) return false;
        return !receive(static_cast<int>(time.count())) && ended_;
    }

  private:
    bool receive(int timeout_ms = 10'000) {
        pollfd waiting{socket_, POLLIN, 0};
        if (::poll(&waiting, 1, timeout_ms) <= 0) return false;
        char bytes[65536];
        const ssize_t count = ::recv(socket_, bytes, sizeof bytes, 0);
        if (count <= 0) {
            ended_ = true;
            return false;
        }
        received_.append(bytes, static_cast<size_t>(count));
        return true;
    }

    int socket_;
    bool connected_ = false, ended_ = false;
    std::string received_;
};

}  // namespace citystream::server::test
