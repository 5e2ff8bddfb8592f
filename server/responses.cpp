#include "server/responses.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <ctime>
#include <iterator>
#include <utility>

namespace citystream::server {
namespace {

constexpr std::string_view kAllow = "GET, HEAD, OPTIONS";
constexpr std::string_view kBlanks = " \t";

std::string_view trimmed(std::string_view text) {
    const size_t begin = std::min(text.find_first_not_of(kBlanks), text.size());
    text.remove_prefix(begin);
    return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

/// Digits only; numbers beyond 64 bits become the largest one, which is beyond the end of everything.
std::optional<uint64_t> parse_number(std::string_view text) {
    if (text.empty() || !std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; }))
        return std::nullopt;
    uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc::result_out_of_range ? ~uint64_t{0} : value;
}

/// Range units are named without regard to case.
bool is_bytes_unit(std::string_view unit) {
    constexpr std::string_view kBytes = "bytes";
    return std::equal(unit.begin(), unit.end(), kBytes.begin(), kBytes.end(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? static_cast<char>(a + 32) : a) == b; });
}

std::string_view reason_of(unsigned status) {
    switch (status) {
        case 200:
            return "OK";
        case 204:
            return "No Content";
        case 206:
            return "Partial Content";
        case 304:
            return "Not Modified";
        case 308:
            return "Permanent Redirect";
        case 400:
            return "Bad Request";
        case 404:
            return "Not Found";
        case 405:
            return "Method Not Allowed";
        case 408:
            return "Request Timeout";
        case 412:
            return "Precondition Failed";
        case 413:
            return "Content Too Large";
        case 414:
            return "URI Too Long";
        case 416:
            return "Range Not Satisfiable";
        case 431:
            return "Request Header Fields Too Large";
        case 503:
            return "Service Unavailable";
        case 505:
            return "HTTP Version Not Supported";
        default:
            return "Status";
    }
}

std::string_view cache_control_of(CachePolicy policy) {
    switch (policy) {
        case CachePolicy::kImmutable:
            return "public, max-age=31536000, immutable";
        case CachePolicy::kRevalidate:
            return "public, max-age=0, must-revalidate";
        case CachePolicy::kNone:
            break;
    }
    return "no-store";
}

/// Builds the text of an answer's head, field by field.
class Head {
  public:
    Head(unsigned status, std::string_view date) {
        text_.reserve(640);
        fmt::format_to(std::back_inserter(text_), "HTTP/1.1 {} {}\r\nServer: citystream\r\nDate: {}\r\n", status,
                       reason_of(status), date);
        add("Access-Control-Allow-Origin", "*");
        add("Access-Control-Expose-Headers", "Accept-Ranges, Content-Length, Content-Range, ETag");
        add("Cross-Origin-Resource-Policy", "cross-origin");
        add("X-Content-Type-Options", "nosniff");
    }
    template <typename Value>
    void add(std::string_view name, const Value& value) {
        fmt::format_to(std::back_inserter(text_), "{}: {}\r\n", name, value);
    }
    std::string finish() && {
        text_ += "\r\n";
        return std::move(text_);
    }

  private:
    std::string text_;
};

void add_connection(Head& head, const RequestFields& request, bool close) {
    if (close) {
        head.add("Connection", "close");
    } else if (request.http_1_0) {
        head.add("Connection", "keep-alive");
    }
}

/// Fields that describe the representation and go with 200, 206 and 304 alike.
void add_validators(Head& head, const Representation& source) {
    if (!source.etag.empty()) head.add("ETag", source.etag);
    head.add("Cache-Control", cache_control_of(source.cache));
    if (source.ranges) head.add("Accept-Ranges", "bytes");
}

struct Context {
    const RequestFields& request;
    std::string_view date;
    bool close;
};

Response answer_with_line(const Context& context, unsigned status, std::string_view message,
                          std::string_view extra_name = {}, std::string_view extra_value = {}) {
    Response response;
    response.status = status;
    response.close = context.close;
    response.source.owned = fmt::format("{}\n", message);
    Head head(status, context.date);
    head.add("Content-Type", "text/plain; charset=utf-8");
    head.add("Content-Length", response.source.owned.size());
    head.add("Cache-Control", cache_control_of(CachePolicy::kNone));
    if (!extra_name.empty()) head.add(extra_name, extra_value);
    add_connection(head, context.request, context.close);
    response.head = std::move(head).finish();
    if (context.request.method != Method::kHead) response.body_size = response.source.owned.size();
    return response;
}

Response answer_preflight(const Context& context) {
    Response response;
    response.status = 204;
    response.close = context.close;
    Head head(204, context.date);
    head.add("Allow", kAllow);
    head.add("Access-Control-Allow-Methods", kAllow);
    head.add("Access-Control-Allow-Headers", "Range, If-Range, If-Match, If-None-Match");
    head.add("Access-Control-Max-Age", 86400);
    add_connection(head, context.request, context.close);
    response.head = std::move(head).finish();
    return response;
}

Response answer_not_modified(const Context& context, const Representation& source) {
    Response response;
    response.status = 304;
    response.close = context.close;
    Head head(304, context.date);
    add_validators(head, source);
    add_connection(head, context.request, context.close);
    response.head = std::move(head).finish();
    return response;
}

/// 200 or 206.
Response answer_with_bytes(const Context& context, Representation source, const RangeChoice& range) {
    const uint64_t size = source.body().size();
    const ByteRange part = range.kind == RangeKind::kPart ? range.part : ByteRange{0, size};
    Response response;
    response.status = range.kind == RangeKind::kPart ? 206 : 200;
    response.close = context.close;
    Head head(response.status, context.date);
    head.add("Content-Type", source.content_type);
    head.add("Content-Length", part.length);
    if (response.status == 206)
        head.add("Content-Range", fmt::format("bytes {}-{}/{}", part.first, part.first + part.length - 1, size));
    add_validators(head, source);
    if (source.content_type.starts_with("text/html")) {
        head.add("Content-Security-Policy", "default-src 'none'; img-src 'self'; style-src 'unsafe-inline'");
    }
    add_connection(head, context.request, context.close);
    response.head = std::move(head).finish();
    response.body_offset = part.first;
    response.body_size = context.request.method == Method::kHead ? 0 : part.length;
    response.source = std::move(source);
    return response;
}

/// Conditions and ranges in the order of RFC 9110 section 13.2.2.
Response answer_representation(const Context& context, Representation source) {
    const RequestFields& request = context.request;
    if (!request.if_match.empty() && !etag_listed(request.if_match, source.etag, false)) {
        return answer_with_line(context, 412, "the entry is another one than If-Match names");
    }
    if (!request.if_none_match.empty() && !source.etag.empty() &&
        etag_listed(request.if_none_match, source.etag, true)) {
        return answer_not_modified(context, source);
    }
    RangeChoice range;
    const bool same_entity =
        request.if_range.empty() || (!source.etag.empty() && trimmed(request.if_range) == source.etag);
    if (source.ranges && request.method == Method::kGet && same_entity) {
        range = choose_range(request.range, source.body().size());
    }
    if (range.kind == RangeKind::kUnsatisfiable) {
        const std::string content_range = fmt::format("bytes */{}", source.body().size());
        return answer_with_line(context, 416, fmt::format("the entry has only {} bytes", source.body().size()),
                                "Content-Range", content_range);
    }
    return answer_with_bytes(context, std::move(source), range);
}

Response answer_target(const Context& context, const Site& site) {
    const auto target = parse_http_target(context.request.target);
    if (!target) return answer_with_line(context, 400, target.error().text());
    Lookup lookup = site.find(*target);
    Response response;
    if (auto* source = std::get_if<Representation>(&lookup.what)) {
        response = answer_representation(context, std::move(*source));
    } else if (const auto* redirect = std::get_if<Redirect>(&lookup.what)) {
        response = answer_with_line(context, 308, "the city's page is at " + redirect->location, "Location",
                                    redirect->location);
    } else {
        response = answer_with_line(context, 404, std::get<NotFound>(lookup.what).message);
    }
    response.city = lookup.city;
    return response;
}

}  // namespace

RangeChoice choose_range(std::string_view field, uint64_t size) {
    field = trimmed(field);
    const size_t equals = field.find('=');
    if (equals == std::string_view::npos || !is_bytes_unit(trimmed(field.substr(0, equals)))) return {};
    const std::string_view spec = trimmed(field.substr(equals + 1));
    const size_t dash = spec.find('-');
    if (dash == std::string_view::npos || spec.find(',') != std::string_view::npos) return {};
    const std::string_view first_text = spec.substr(0, dash), last_text = spec.substr(dash + 1);
    const auto first = parse_number(first_text), last = parse_number(last_text);

    if (first_text.empty()) {
        if (!last) return {};
        const uint64_t length = std::min(*last, size);
        if (length == 0) return {RangeKind::kUnsatisfiable, {}};
        return {RangeKind::kPart, {size - length, length}};
    }
    if (!first || (!last && !last_text.empty()) || (last && *last < *first)) return {};
    if (*first >= size) return {RangeKind::kUnsatisfiable, {}};
    const uint64_t end = last ? std::min(*last, size - 1) + 1 : size;
    return {RangeKind::kPart, {*first, end - *first}};
}

bool etag_listed(std::string_view field, std::string_view etag, bool weak) {
    field = trimmed(field);
    if (field == "*") return true;
    if (etag.empty()) return false;
    while (!field.empty()) {
        const size_t comma = std::min(field.find(','), field.size());
        std::string_view item = trimmed(field.substr(0, comma));
        if (weak && item.starts_with("W/")) item.remove_prefix(2);
        if (item == etag) return true;
        field.remove_prefix(std::min(comma + 1, field.size()));
    }
    return false;
}

Response respond(const RequestFields& request, const Site& site, std::string_view date, bool stopping) {
    Context context{request, date, stopping || !request.keep_alive};
    if (request.has_body) {
        // The body is never read, so what follows it on this connection cannot be told from it.
        context.close = true;
        if (request.method != Method::kOther)
            return answer_with_line(context, 413, "this server takes no request bodies");
    }
    if (!request.http_1_0 && !request.has_host)
        return answer_with_line(context, 400, "an HTTP/1.1 request needs one Host field");
    if (request.method == Method::kOther)
        return answer_with_line(context, 405, "only GET, HEAD and OPTIONS are answered", "Allow", kAllow);
    if (request.target.size() > kMaxTargetBytes)
        return answer_with_line(context, 414, "the request target is too long");
    if (request.method == Method::kOptions) return answer_preflight(context);
    return answer_target(context, site);
}

Response refuse(unsigned status, std::string_view message, std::string_view date) {
    const RequestFields request;
    const Context context{request, date, true};
    if (status == 503) return answer_with_line(context, status, message, "Retry-After", "2");
    return answer_with_line(context, status, message);
}

std::string http_date(int64_t unix_seconds) {
    static constexpr std::array<const char*, 7> kDays = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
    static constexpr std::array<const char*, 12> kMonths = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                                            "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    const auto time = static_cast<std::time_t>(unix_seconds);
    std::tm parts{};
    gmtime_r(&time, &parts);
    return fmt::format("{}, {:02} {} {} {:02}:{:02}:{:02} GMT", kDays[static_cast<size_t>(parts.tm_wday)],
                       parts.tm_mday, kMonths[static_cast<size_t>(parts.tm_mon)], 1900 + parts.tm_year, parts.tm_hour,
                       parts.tm_min, parts.tm_sec);
}

}  // namespace citystream::server
