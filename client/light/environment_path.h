// How the light changes along a flight: CSV with the columns time_s, environment, and where wanted rotation_degrees and
// hour, in any order.
//
//     time_s,environment,rotation_degrees,hour
//     0,dawn.hdr,0,
//     10,dawn.hdr,90,
//     20,sky,0,9
//     60,sky,0,33
//
// `environment` is the file of an environment map, from the table's folder, or `sky`, the analytic sky at an hour of
// true solar time (a day may go on: 33 is 9 in the morning after). In between two rows rotation and hour go from one to
// the other in a straight line, as written: 0 to 360 is a full turn, clockwise seen from above; hours 0 to 24 are a
// day. Between different environments one fades into the other. Empty cells: no rotation.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "codec/result.h"

namespace citystream::client {

inline constexpr std::string_view kAnalyticSky = "sky";

/// At least one row, times strictly growing.
struct EnvironmentPath {
    static constexpr size_t kMostEnvironments = 64;
    static constexpr size_t kMostRows = 1'000'000;

    struct Row {
        double time_s = 0;
        size_t environment = 0;  ///< in `environments`
        double rotation_degrees = 0;
        double hour = 0;  ///< of the analytic sky
    };
    struct Part {
        size_t environment = 0;
        double hour = 0;
        double weight = 0;
    };
    struct Moment {
        double rotation_degrees = 0;
        std::array<Part, 2> parts;  ///< weights add up to 1; one environment: the second has weight 0
    };

    std::vector<std::string> environments;  ///< each once, in the order of their first rows
    std::vector<Row> rows;

    /// Before the first row and after the last: those.
    Moment at(double time_s) const;
};

/// The same environment from first to last. `hour`: of the analytic sky.
EnvironmentPath steady_environment(const std::string& environment, double rotation_degrees, double hour);
/// One clear error with line and column on bad input.
Result<EnvironmentPath> parse_environment_path(std::span<const char> text);
/// Names of files become paths from the table's folder.
Result<EnvironmentPath> read_environment_path(const std::string& file);

}  // namespace citystream::client
