#include "client/load/load_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>

namespace citystream::client {
namespace {

using Json = nlohmann::ordered_json;

double milliseconds(std::chrono::nanoseconds value) {
    return static_cast<double>(value.count()) * 1e-6;
}

Json percentiles(const LatencyHistogram& histogram) {
    return {{"count", histogram.count()},
            {"p50", milliseconds(histogram.percentile(50))},
            {"p90", milliseconds(histogram.percentile(90))},
            {"p99", milliseconds(histogram.percentile(99))},
            {"p99_9", milliseconds(histogram.percentile(99.9))},
            {"max", milliseconds(histogram.max())},
            {"mean", milliseconds(histogram.mean())}};
}

std::string percentile_line(std::string_view name, const LatencyHistogram& histogram) {
    return fmt::format("  {:<24}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}{:>10.2f}{:>12}\n", name,
                       milliseconds(histogram.percentile(50)), milliseconds(histogram.percentile(90)),
                       milliseconds(histogram.percentile(99)), milliseconds(histogram.percentile(99.9)),
                       milliseconds(histogram.max()), histogram.count());
}

double per_second(uint64_t amount, double seconds) {
    return seconds > 0 ? static_cast<double>(amount) / seconds : 0;
}

/// Clients that could not be opened, and requests that failed for good.
uint64_t errors_of(const LoadOutcome& outcome) {
    return outcome.clients_failed + outcome.measured.failed;
}

}  // namespace

double over_fetch_of(const LoadMeasurements& measured) {
    if (measured.drawn_bytes == 0) return 0;
    return static_cast<double>(measured.fetcher.body_bytes) / static_cast<double>(measured.drawn_bytes);
}

std::string load_json(const LoadOutcome& outcome, const LoadOptions& options) {
    const LoadMeasurements& m = outcome.measured;
    const Json document = {{"place", options.client.place},
                           {"clients", options.clients},
                           {"clients_opened", outcome.clients_opened},
                           {"seconds", outcome.elapsed_seconds},
                           {"interrupted", outcome.interrupted},
                           {"tolerance_pixels", options.client.streamer.tolerance_pixels},
                           {"size", {options.client.width, options.client.height}},
                           {"updates_per_second", options.updates_per_second},
                           {"seed", options.seed},
                           {"errors", errors_of(outcome)},
                           {"requests",
                            {{"answered", m.answers},
                             {"failed", m.failed},
                             {"cancelled", m.cancelled},
                             {"retried", m.fetcher.retries},
                             {"unanswered", m.unanswered}}},
                           {"requests_per_second", per_second(m.request.count(), outcome.elapsed_seconds)},
                           {"megabytes_per_second",
                            per_second(m.fetcher.body_bytes + m.fetcher.header_bytes, outcome.elapsed_seconds) * 1e-6},
                           {"bytes",
                            {{"body", m.fetcher.body_bytes},
                             {"header", m.fetcher.header_bytes},
                             {"directory", m.directory_bytes},
                             {"layers", m.layer_bytes},
                             {"drawn", m.drawn_bytes}}},
                           {"over_fetch", over_fetch_of(m)},
                           {"request_ms", percentiles(m.request)},
                           {"service_ms", percentiles(m.service)},
                           {"visible_ms", percentiles(m.visible)},
                           {"open_ms", percentiles(m.opening)},
                           {"lateness_ms", percentiles(m.lateness)},
                           {"tiles",
                            {{"visible", m.tiles_visible},
                             {"abandoned", m.tiles_abandoned},
                             {"unused", m.tiles_unused},
                             {"unfinished", m.tiles_unfinished}}},
                           {"updates", {{"made", m.updates}, {"complete", m.updates_complete}}},
                           {"worst_tolerance_pixels", m.worst_tolerance},
                           {"most_host_bytes", m.most_host_bytes},
                           {"most_gpu_bytes", m.most_gpu_bytes},
                           {"first_error", m.first_error},
                           {"warnings", m.warnings}};
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string load_text(const LoadOutcome& outcome, const LoadOptions& options) {
    const LoadMeasurements& m = outcome.measured;
    const uint64_t bytes = m.fetcher.body_bytes + m.fetcher.header_bytes;
    std::string text = fmt::format("{} of {} clients flew for {:.1f} s{}: {} requests answered, {} errors\n",
                                   outcome.clients_opened, options.clients, outcome.elapsed_seconds,
                                   outcome.interrupted ? " (interrupted)" : "", m.answers, errors_of(outcome));
    text += fmt::format("  {:.1f} requests/s, {:.2f} MB/s, {:.2f} MB received, over-fetch {:.3f}\n",
                        per_second(m.request.count(), outcome.elapsed_seconds),
                        per_second(bytes, outcome.elapsed_seconds) * 1e-6, static_cast<double>(bytes) * 1e-6,
                        over_fetch_of(m));
    text += fmt::format("  {:<24}{:>10}{:>10}{:>10}{:>10}{:>10}{:>12}\n", "milliseconds", "p50", "p90", "p99", "p99.9",
                        "max", "count");
    text += percentile_line("request, as intended", m.request);
    text += percentile_line("request, from sending", m.service);
    text += percentile_line("tile wanted to drawn", m.visible);
    text += percentile_line("opening the city", m.opening);
    text += percentile_line("update begun late by", m.lateness);
    if (m.unanswered + m.tiles_unfinished > 0) {
        text += fmt::format(
            "  at the end {} requests and {} tiles were still awaited (counted with the time they had waited)\n",
            m.unanswered, m.tiles_unfinished);
    }
    if (m.lateness.percentile(99) > std::chrono::milliseconds(100)) {
        text +=
            "  this machine could not keep the schedule: the figures include its own delay (fewer clients, or a lower "
            "--rate)\n";
    }
    for (const auto& warning : m.warnings) text += fmt::format("  warning: {}\n", warning);
    return text;
}

}  // namespace citystream::client
