#include "client/path/camera_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "client/path/csv_table.h"

namespace citystream::client {
namespace {

constexpr size_t kColumns = 7;
constexpr std::array<std::string_view, kColumns> kColumnNames = {"t", "x", "y", "z", "yaw", "pitch", "fov"};
constexpr std::array<double CameraSample::*, kColumns> kFields = {
    &CameraSample::t,   &CameraSample::x,     &CameraSample::y,  &CameraSample::z,
    &CameraSample::yaw, &CameraSample::pitch, &CameraSample::fov};
enum Column : size_t { kTime = 0, kYaw = 4, kPitch = 5, kFov = 6 };
constexpr CsvForm kForm = {"camera path", kColumnNames, kColumns};
constexpr size_t kMaxSamples = 4'000'000;
constexpr double kMaxCoordinate = 1e9;  // metres; keeps grid arithmetic exact

/// Ranges beyond which a camera makes no picture or the arithmetic loses its exactness.
Status check_ranges(const CameraSample& sample, const CsvReader& row) {
    for (size_t i = 0; i < 4; ++i) {
        if (std::abs(sample.*kFields[i]) > kMaxCoordinate) return row.error(i, "larger than 1e9");
    }
    if (std::abs(sample.yaw) > 1e6) return row.error(kYaw, "larger than 1e6 degrees");
    if (std::abs(sample.pitch) > 90) return row.error(kPitch, "outside -90..90 degrees");
    if (sample.fov < 0.1 || sample.fov > 170) return row.error(kFov, "outside 0.1..170 degrees");
    return Done{};
}

Result<CameraSample> parse_sample(const CsvReader& row) {
    CameraSample sample;
    for (size_t i = 0; i < kColumns; ++i) {
        const Result<double> value = row.number(i);
        if (!value) return value.error();
        sample.*kFields[i] = *value;
    }
    const Status ranges = check_ranges(sample, row);
    if (!ranges) return ranges.error();
    return sample;
}

double mix(double a, double b, double s) {
    return a + (b - a) * s;
}

}  // namespace

CameraSample CameraPath::at(double t) const {
    if (!(t > samples.front().t)) return samples.front();
    if (t >= samples.back().t) return samples.back();
    const auto after =
        std::upper_bound(samples.begin(), samples.end(), t, [](double v, const CameraSample& s) { return v < s.t; });
    const CameraSample& b = *after;
    const CameraSample& a = *(after - 1);
    const double s = (t - a.t) / (b.t - a.t);
    const double turn = std::remainder(b.yaw - a.yaw, 360.0);
    return {t,
            mix(a.x, b.x, s),
            mix(a.y, b.y, s),
            mix(a.z, b.z, s),
            a.yaw + turn * s,
            mix(a.pitch, b.pitch, s),
            mix(a.fov, b.fov, s)};
}

Result<CameraPath> parse_camera_path(std::span<const char> text) {
    Result<CsvReader> rows = CsvReader::open(text, kForm);
    if (!rows) return rows.error();
    CameraPath path;
    for (;;) {
        const Result<bool> more = rows->next();
        if (!more) return more.error();
        if (!*more) break;
        const Result<CameraSample> sample = parse_sample(*rows);
        if (!sample) return sample.error();
        if (!path.samples.empty() && !(sample->t > path.samples.back().t))
            return rows->error(kTime, "time must grow from line to line");
        if (path.samples.size() == kMaxSamples) return rows->error("more than 4,000,000 samples");
        path.samples.push_back(*sample);
    }
    if (path.samples.empty()) return Error{"camera path: no samples after the header"};
    return path;
}

Result<CameraPath> read_camera_path(const std::string& file) {
    const Result<std::vector<char>> text = read_csv_file(file, kForm.what);
    if (!text) return text.error();
    Result<CameraPath> path = parse_camera_path(*text);
    if (!path) return Error{file + ": " + path.error().text()};
    return path;
}

}  // namespace citystream::client
