#include "client/path/camera_path.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

namespace citystream::client {
namespace {

constexpr size_t kColumns = 7;
constexpr std::array<std::string_view, kColumns> kColumnNames = {"t", "x", "y", "z", "yaw", "pitch", "fov"};
constexpr std::array<double CameraSample::*, kColumns> kFields = {
    &CameraSample::t,   &CameraSample::x,     &CameraSample::y,  &CameraSample::z,
    &CameraSample::yaw, &CameraSample::pitch, &CameraSample::fov};
constexpr size_t kMaxSamples = 4'000'000;
constexpr size_t kMaxBytes = 512u << 20;
constexpr double kMaxCoordinate = 1e9;  // metres; keeps grid arithmetic exact

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
    return text;
}

/// Walks over a text line by line; counts lines from 1.
class Lines {
  public:
    explicit Lines(std::string_view text) : text_(text) {}
    bool next(std::string_view& line) {
        if (done_) return false;
        const size_t end = text_.find('\n');
        line = text_.substr(0, end);
        done_ = end == std::string_view::npos;
        if (!done_) text_.remove_prefix(end + 1);
        ++number_;
        return true;
    }
    size_t number() const { return number_; }

  private:
    std::string_view text_;
    size_t number_ = 0;
    bool done_ = false;
};

std::vector<std::string_view> split_commas(std::string_view line, size_t most) {
    std::vector<std::string_view> cells;
    while (cells.size() <= most) {
        const size_t comma = line.find(',');
        cells.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) break;
        line.remove_prefix(comma + 1);
    }
    return cells;
}

std::string printable(std::string_view text) {
    std::string out;
    for (const char c : text.substr(0, 24)) out += c >= 32 && c < 127 ? c : '?';
    return out + (text.size() > 24 ? "..." : "");
}

Error error_at(size_t line, std::string_view what) {
    return {"camera path, line " + std::to_string(line) + ": " + std::string(what)};
}

/// Which field each column of the file holds.
using Columns = std::array<size_t, kColumns>;

Result<Columns> parse_header(std::string_view line, size_t number) {
    const std::vector<std::string_view> cells = split_commas(line, kColumns);
    if (cells.size() != kColumns) {
        return error_at(number, "the header must name the 7 columns t,x,y,z,yaw,pitch,fov");
    }
    Columns columns{};
    std::array<bool, kColumns> seen{};
    for (size_t i = 0; i < kColumns; ++i) {
        const auto found = std::find(kColumnNames.begin(), kColumnNames.end(), cells[i]);
        if (found == kColumnNames.end()) {
            return error_at(number, "unknown column \"" + printable(cells[i]) +
                                        "\" in the header (expected t,x,y,z,yaw,pitch,fov)");
        }
        columns[i] = static_cast<size_t>(found - kColumnNames.begin());
        if (seen[columns[i]]) return error_at(number, "column " + printable(cells[i]) + " appears twice in the header");
        seen[columns[i]] = true;
    }
    return columns;
}

Result<double> parse_number(std::string_view cell, size_t line, std::string_view column) {
    double value = 0;
    const std::string_view digits = cell.starts_with('+') ? cell.substr(1) : cell;
    const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const std::string where = "column " + std::string(column) + ": \"" + printable(cell) + "\" ";
    if (status != std::errc{} || end != digits.data() + digits.size()) return error_at(line, where + "is not a number");
    if (!std::isfinite(value)) return error_at(line, where + "is not finite");
    return value;
}

/// Ranges beyond which a camera makes no picture or the arithmetic loses its exactness.
Status check_ranges(const CameraSample& sample, size_t line) {
    for (size_t i = 0; i < 4; ++i) {
        if (std::abs(sample.*kFields[i]) > kMaxCoordinate) {
            return error_at(line, "column " + std::string(kColumnNames[i]) + ": larger than 1e9");
        }
    }
    if (std::abs(sample.yaw) > 1e6) return error_at(line, "column yaw: larger than 1e6 degrees");
    if (std::abs(sample.pitch) > 90) return error_at(line, "column pitch: outside -90..90 degrees");
    if (sample.fov < 0.1 || sample.fov > 170) return error_at(line, "column fov: outside 0.1..170 degrees");
    return Done{};
}

Result<CameraSample> parse_sample(std::string_view line, size_t number, const Columns& columns) {
    const std::vector<std::string_view> cells = split_commas(line, kColumns);
    if (cells.size() != kColumns) {
        return error_at(number, (cells.size() < kColumns ? "only " : "more than ") +
                                    std::to_string(std::min(cells.size(), kColumns)) + " values, expected 7");
    }
    CameraSample sample;
    for (size_t i = 0; i < kColumns; ++i) {
        const Result<double> value = parse_number(cells[i], number, kColumnNames[columns[i]]);
        if (!value) return value.error();
        sample.*kFields[columns[i]] = *value;
    }
    const Status ranges = check_ranges(sample, number);
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
    if (text.size() > kMaxBytes) return Error{"camera path: larger than 512 MiB"};
    std::string_view all(text.data(), text.size());
    if (all.starts_with("\xef\xbb\xbf")) all.remove_prefix(3);
    Lines lines(all);
    std::string_view line;
    bool have_header = false;
    Columns columns{};
    CameraPath path;
    while (lines.next(line)) {
        if (trimmed(line).empty()) continue;
        if (!have_header) {
            const Result<Columns> header = parse_header(line, lines.number());
            if (!header) return header.error();
            columns = *header;
            have_header = true;
            continue;
        }
        const Result<CameraSample> sample = parse_sample(line, lines.number(), columns);
        if (!sample) return sample.error();
        if (!path.samples.empty() && !(sample->t > path.samples.back().t)) {
            return error_at(lines.number(), "column t: time must grow from line to line");
        }
        if (path.samples.size() == kMaxSamples) return error_at(lines.number(), "more than 4,000,000 samples");
        path.samples.push_back(*sample);
    }
    if (!have_header) return Error{"camera path: empty; expected a header t,x,y,z,yaw,pitch,fov"};
    if (path.samples.empty()) return Error{"camera path: no samples after the header"};
    return path;
}

Result<CameraPath> read_camera_path(const std::string& file) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    const auto size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
    if (size < 0) return Error{file + ": cannot open the camera path"};
    if (static_cast<uint64_t>(size) > kMaxBytes) return Error{file + ": camera path larger than 512 MiB"};
    std::vector<char> text(static_cast<size_t>(size));
    in.seekg(0);
    if (!text.empty() && !in.read(text.data(), size)) return Error{file + ": cannot read the camera path"};
    Result<CameraPath> path = parse_camera_path(text);
    if (!path) return Error{file + ": " + path.error().text()};
    return path;
}

}  // namespace citystream::client
