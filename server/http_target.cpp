#include "server/http_target.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace citystream::server {
namespace {

constexpr std::array<std::string_view, 3> kReservedNames = {"healthz", "metrics", "cities.json"};

std::optional<unsigned> hex_digit(char c) {
    if (c >= '0' && c <= '9') return static_cast<unsigned>(c - '0');
    if (c >= 'a' && c <= 'f') return static_cast<unsigned>(c - 'a' + 10);
    if (c >= 'A' && c <= 'F') return static_cast<unsigned>(c - 'A' + 10);
    return std::nullopt;
}

bool starts_with_ignoring_case(std::string_view text, std::string_view prefix) {
    if (text.size() < prefix.size()) return false;
    return std::equal(prefix.begin(), prefix.end(), text.begin(),
                      [](char a, char b) { return a == (b >= 'A' && b <= 'Z' ? static_cast<char>(b + 32) : b); });
}

/// Length of the well-formed UTF-8 sequence at the front of `text` (RFC 3629: no overlong forms, no surrogates), or 0.
size_t utf8_sequence_length(std::string_view text) {
    const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
    const auto continues = [&](size_t i, unsigned low = 0x80, unsigned high = 0xBF) {
        return byte(i) >= low && byte(i) <= high;
    };
    const unsigned lead = byte(0);
    if (lead < 0x80) return 1;
    if (lead >= 0xC2 && lead <= 0xDF) return continues(1) ? 2 : 0;
    if (lead >= 0xE0 && lead <= 0xEF) {
        const unsigned low = lead == 0xE0 ? 0xA0 : 0x80;
        const unsigned high = lead == 0xED ? 0x9F : 0xBF;
        return continues(1, low, high) && continues(2) ? 3 : 0;
    }
    if (lead >= 0xF0 && lead <= 0xF4) {
        const unsigned low = lead == 0xF0 ? 0x90 : 0x80;
        const unsigned high = lead == 0xF4 ? 0x8F : 0xBF;
        return continues(1, low, high) && continues(2) && continues(3) ? 4 : 0;
    }
    return 0;
}

std::optional<Error> check_segment(std::string_view segment, uint64_t offset) {
    if (segment == "." || segment == "..") return Error{"a path may not hold the segment '.' or '..'", offset};
    for (size_t i = 0; i < segment.size();) {
        const auto c = static_cast<unsigned char>(segment[i]);
        if (c < 0x20 || c == 0x7F) return Error{"a path may not hold a control character", offset};
        if (c == '\\') return Error{"a path may not hold a backslash", offset};
        if (c == '/') return Error{"a path may not hold an encoded slash", offset};
        const size_t length = utf8_sequence_length(segment.substr(i));
        if (length == 0) return Error{"a path must be well-formed UTF-8", offset};
        i += length;
    }
    return std::nullopt;
}

/// Percent-decodes one segment and checks it. `offset` is where it begins in the target.
Result<std::string> decode_segment(std::string_view raw, uint64_t offset) {
    std::string decoded;
    decoded.reserve(raw.size());
    for (size_t i = 0; i < raw.size(); ++i) {
        if (raw[i] != '%') {
            decoded += raw[i];
            continue;
        }
        const auto high = i + 1 < raw.size() ? hex_digit(raw[i + 1]) : std::nullopt;
        const auto low = i + 2 < raw.size() ? hex_digit(raw[i + 2]) : std::nullopt;
        if (!high || !low) return Error{"a percent sign must be followed by two hexadecimal digits", offset + i};
        decoded += static_cast<char>(*high << 4 | *low);
        i += 2;
    }
    if (auto error = check_segment(decoded, offset)) return *error;
    return decoded;
}

/// The path of the target: without scheme, authority and query. Empty when the form is none that a server of files
/// answers.
std::string_view path_of(std::string_view target) {
    for (const std::string_view scheme : {"http://", "https://"}) {
        if (!starts_with_ignoring_case(target, scheme)) continue;
        const size_t slash = target.find_first_of("/?", scheme.size());
        if (slash == std::string_view::npos || target[slash] == '?') return "/";
        target.remove_prefix(slash);
        break;
    }
    return target.substr(0, target.find('?'));
}

Result<std::vector<std::string>> decode_segments(std::string_view path) {
    std::vector<std::string> segments;
    size_t begin = 1;
    for (;;) {
        const size_t end = std::min(path.find('/', begin), path.size());
        if (end == begin && end < path.size()) return Error{"a path may not hold an empty segment ('//')", begin};
        auto segment = decode_segment(path.substr(begin, end - begin), begin);
        if (!segment) return segment.error();
        segments.push_back(std::move(*segment));
        if (end == path.size()) return segments;
        begin = end + 1;
    }
}

TargetKind reserved_kind(std::string_view name) {
    if (name == kReservedNames[0]) return TargetKind::kHealth;
    if (name == kReservedNames[1]) return TargetKind::kMetrics;
    return TargetKind::kCities;
}

}  // namespace

bool is_reserved_name(std::string_view name) {
    return std::find(kReservedNames.begin(), kReservedNames.end(), name) != kReservedNames.end();
}

Result<HttpTarget> parse_http_target(std::string_view target) {
    if (target.size() > kMaxTargetBytes) return Error{"the request target is too long", kMaxTargetBytes};
    const std::string_view path = path_of(target);
    if (path.empty() || path.front() != '/') return Error{"the request target must begin with '/'", 0};
    if (path.find('#') != std::string_view::npos) return Error{"a path may not hold '#'", path.find('#')};

    auto segments = decode_segments(path);
    if (!segments) return segments.error();

    HttpTarget result;
    std::string& first = segments->front();
    if (segments->size() == 1) {
        if (first.empty()) return result;
        if (is_reserved_name(first)) {
            result.kind = reserved_kind(first);
            return result;
        }
        result.kind = TargetKind::kCityRedirect;
    } else {
        const bool only_name = segments->size() == 2 && segments->back().empty();
        result.kind = only_name ? TargetKind::kCityPage : TargetKind::kEntry;
    }
    result.city = std::move(first);
    if (result.kind != TargetKind::kEntry) return result;
    for (size_t i = 1; i < segments->size(); ++i) {
        if (i > 1) result.entry += '/';
        result.entry += (*segments)[i];
    }
    return result;
}

}  // namespace citystream::server
