#include "client/light/environment_path.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "client/path/csv_table.h"

namespace citystream::client {
namespace {

enum Column : size_t { kTime, kEnvironment, kRotation, kHour, kColumns };
constexpr std::array<std::string_view, kColumns> kColumnNames = {"time_s", "environment", "rotation_degrees", "hour"};
constexpr CsvForm kForm = {"environment path", kColumnNames, 2};

constexpr double kMostSeconds = 1e9, kMostDegrees = 1e6, kMostHours = 1e5;
constexpr size_t kLongestName = 4096;

double mix(double a, double b, double s) {
    return a + (b - a) * s;
}

Result<double> number_within(const CsvReader& row, Column column, double most) {
    Result<double> value = row.number(column);
    if (value && std::abs(*value) > most) {
        return row.error(
            column, "\"" + printable(row.cell(column)) + "\" is beyond " + std::to_string(static_cast<int64_t>(most)));
    }
    return value;
}

/// The number of the row's environment; a new one is added.
Result<size_t> environment_of(const CsvReader& row, std::vector<std::string>& environments) {
    const std::string_view name = row.cell(kEnvironment);
    if (name.empty()) return row.error(kEnvironment, "empty; expected the file of an environment map or sky");
    const bool good = name.size() <= kLongestName &&
                      std::none_of(name.begin(), name.end(), [](unsigned char c) { return c < 32 || c == 127; });
    if (!good) return row.error(kEnvironment, "\"" + printable(name) + "\" is no name of a file");
    const auto found = std::find(environments.begin(), environments.end(), name);
    if (found == environments.end()) {
        if (environments.size() == EnvironmentPath::kMostEnvironments)
            return row.error(kEnvironment, "more than 64 environments");
        environments.emplace_back(name);
        return environments.size() - 1;
    }
    return static_cast<size_t>(found - environments.begin());
}

Result<EnvironmentPath::Row> parse_row(const CsvReader& row, std::vector<std::string>& environments) {
    EnvironmentPath::Row result;
    const Result<double> time = number_within(row, kTime, kMostSeconds);
    if (!time) return time.error();
    result.time_s = *time;
    const Result<size_t> environment = environment_of(row, environments);
    if (!environment) return environment.error();
    result.environment = *environment;
    if (!row.cell(kRotation).empty()) {
        const Result<double> rotation = number_within(row, kRotation, kMostDegrees);
        if (!rotation) return rotation.error();
        result.rotation_degrees = *rotation;
    }
    const bool sky = environments[result.environment] == kAnalyticSky;
    if (sky == row.cell(kHour).empty())
        return row.error(kHour, sky ? "the analytic sky needs an hour" : "only the analytic sky has an hour");
    if (!sky) return result;
    const Result<double> hour = number_within(row, kHour, kMostHours);
    if (!hour) return hour.error();
    result.hour = *hour;
    return result;
}

}  // namespace

EnvironmentPath::Moment EnvironmentPath::at(double time_s) const {
    const auto alone = [](const Row& row) {
        return Moment{row.rotation_degrees, {{{row.environment, row.hour, 1}, {row.environment, row.hour, 0}}}};
    };
    if (!(time_s > rows.front().time_s)) return alone(rows.front());
    if (time_s >= rows.back().time_s) return alone(rows.back());
    const auto after = std::upper_bound(rows.begin(), rows.end(), time_s,
                                        [](double time, const Row& row) { return time < row.time_s; });
    const Row& b = *after;
    const Row& a = *(after - 1);
    const double s = (time_s - a.time_s) / (b.time_s - a.time_s);
    Row between = a;
    between.rotation_degrees = mix(a.rotation_degrees, b.rotation_degrees, s);
    if (a.environment == b.environment) {
        between.hour = mix(a.hour, b.hour, s);
        return alone(between);
    }
    return {between.rotation_degrees, {{{a.environment, a.hour, 1 - s}, {b.environment, b.hour, s}}}};
}

EnvironmentPath steady_environment(const std::string& environment, double rotation_degrees, double hour) {
    return {{environment}, {{0, 0, rotation_degrees, hour}}};
}

Result<EnvironmentPath> parse_environment_path(std::span<const char> text) {
    Result<CsvReader> reader = CsvReader::open(text, kForm);
    if (!reader) return reader.error();
    EnvironmentPath path;
    for (;;) {
        const Result<bool> more = reader->next();
        if (!more) return more.error();
        if (!*more) break;
        const Result<EnvironmentPath::Row> row = parse_row(*reader, path.environments);
        if (!row) return row.error();
        if (!path.rows.empty() && !(row->time_s > path.rows.back().time_s))
            return reader->error(kTime, "time must grow from line to line");
        if (path.rows.size() == EnvironmentPath::kMostRows) return reader->error("more than 1,000,000 rows");
        path.rows.push_back(*row);
    }
    if (path.rows.empty()) return Error{"environment path: no rows after the header"};
    return path;
}

Result<EnvironmentPath> read_environment_path(const std::string& file) {
    const Result<std::vector<char>> text = read_csv_file(file, kForm.what);
    if (!text) return text.error();
    Result<EnvironmentPath> path = parse_environment_path(*text);
    if (!path) return Error{file + ": " + path.error().text()};
    const std::filesystem::path folder = std::filesystem::path(file).parent_path();
    for (std::string& name : path->environments) {
        if (name != kAnalyticSky) name = (folder / name).string();
    }
    return path;
}

}  // namespace citystream::client
