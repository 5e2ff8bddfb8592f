// Small tables that people write by hand or a program records: CSV with a header that names the columns, which may come
// in any order. No quotes: a comma always ends a cell. Every fault is one line that names table, line and column.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "codec/result.h"

namespace citystream::client {

/// What a table may hold. The views must outlive the readers.
struct CsvForm {
    std::string_view what;                      ///< begins every message: "camera path"
    std::span<const std::string_view> columns;  ///< names; a column is meant by its place in this list
    size_t required = 0;                        ///< the first so many must be there
};

/// Reads a table row by row; lines count from 1. O(bytes) for all rows together.
class CsvReader {
  public:
    static constexpr size_t kMaxBytes = 512u << 20;

    /// Reads the header; `text` (with or without a byte order mark) must outlive the reader. Error: too large, no
    /// header, a column that is unknown, appears twice or is missing.
    static Result<CsvReader> open(std::span<const char> text, const CsvForm& form);

    /// Steps to the next line that is not empty; false after the last. Error: too few or too many cells.
    Result<bool> next();

    bool has(size_t column) const { return places_[column] != kAbsent; }
    /// Of the row that next() reached, without blanks around it; empty if the table lacks the column.
    std::string_view cell(size_t column) const;
    /// A finite number; a sign, also +, may go before it. Error: the cell is none.
    Result<double> number(size_t column) const;

    /// "camera path, line 3: <what>", and with the column's name.
    Error error(std::string_view what) const;
    Error error(size_t column, std::string_view what) const;

  private:
    static constexpr size_t kAbsent = ~size_t{0};

    explicit CsvReader(const CsvForm& form) : form_(form) {}
    bool next_line(std::string_view& line);
    Status read_header(std::string_view line);
    std::string expected() const;

    CsvForm form_;
    std::string_view rest_;
    bool ended_ = false;
    size_t line_ = 0;
    std::vector<size_t> places_;  ///< of each column of the form: its place in the file's rows
    std::vector<std::string_view> cells_;
};

/// At most 24 characters of foreign text, what is not ASCII replaced: for messages.
std::string printable(std::string_view text);

/// The whole file. Error: names file and `what` if it cannot be read or is larger than CsvReader::kMaxBytes.
Result<std::vector<char>> read_csv_file(const std::string& file, std::string_view what);

}  // namespace citystream::client
