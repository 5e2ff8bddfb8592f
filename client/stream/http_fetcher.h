// HTTP/1.1 byte ranges over keep-alive connections: our own server, or any static one.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/stream/fetcher.h"

namespace citystream::client {

/// A place on the network, taken apart. `base` ends with '/': request paths are appended to it.
struct HttpPlace {
    std::string host, port;
    std::string base;
    bool has_path = false;  ///< false for "http://host:port" alone: the server's list says what is there
    /// "http://host:port/base"
    std::string text() const { return "http://" + host + ":" + port + base; }
};
Result<HttpPlace> parse_http_place(const std::string& url);

/// First and last byte and the total of "bytes 5-9/100"; total is absent for "*".
struct ContentRange {
    uint64_t first = 0, last = 0;
    std::optional<uint64_t> total;
};
Result<ContentRange> parse_content_range(const std::string& value);

/// What the server's /cities.json lists: name and the folder of its tileset.
struct ListedCity {
    std::string name, base;
};
Result<std::vector<ListedCity>> parse_city_list(const std::vector<std::byte>& json);

Result<std::unique_ptr<Fetcher>> open_http_fetcher(const std::string& url, const FetcherOptions& options);

}  // namespace citystream::client
