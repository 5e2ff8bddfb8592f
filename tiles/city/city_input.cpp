#include "tiles/city/city_input.h"

#include <array>
#include <filesystem>

#include "tiles/city/city_reading.h"
#include "tiles/city/citygml_reader.h"
#include "tiles/city/cityjson_reader.h"
#include "tiles/city/text_source.h"

namespace citystream::tiles::city {
namespace {

enum class Format : uint8_t { kXml, kJson, kUnknown };

/// By the first character that is neither white space nor a byte order mark.
Result<Format> format_of(TextSource& source) {
    std::array<char, 4096> head{};
    const auto count = source.read(head);
    if (!count) return count.error();
    if (const auto status = source.rewind(); !status) return status.error();
    const std::string_view text(head.data(), *count);
    const size_t at = text.find_first_not_of(std::string_view("\xEF\xBB\xBF\xFE\xFF\0 \t\r\n", 10));
    if (at == std::string_view::npos) return Format::kUnknown;
    if (text[at] == '<') return Format::kXml;
    return text[at] == '{' ? Format::kJson : Format::kUnknown;
}

Status read_file(const std::string& path, CityReading& reading) {
    auto source = TextSource::open(path);
    if (!source) return source.error();
    const auto format = format_of(*source);
    if (!format) return format.error();
    Status status = Done{};
    switch (*format) {
        case Format::kXml:
            status = read_citygml(*source, reading);
            break;
        case Format::kJson:
            status = read_cityjson(*source, reading);
            break;
        case Format::kUnknown:
            return Error{path + ": is no city model (neither CityJSON nor CityGML)"};
    }
    if (status) reading.tell_progress(source->stored_bytes_total());
    reading.next_file(source->stored_bytes_total());
    return status;
}

}  // namespace

Status read_city(const std::vector<std::string>& paths, const InputOptions& options, CityHeader& header,
                 CityCatalog& catalog, CityReport& report, const CitySink& sink) {
    CityReading reading(options, header, catalog, report, sink);
    uint64_t total = 0;
    for (const std::string& path : paths) {
        std::error_code code;
        const auto size = std::filesystem::file_size(path, code);
        if (!code) total += size;
    }
    reading.set_total(total);
    for (const std::string& path : paths) {
        auto status = read_file(path, reading);
        if (!status) {
            report.add({.feature = path,
                        .what = "reading stopped: " + status.error().message,
                        .where = status.error().text()});
            return status;
        }
        if (reading.stopped()) break;
    }
    return Done{};
}

}  // namespace citystream::tiles::city
