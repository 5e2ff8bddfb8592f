// From the parts of a request that matter to the answer's head and body. Pure: no sockets, no clock; the body stays
// where it lies (zero copies).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/site.h"

namespace citystream::server {

enum class Method : uint8_t { kGet, kHead, kOptions, kOther };

/// A request as parsed. Views outlive the call to respond(). A field that is absent is empty.
struct RequestFields {
    Method method = Method::kGet;
    std::string_view target = {};
    std::string_view range = {}, if_range = {}, if_match = {}, if_none_match = {};
    bool http_1_0 = false;
    bool has_host = true;
    bool has_body = false;
    bool keep_alive = true;  ///< what the peer wants; see Response::close for what it gets
};

/// Ready to be written: head, then body (one gather write).
struct Response {
    unsigned status = 200;
    std::string head;
    Representation source;     ///< keeps an owned body alive
    uint64_t body_offset = 0;  ///< of the part of the source to send
    uint64_t body_size = 0;    ///< 0 for HEAD, 204, 304
    bool close = false;
    size_t city = Metrics::kNoCity;  ///< for the metrics

    std::span<const std::byte> body() const { return source.body().subspan(body_offset, body_size); }
};

/// A span of bytes asked for, within a representation.
struct ByteRange {
    uint64_t first = 0, length = 0;
    friend bool operator==(const ByteRange&, const ByteRange&) = default;
};

enum class RangeKind : uint8_t {
    kWhole,  ///< no range, not bytes, malformed, or several ranges: the whole entity is sent (RFC 9110 lets a server
             ///< ignore Range)
    kPart,
    kUnsatisfiable,  ///< begins beyond the end, or asks for the last 0 bytes: 416
};

struct RangeChoice {
    RangeKind kind = RangeKind::kWhole;
    ByteRange part;
};

/// Parses the value of a Range field ("bytes=a-b", "bytes=a-", "bytes=-n") against an entity of `size` bytes. Safe for
/// untrusted input.
RangeChoice choose_range(std::string_view field, uint64_t size);

/// Whether a list of entity tags ("*" or comma-separated) names `etag`. Weak comparison ignores "W/" (If-None-Match),
/// strong refuses it (If-Match).
bool etag_listed(std::string_view field, std::string_view etag, bool weak);

/// The answer to a request. `date`: value of the Date field (IMF-fixdate). `stopping`: the server winds down, so the
/// connection ends after this answer.
Response respond(const RequestFields& request, const Site& site, std::string_view date, bool stopping);

/// The answer to something that is no request, or that cannot be taken now: one line of text, then the connection ends.
Response refuse(unsigned status, std::string_view message, std::string_view date);

/// IMF-fixdate ("Sun, 06 Nov 1994 08:49:37 GMT") of a Unix time.
std::string http_date(int64_t unix_seconds);

}  // namespace citystream::server
