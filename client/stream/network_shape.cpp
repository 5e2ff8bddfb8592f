#include "client/stream/network_shape.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

namespace citystream::client {
namespace {

struct Unit {
    std::string_view name;
    double factor;
    bool rate;
};

constexpr std::array<Unit, 7> kUnits = {{{"kbit", 1e3, true},
                                         {"mbit", 1e6, true},
                                         {"gbit", 1e9, true},
                                         {"bit", 1, true},
                                         {"us", 1e-6, false},
                                         {"ms", 1e-3, false},
                                         {"s", 1, false}}};

Error bad_shape(const std::string& text, const std::string& why) {
    return {"network shape \"" + text + "\": " + why + " (expected RATE,ROUNDTRIP such as 5mbit,38ms)"};
}

}  // namespace

Result<NetworkShape> NetworkShape::parse(const std::string& text) {
    NetworkShape shape;
    bool have_rate = false, have_delay = false;
    std::string_view rest = text;
    while (true) {
        const size_t comma = rest.find(',');
        const std::string_view part = rest.substr(0, comma);
        double value = 0;
        const auto [end, status] = std::from_chars(part.data(), part.data() + part.size(), value);
        if (status != std::errc{} || !(value >= 0) || value > 1e12)
            return bad_shape(text, "a number is missing or out of range");
        const std::string_view name(end, static_cast<size_t>(part.data() + part.size() - end));
        const auto unit = std::find_if(kUnits.begin(), kUnits.end(), [&](const Unit& u) { return u.name == name; });
        if (unit == kUnits.end()) return bad_shape(text, "unknown unit \"" + std::string(name) + "\"");
        bool& have = unit->rate ? have_rate : have_delay;
        if (have) return bad_shape(text, unit->rate ? "two rates" : "two round trips");
        have = true;
        (unit->rate ? shape.bits_per_second : shape.round_trip_seconds) = value * unit->factor;
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    if (shape.round_trip_seconds > 60) return bad_shape(text, "a round trip of more than a minute");
    return shape;
}

ShapedLink::Clock::time_point ShapedLink::reserve(uint64_t bytes, Clock::time_point at) {
    if (shape_.bits_per_second <= 0) return at;
    const std::lock_guard lock(mutex_);
    const std::chrono::duration<double> passage(8.0 * static_cast<double>(bytes) / shape_.bits_per_second);
    const Clock::time_point start = free_at_ + kLateness >= at ? free_at_ : at;
    free_at_ = start + std::chrono::duration_cast<Clock::duration>(passage);
    return std::max(free_at_, at);
}

ShapedLink::Clock::duration ShapedLink::half_round_trip() const {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(shape_.round_trip_seconds / 2));
}

}  // namespace citystream::client
