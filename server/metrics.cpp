#include "server/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string_view>

namespace citystream::server {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;
constexpr const char* kNoCityLabel = "";

void write_family(std::string& out, std::string_view name, std::string_view type, std::string_view help) {
    fmt::format_to(std::back_inserter(out), "# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
}

void write_plain(std::string& out, std::string_view name, std::string_view type, std::string_view help,
                 uint64_t value) {
    write_family(out, name, type, help);
    fmt::format_to(std::back_inserter(out), "{} {}\n", name, value);
}

}  // namespace

Metrics::Metrics(std::vector<CityLabel> cities) : started_(std::time(nullptr)) {
    for (auto& label : cities) {
        cities_.push_back(std::make_unique<PerCity>());
        cities_.back()->label = std::move(label);
    }
    cities_.push_back(std::make_unique<PerCity>());
    cities_.back()->label.name = kNoCityLabel;
}

void Metrics::count_request(size_t city, unsigned status, uint64_t body_bytes, uint64_t sent_bytes, double seconds) {
    PerCity& counters = *cities_[std::min(city, cities_.size() - 1)];
    counters.by_class[std::clamp(status / 100, 1u, 5u) - 1].fetch_add(1, kRelaxed);
    counters.body_bytes.fetch_add(body_bytes, kRelaxed);
    if (status == 206) counters.partial.fetch_add(1, kRelaxed);
    if (status == 304) counters.not_modified.fetch_add(1, kRelaxed);
    sent_bytes_.fetch_add(sent_bytes, kRelaxed);

    const auto bucket =
        std::lower_bound(kLatencyBounds.begin(), kLatencyBounds.end(), seconds) - kLatencyBounds.begin();
    latency_[static_cast<size_t>(bucket)].fetch_add(1, kRelaxed);
    latency_microseconds_.fetch_add(static_cast<uint64_t>(std::max(seconds, 0.0) * 1e6), kRelaxed);
    requests_finished_.fetch_add(1, kRelaxed);
}

void Metrics::connection_opened() {
    connections_open_.fetch_add(1, kRelaxed);
    connections_total_.fetch_add(1, kRelaxed);
}
void Metrics::connection_closed() {
    connections_open_.fetch_sub(1, kRelaxed);
}
void Metrics::connection_refused() {
    connections_refused_.fetch_add(1, kRelaxed);
}
void Metrics::request_started() {
    requests_started_.fetch_add(1, kRelaxed);
}
void Metrics::request_timed_out() {
    timeouts_.fetch_add(1, kRelaxed);
}
void Metrics::answer_broken_off() {
    broken_off_.fetch_add(1, kRelaxed);
}

uint64_t Metrics::requests() const {
    return requests_finished_.load(kRelaxed);
}
uint64_t Metrics::sent_bytes() const {
    return sent_bytes_.load(kRelaxed);
}

void Metrics::write_per_city(std::string& out) const {
    auto line = std::back_inserter(out);
    write_family(out, "citystream_requests_total", "counter",
                 "Answered requests by city and status class; city \"\" is everything outside a city.");
    for (const auto& city : cities_) {
        for (size_t i = 1; i < city->by_class.size(); ++i) {
            fmt::format_to(line, "citystream_requests_total{{city=\"{}\",class=\"{}xx\"}} {}\n", city->label.name,
                           i + 1, city->by_class[i].load(kRelaxed));
        }
    }
    const auto write_counter = [&](std::string_view name, std::string_view help, Counter PerCity::*counter) {
        write_family(out, name, "counter", help);
        for (const auto& city : cities_) {
            fmt::format_to(line, "{}{{city=\"{}\"}} {}\n", name, city->label.name, ((*city).*counter).load(kRelaxed));
        }
    };
    write_counter("citystream_body_bytes_total", "Bytes of bodies sent.", &PerCity::body_bytes);
    write_counter("citystream_partial_answers_total", "Range requests answered with 206.", &PerCity::partial);
    write_counter("citystream_not_modified_answers_total", "Conditional requests answered with 304.",
                  &PerCity::not_modified);
    write_family(out, "citystream_archive_bytes", "gauge", "Size of each served archive.");
    for (size_t i = 0; i + 1 < cities_.size(); ++i) {
        fmt::format_to(line, "citystream_archive_bytes{{city=\"{}\"}} {}\n", cities_[i]->label.name,
                       cities_[i]->label.archive_bytes);
    }
}

void Metrics::write_connections(std::string& out) const {
    write_plain(out, "citystream_sent_bytes_total", "counter", "Bytes sent, heads and bodies.",
                sent_bytes_.load(kRelaxed));
    write_plain(out, "citystream_connections_open", "gauge", "Connections open now.", connections_open_.load(kRelaxed));
    write_plain(out, "citystream_connections_total", "counter", "Connections accepted.",
                connections_total_.load(kRelaxed));
    write_plain(out, "citystream_connections_refused_total", "counter",
                "Connections answered with 503 because too many were open.", connections_refused_.load(kRelaxed));
    const uint64_t finished = requests_finished_.load(kRelaxed) + broken_off_.load(kRelaxed);
    const uint64_t started = requests_started_.load(kRelaxed);
    write_plain(out, "citystream_requests_in_flight", "gauge", "Requests being answered now.",
                started > finished ? started - finished : 0);
    write_plain(out, "citystream_timeouts_total", "counter",
                "Connections closed because a head or an answer made no progress in time.", timeouts_.load(kRelaxed));
    write_plain(out, "citystream_answers_broken_off_total", "counter", "Answers that the peer did not take to the end.",
                broken_off_.load(kRelaxed));
    write_plain(out, "citystream_start_time_seconds", "gauge", "When the server started, in Unix time.",
                static_cast<uint64_t>(started_));
}

void Metrics::write_latency(std::string& out) const {
    constexpr std::string_view kName = "citystream_request_duration_seconds";
    auto line = std::back_inserter(out);
    write_family(out, kName, "histogram", "From a request's head to the last byte of its answer handed to the kernel.");
    uint64_t cumulative = 0;
    for (size_t i = 0; i < kLatencyBounds.size(); ++i) {
        cumulative += latency_[i].load(kRelaxed);
        fmt::format_to(line, "{}_bucket{{le=\"{}\"}} {}\n", kName, kLatencyBounds[i], cumulative);
    }
    cumulative += latency_.back().load(kRelaxed);
    fmt::format_to(line, "{}_bucket{{le=\"+Inf\"}} {}\n", kName, cumulative);
    fmt::format_to(line, "{}_sum {:.6f}\n", kName, static_cast<double>(latency_microseconds_.load(kRelaxed)) * 1e-6);
    fmt::format_to(line, "{}_count {}\n", kName, cumulative);
}

std::string Metrics::text() const {
    std::string out;
    write_per_city(out);
    write_connections(out);
    write_latency(out);
    return out;
}

}  // namespace citystream::server
