// From the target of a request line to what it names: a pure function, the only place where a URL's text is
// interpreted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "codec/result.h"

namespace citystream::server {

enum class TargetKind : uint8_t {
    kIndex,         ///< "/"
    kHealth,        ///< "/healthz"
    kMetrics,       ///< "/metrics"
    kCities,        ///< "/cities.json"
    kCityRedirect,  ///< "/NAME": answered with a redirect to "/NAME/"
    kCityPage,      ///< "/NAME/"
    kEntry,         ///< "/NAME/ENTRY": an entry of the city's archive
};

struct HttpTarget {
    TargetKind kind = TargetKind::kIndex;
    std::string city;   ///< decoded; set for the last three kinds
    std::string entry;  ///< decoded, '/'-separated; set for kEntry
    friend bool operator==(const HttpTarget&, const HttpTarget&) = default;
};

/// Longest target that is looked at (a longer one is answered with 414).
inline constexpr size_t kMaxTargetBytes = 4096;

/// First path segments with a meaning of their own: no city may have such a name.
bool is_reserved_name(std::string_view name);

/// Accepts origin-form ("/a/b?query") and absolute-form ("http://host/a/b"); the query is ignored. Percent escapes are
/// decoded once. Refused, with what is wrong and where: anything else, bad escapes, control characters and NUL,
/// backslashes, encoded slashes, bytes that are not well-formed UTF-8 (overlong forms), the segments "." and "..",
/// empty segments ("//"), fragments. Hence `city` and `entry` never begin with '/', never hold "..", and name nothing
/// but an archive's entry. Safe for untrusted input; O(length).
Result<HttpTarget> parse_http_target(std::string_view target);

}  // namespace citystream::server
