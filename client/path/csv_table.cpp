#include "client/path/csv_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

namespace citystream::client {
namespace {

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) text.remove_suffix(1);
    return text;
}

/// At most `most` + 1 cells: what is behind them is of no interest.
void split_commas(std::string_view line, size_t most, std::vector<std::string_view>& cells) {
    cells.clear();
    while (cells.size() <= most) {
        const size_t comma = line.find(',');
        cells.push_back(trimmed(line.substr(0, comma)));
        if (comma == std::string_view::npos) break;
        line.remove_prefix(comma + 1);
    }
}

}  // namespace

std::string printable(std::string_view text) {
    std::string out;
    for (const char c : text.substr(0, 24)) out += c >= 32 && c < 127 ? c : '?';
    return out + (text.size() > 24 ? "..." : "");
}

Error CsvReader::error(std::string_view what) const {
    return {std::string(form_.what) + ", line " + std::to_string(line_) + ": " + std::string(what)};
}

Error CsvReader::error(size_t column, std::string_view what) const {
    return error("column " + std::string(form_.columns[column]) + ": " + std::string(what));
}

std::string CsvReader::expected() const {
    std::string names;
    for (const std::string_view name : form_.columns) names += (names.empty() ? "" : ",") + std::string(name);
    return names;
}

bool CsvReader::next_line(std::string_view& line) {
    while (!ended_) {
        const size_t end = rest_.find('\n');
        line = rest_.substr(0, end);
        ended_ = end == std::string_view::npos;
        if (!ended_) rest_.remove_prefix(end + 1);
        ++line_;
        if (!trimmed(line).empty()) return true;
    }
    return false;
}

Status CsvReader::read_header(std::string_view line) {
    split_commas(line, form_.columns.size(), cells_);
    places_.assign(form_.columns.size(), kAbsent);
    if (cells_.size() > form_.columns.size()) return error("more columns in the header than " + expected());
    for (size_t i = 0; i < cells_.size(); ++i) {
        const auto found = std::find(form_.columns.begin(), form_.columns.end(), cells_[i]);
        if (found == form_.columns.end()) {
            return error("unknown column \"" + printable(cells_[i]) + "\" in the header (expected " + expected() + ")");
        }
        size_t& place = places_[static_cast<size_t>(found - form_.columns.begin())];
        if (place != kAbsent) return error("column " + printable(cells_[i]) + " appears twice in the header");
        place = i;
    }
    for (size_t column = 0; column < form_.required; ++column) {
        if (has(column)) continue;
        return error("the header lacks the column " + std::string(form_.columns[column]) + " (expected " + expected() +
                     ")");
    }
    return Done{};
}

Result<CsvReader> CsvReader::open(std::span<const char> text, const CsvForm& form) {
    const std::string what(form.what);
    if (text.size() > kMaxBytes) return Error{what + ": larger than 512 MiB"};
    CsvReader reader(form);
    reader.rest_ = {text.data(), text.size()};
    if (reader.rest_.starts_with("\xef\xbb\xbf")) reader.rest_.remove_prefix(3);
    std::string_view line;
    if (!reader.next_line(line)) return Error{what + ": empty; expected a header " + reader.expected()};
    if (const Status header = reader.read_header(line); !header) return header.error();
    return reader;
}

Result<bool> CsvReader::next() {
    const size_t wanted = static_cast<size_t>(
        std::count_if(places_.begin(), places_.end(), [](size_t place) { return place != kAbsent; }));
    std::string_view line;
    if (!next_line(line)) return false;
    split_commas(line, wanted, cells_);
    if (cells_.size() != wanted) {
        return error((cells_.size() < wanted ? "only " : "more than ") +
                     std::to_string(std::min(cells_.size(), wanted)) + " values, expected " + std::to_string(wanted));
    }
    return true;
}

std::string_view CsvReader::cell(size_t column) const {
    return has(column) ? cells_[places_[column]] : std::string_view();
}

Result<double> CsvReader::number(size_t column) const {
    const std::string_view text = cell(column);
    const std::string_view digits = text.starts_with('+') ? text.substr(1) : text;
    double value = 0;
    const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const std::string quoted = "\"" + printable(text) + "\" ";
    if (status != std::errc{} || end != digits.data() + digits.size()) return error(column, quoted + "is not a number");
    if (!std::isfinite(value)) return error(column, quoted + "is not finite");
    return value;
}

Result<std::vector<char>> read_csv_file(const std::string& file, std::string_view what) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    const auto size = in ? static_cast<std::streamoff>(in.tellg()) : -1;
    if (size < 0) return Error{file + ": cannot open the " + std::string(what)};
    if (static_cast<uint64_t>(size) > CsvReader::kMaxBytes)
        return Error{file + ": " + std::string(what) + " larger than 512 MiB"};
    std::vector<char> text(static_cast<size_t>(size));
    in.seekg(0);
    if (!text.empty() && !in.read(text.data(), size)) return Error{file + ": cannot read the " + std::string(what)};
    return text;
}

}  // namespace citystream::client
