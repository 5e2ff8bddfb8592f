// A one-connection-at-a-time HTTP server on loopback that misbehaves on request: the other end of the fetcher's tests.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace citystream::client::test {

/// How the next answers go wrong, one after the other; then all is well.
enum class Fault {
    kNone,
    kCloseAtOnce,
    kCloseInBody,
    kWrongRange,
    kShortBody,
    kStatus500,
    kStatus404,
    kGarbage,
    kStall,
    kNoRanges
};

class TinyServer {
  public:
    using Files = std::map<std::string, std::string>;
    explicit TinyServer(Files files) : files_(std::move(files)) { listen_on(0); }
    ~TinyServer() { stop(); }
    TinyServer(const TinyServer&) = delete;
    TinyServer& operator=(const TinyServer&) = delete;

    std::string address() const { return "http://127.0.0.1:" + std::to_string(port_); }
    void stop() {
        running_ = false;
        if (thread_.joinable()) thread_.join();
        if (listener_ >= 0) ::close(listener_);
        listener_ = -1;
    }
    void start_again() { listen_on(port_); }
    void set_faults(std::vector<Fault> faults) {
        const std::lock_guard lock(mutex_);
        faults_ = std::move(faults);
    }
    void always(Fault fault) {
        const std::lock_guard lock(mutex_);
        always_ = fault;
    }
    int connections() const { return connections_; }
    int requests() const { return requests_; }

  private:
    void listen_on(uint16_t port) {
        listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
        const int yes = 1;
        ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        address.sin_port = htons(port);
        if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0) std::perror("bind");
        ::listen(listener_, 64);
        socklen_t size = sizeof(address);
        ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
        port_ = ntohs(address.sin_port);
        running_ = true;
        thread_ = std::thread([this] { work(); });
    }
    /// All connections on one thread: a set of sockets with what each has sent so far.
    void work() {
        std::map<int, std::string> open;
        while (running_) {
            std::vector<pollfd> waiting = {{listener_, POLLIN, 0}};
            for (const auto& [fd, text] : open) waiting.push_back({fd, POLLIN, 0});
            if (::poll(waiting.data(), waiting.size(), 10) <= 0) continue;
            if ((waiting[0].revents & POLLIN) != 0) {
                const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
                if (fd >= 0) open.emplace(fd, "");
                ++connections_;
            }
            for (size_t i = 1; i < waiting.size(); ++i) {
                if (waiting[i].revents == 0) continue;
                const int fd = waiting[i].fd;
                if (!read_and_answer(fd, open[fd])) {
                    ::close(fd);
                    open.erase(fd);
                }
            }
        }
        for (const auto& [fd, text] : open) ::close(fd);
    }
    bool read_and_answer(int fd, std::string& text) {
        char buffer[4096];
        const ssize_t n = ::recv(fd, buffer, sizeof(buffer), 0);
        if (n <= 0) return false;
        text.append(buffer, static_cast<size_t>(n));
        for (size_t end = text.find("\r\n\r\n"); end != std::string::npos; end = text.find("\r\n\r\n")) {
            const std::string head = text.substr(0, end);
            text.erase(0, end + 4);
            if (!answer(fd, head)) return false;
        }
        return true;
    }
    Fault next_fault() {
        const std::lock_guard lock(mutex_);
        if (faults_.empty()) return always_;
        const Fault fault = faults_.front();
        faults_.erase(faults_.begin());
        return fault;
    }
    static bool send_all(int fd, const std::string& bytes) {
        size_t done = 0;
        while (done < bytes.size()) {
            const ssize_t n = ::send(fd, bytes.data() + done, bytes.size() - done, MSG_NOSIGNAL);
            if (n <= 0) return false;
            done += static_cast<size_t>(n);
        }
        return true;
    }
    static std::string head_of(const std::string& status, size_t length, const std::string& more = "") {
        return "HTTP/1.1 " + status + "\r\nContent-Length: " + std::to_string(length) + "\r\n" + more + "\r\n";
    }
    bool answer(int fd, const std::string& head) {
        ++requests_;
        const Fault fault = next_fault();
        const size_t path_end = head.find(' ', 4);
        const std::string path = head.substr(4, path_end - 4);
        const auto file = files_.find(path);
        if (fault == Fault::kCloseAtOnce) return false;
        if (fault == Fault::kGarbage) return send_all(fd, "SSH-2.0-nothing here\r\n\r\n") && false;
        if (fault == Fault::kStall) {
            for (int i = 0; i < 200 && running_; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
            return false;
        }
        if (fault == Fault::kStatus500) return send_all(fd, head_of("500 Internal Server Error", 0));
        if (fault == Fault::kStatus404 || file == files_.end())
            return send_all(fd, head_of("404 Not Found", 4) + "gone");
        const std::string& whole = file->second;
        unsigned long long first = 0, last = 0;
        const size_t range = head.find("Range: bytes=");
        const bool ranged = range != std::string::npos &&
                            std::sscanf(head.c_str() + range, "Range: bytes=%llu-%llu", &first, &last) == 2;
        if (!ranged || fault == Fault::kNoRanges) return send_all(fd, head_of("200 OK", whole.size()) + whole);
        std::string body = whole.substr(first, last - first + 1);
        if (fault == Fault::kWrongRange) ++first, ++last;
        const std::string content = "Content-Range: bytes " + std::to_string(first) + "-" + std::to_string(last) + "/" +
                                    std::to_string(whole.size() + 5) + "\r\n";
        if (fault == Fault::kShortBody) {
            body.resize(body.size() / 2);
            return send_all(fd, head_of("206 Partial Content", body.size(), content) + body);
        }
        const std::string answer_head = head_of("206 Partial Content", body.size(), content);
        if (fault == Fault::kCloseInBody) return send_all(fd, answer_head + body.substr(0, body.size() / 2)) && false;
        return send_all(fd, answer_head + body);
    }

    Files files_;
    int listener_ = -1;
    uint16_t port_ = 0;
    std::atomic<bool> running_ = false;
    std::atomic<int> connections_ = 0, requests_ = 0;
    std::mutex mutex_;
    std::vector<Fault> faults_;
    Fault always_ = Fault::kNone;
    std::thread thread_;
};

}  // namespace citystream::client::test
