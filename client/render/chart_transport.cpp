#include "client/render/chart_transport.h"

namespace citystream::client {
namespace {

// In the order of the numbers.
constexpr std::array<std::string_view, kChartTransports.size()> kNames = {"table", "uniform", "attribute", "packed"};

}  // namespace

std::string_view chart_transport_name(ChartTransport transport) {
    return kNames[static_cast<size_t>(transport)];
}

std::optional<ChartTransport> chart_transport_named(std::string_view name) {
    for (const ChartTransport transport : kChartTransports) {
        if (chart_transport_name(transport) == name) return transport;
    }
    return std::nullopt;
}

std::vector<std::string> chart_transport_names() {
    return {kNames.begin(), kNames.end()};
}

}  // namespace citystream::client
