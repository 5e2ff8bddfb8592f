// Reading what people type: addresses and durations.
#include <charconv>
#include <cmath>
#include <string_view>

#include "server/server.h"

namespace citystream::server {
namespace {

Result<uint16_t> parse_port(std::string_view text) {
    uint16_t port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (text.empty() || error != std::errc() || end != text.data() + text.size()) {
        return Error{"'" + std::string(text) + "' is no port number (0 to 65535)"};
    }
    return port;
}

}  // namespace

Result<ListenAddress> ListenAddress::parse(const std::string& text) {
    ListenAddress address;
    const size_t colon = text.rfind(':');
    const size_t bracket = text.rfind(']');
    std::string_view port_text = text;
    if (colon != std::string::npos && (bracket == std::string::npos || colon > bracket)) {
        address.host = text.substr(0, colon);
        port_text.remove_prefix(colon + 1);
        if (address.host.empty()) address.host = "0.0.0.0";
    }
    const bool bracketed = address.host.size() > 2 && address.host.front() == '[' && address.host.back() == ']';
    if (bracketed) address.host = address.host.substr(1, address.host.size() - 2);
    if (!bracketed && address.host.find(':') != std::string::npos) {
        return Error{"'" + text + "' is no address: write an IPv6 address in brackets, as in [::1]:8080"};
    }
    const auto port = parse_port(port_text);
    if (!port) return Error{"'" + text + "' is no address like 127.0.0.1:8080: " + port.error().message};
    address.port = *port;
    return address;
}

Result<std::chrono::milliseconds> parse_duration(const std::string& text) {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const std::string_view unit(end, static_cast<size_t>(text.data() + text.size() - end));
    double scale = 0;
    if (unit == "ms") scale = 1;
    if (unit == "s" || unit.empty()) scale = 1000;
    if (unit == "m" || unit == "min") scale = 60'000;
    const double milliseconds = number * scale;
    if (error != std::errc() || scale == 0 || !(milliseconds >= 1) || !(milliseconds <= 86'400'000)) {
        return Error{"'" + text + "' is no duration between 1ms and a day, like 30s, 500ms or 2m"};
    }
    return std::chrono::milliseconds(std::llround(milliseconds));
}

}  // namespace citystream::server
