#include "tests/bench/recorded_tracks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <sstream>

namespace citystream::bench {
namespace {

constexpr double kMetresPerDegree = 111'320;
constexpr double kLowest = 2, kLookDown = -15, kFieldOfView = 60;

struct Fix {
    double t = 0, x = 0, y = 0, z = 0;  ///< seconds, metres
    std::optional<double> yaw, pitch;
};

std::vector<std::string> cells_of(const std::string& line) {
    std::vector<std::string> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
    return cells;
}

/// Metres from the equator and the zero meridian, as a plane at the first fix.
Result<std::vector<Fix>> read_fixes(const std::string& file) {
    std::ifstream in(file);
    std::string line;
    if (!std::getline(in, line)) return Error{file + ": cannot be read"};
    std::map<std::string, size_t> column;
    for (const std::string& name : cells_of(line)) column.emplace(name, column.size());
    std::vector<Fix> fixes;
    double scale = 0;
    while (std::getline(in, line)) {
        const std::vector<std::string> cells = cells_of(line);
        const auto number = [&](const char* name) -> std::optional<double> {
            const auto at = column.find(name);
            if (at == column.end() || at->second >= cells.size()) return std::nullopt;
            return std::stod(cells[at->second]);
        };
        const auto t = number("t_s"), lat = number("lat"), lon = number("lon"), z = number("alt_m");
        if (!t || !lat || !lon || !z) return Error{file + ": a line without time or place"};
        if (scale == 0) scale = std::cos(*lat * std::numbers::pi / 180);
        fixes.push_back({*t, *lon * kMetresPerDegree * scale, *lat * kMetresPerDegree, *z, number("gimbal_yaw"),
                         number("gimbal_pitch")});
    }
    if (fixes.size() < 2) return Error{file + ": no track"};
    return fixes;
}

Fix fix_at(const std::vector<Fix>& fixes, double t) {
    const auto next = std::upper_bound(fixes.begin() + 1, fixes.end() - 1, t,
                                       [](double value, const Fix& fix) { return value < fix.t; });
    const Fix &a = *(next - 1), &b = *next;
    const double share = b.t > a.t ? std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0) : 0;
    Fix fix = a;
    fix.t = t;
    fix.x += share * (b.x - a.x);
    fix.y += share * (b.y - a.y);
    fix.z += share * (b.z - a.z);
    if (!fix.yaw) fix.yaw = std::atan2(b.x - a.x, b.y - a.y) * 180 / std::numbers::pi;
    return fix;
}

}  // namespace

Result<Tour> recorded_track(const SampleCity& city, const CityHeights& heights, const std::string& file, int cameras) {
    const auto fixes = read_fixes(file);
    if (!fixes) return fixes.error();
    Fix low = fixes->front(), high = low;
    for (const Fix& fix : *fixes) {
        low = {0, std::min(low.x, fix.x), std::min(low.y, fix.y), std::min(low.z, fix.z), {}, {}};
        high = {0, std::max(high.x, fix.x), std::max(high.y, fix.y), 0, {}, {}};
    }
    const auto& extent = city.manifest.extent;
    const double wide = extent.max[0] - extent.min[0], deep = extent.max[1] - extent.min[1];
    const double shrink = std::max({1.0, (high.x - low.x) / (wide / 2), (high.y - low.y) / (deep / 2)});
    const double x = to_metres(city.manifest.origin.x) + (extent.min[0] + extent.max[0]) / 2;
    const double y = to_metres(city.manifest.origin.y) + (extent.min[1] + extent.max[1]) / 2;
    Tour tour{std::filesystem::path(file).stem().string(), {}};
    const double begin = fixes->front().t, duration = fixes->back().t - begin;
    for (int i = 0; i < cameras; ++i) {
        const Fix fix = fix_at(*fixes, begin + duration * i / std::max(1, cameras - 1));
        client::CameraSample sample;
        sample.t = i;
        sample.x = x + (fix.x - (low.x + high.x) / 2) / shrink;
        sample.y = y + (fix.y - (low.y + high.y) / 2) / shrink;
        sample.z = kLowest + std::max(extent.min[2] + fix.z - low.z, heights.highest_at(sample.x, sample.y));
        sample.yaw = *fix.yaw;
        sample.pitch = fix.pitch.value_or(kLookDown);
        sample.fov = kFieldOfView;
        tour.path.samples.push_back(sample);
    }
    return tour;
}

std::vector<Tour> tracks_of(const SampleCity& city, const CityHeights& heights, int cameras) {
    std::vector<Tour> tours;
    for (const char* name : {"MAVIC3.csv", "p4_rtk.csv", "sampleFlight.csv"}) {
        auto track = recorded_track(
            city, heights, std::string(CITYSTREAM_SOURCE_DIR) + "/../shared/data/flight_paths/" + name, cameras);
        if (!track) return tours_of(city, cameras);
        tours.push_back(std::move(*track));
    }
    return tours;
}

}  // namespace citystream::bench
