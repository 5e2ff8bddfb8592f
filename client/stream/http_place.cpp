#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>

#include "client/stream/http_fetcher.h"

namespace citystream::client {
namespace {

constexpr std::string_view kScheme = "http://";

/// Characters that would break the request line or hide another path.
bool is_clean(std::string_view text) {
    return std::none_of(text.begin(), text.end(),
                        [](char c) { return c <= ' ' || c == '"' || c == '\\' || c == 0x7f || c == '#' || c == '?'; });
}

Result<uint64_t> take_number(std::string_view& text) {
    uint64_t value = 0;
    const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (status != std::errc{}) return Error{"no number"};
    text.remove_prefix(static_cast<size_t>(end - text.data()));
    return value;
}

bool take(std::string_view& text, std::string_view prefix) {
    if (!text.starts_with(prefix)) return false;
    text.remove_prefix(prefix.size());
    return true;
}

std::string folder_of(std::string path) {
    constexpr std::string_view kTileset = "/tileset.json";
    if (path.ends_with(kTileset)) path.resize(path.size() - kTileset.size() + 1);
    if (!path.ends_with('/')) path += '/';
    return path;
}

}  // namespace

Result<HttpPlace> parse_http_place(const std::string& url) {
    if (!url.starts_with(kScheme)) return Error{url + ": not an http:// address"};
    const std::string rest = url.substr(kScheme.size());
    const size_t slash = std::min(rest.find('/'), rest.size());
    const std::string authority = rest.substr(0, slash);
    const std::string path = rest.substr(slash);
    if (!is_clean(authority) || !is_clean(path) || authority.find('@') != std::string::npos) {
        return Error{url + ": not a plain http://host:port/path address"};
    }
    HttpPlace place;
    const size_t bracket = authority.starts_with('[') ? authority.find(']') : 0;
    if (bracket == std::string::npos) return Error{url + ": the bracket of the address is not closed"};
    const size_t colon = authority.find(':', bracket);
    place.host = authority.substr(0, colon);
    place.port = colon == std::string::npos ? "80" : authority.substr(colon + 1);
    std::string_view port = place.port;
    const Result<uint64_t> number = take_number(port);
    if (place.host.empty()) return Error{url + ": no host name"};
    if (!number || !port.empty() || *number == 0 || *number > 65535) return Error{url + ": bad port number"};
    place.has_path = path.size() > 1;
    place.base = folder_of(path.empty() ? "/" : path);
    return place;
}

Result<ContentRange> parse_content_range(const std::string& value) {
    const Error bad{"bad Content-Range \"" + value.substr(0, 60) + "\""};
    std::string_view text = value;
    ContentRange range;
    if (!take(text, "bytes ")) return bad;
    const Result<uint64_t> first = take_number(text);
    if (!first || !take(text, "-")) return bad;
    const Result<uint64_t> last = take_number(text);
    if (!last || !take(text, "/") || *last < *first) return bad;
    range.first = *first;
    range.last = *last;
    if (text == "*") return range;
    const Result<uint64_t> total = take_number(text);
    if (!total || !text.empty() || *total <= *last) return bad;
    range.total = *total;
    return range;
}

Result<std::vector<ListedCity>> parse_city_list(const std::vector<std::byte>& json) {
    const auto* begin = reinterpret_cast<const char*>(json.data());
    const nlohmann::json document = nlohmann::json::parse(begin, begin + json.size(), nullptr, false);
    const nlohmann::json* list = document.is_array() ? &document : nullptr;
    if (document.is_object() && document.contains("cities")) list = &document["cities"];
    if (list == nullptr || !list->is_array()) return Error{"the server's list of cities is not understood"};
    std::vector<ListedCity> cities;
    for (const nlohmann::json& item : *list) {
        if (!item.is_object()) continue;
        const auto tileset = item.find("tileset");
        if (tileset == item.end() || !tileset->is_string()) continue;
        const std::string path = tileset->get<std::string>();
        if (!path.starts_with('/') || !is_clean(path)) continue;
        const auto name = item.find("name");
        const bool named = name != item.end() && name->is_string();
        cities.push_back({named ? name->get<std::string>() : path, folder_of(path)});
    }
    return cities;
}

}  // namespace citystream::client
