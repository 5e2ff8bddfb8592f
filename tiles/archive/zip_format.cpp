#include "tiles/archive/zip_format.h"

#include <algorithm>
#include <cstring>

namespace citystream::tiles::archive {
namespace {

constexpr uint16_t kVersionPlain = 20;
constexpr uint16_t kVersionZip64 = 45;
constexpr uint16_t kMadeByUnix = 3 << 8;                        // so that the mode below counts
constexpr uint32_t kRegularFileMode = uint32_t{0100644} << 16;  // rw-r--r--
constexpr uint16_t kDosTime = 0;                                // 00:00:00
constexpr uint16_t kDosDate = (0 << 9) | (1 << 5) | 1;          // 1980-01-01, the first day ZIP knows
constexpr uint16_t kZip64ExtraId = 1;

template <typename T>
void put(std::vector<std::byte>& out, T value) {
    const size_t at = out.size();
    out.resize(at + sizeof value);
    std::memcpy(out.data() + at, &value, sizeof value);
}

void put_name(std::vector<std::byte>& out, std::string_view name) {
    for (const char c : name) out.push_back(static_cast<std::byte>(c));
}

bool needs_zip64(const ZipRecord& record) {
    return record.header_offset >= kMax32;
}

uint16_t version_needed(const ZipRecord& record) {
    return needs_zip64(record) ? kVersionZip64 : kVersionPlain;
}

// Version, flags, method, time, date, CRC and sizes: the part that local and central headers share.
void put_shared_fields(std::vector<std::byte>& out, const ZipRecord& record, uint16_t version) {
    put<uint16_t>(out, version);
    put<uint16_t>(out, 0);
    put<uint16_t>(out, 0);
    put(out, kDosTime);
    put(out, kDosDate);
    put(out, record.crc32);
    put(out, static_cast<uint32_t>(record.size));
    put(out, static_cast<uint32_t>(record.size));
    put(out, static_cast<uint16_t>(record.name.size()));
}

std::optional<std::string> component_defect(std::string_view component) {
    if (component.empty()) return "it has an empty component";
    if (component == "." || component == "..") return "it has the component \"" + std::string(component) + "\"";
    return std::nullopt;
}

}  // namespace

std::optional<std::string> name_defect(std::string_view name) {
    if (name.empty()) return "it is empty";
    if (name.size() > kMaxNameBytes) return "it is longer than 255 bytes";
    const auto is_bad = [](char c) { return c < 0x20 || c > 0x7e || c == '\\' || c == ':'; };
    if (std::any_of(name.begin(), name.end(), is_bad)) return "it has a character outside the portable set";
    if (name.find(".3tz") != std::string_view::npos) return "it contains \".3tz\"";
    for (size_t begin = 0; begin <= name.size();) {
        const size_t end = std::min(name.find('/', begin), name.size());
        if (auto defect = component_defect(name.substr(begin, end - begin))) return defect;
        begin = end + 1;
    }
    return std::nullopt;
}

void append_local_header(std::vector<std::byte>& out, const ZipRecord& record) {
    put(out, kLocalSignature);
    put_shared_fields(out, record, kVersionPlain);
    put<uint16_t>(out, 0);
    put_name(out, record.name);
}

void append_central_header(std::vector<std::byte>& out, const ZipRecord& record) {
    const bool zip64 = needs_zip64(record);
    put(out, kCentralSignature);
    put<uint16_t>(out, kMadeByUnix | version_needed(record));
    put_shared_fields(out, record, version_needed(record));
    put<uint16_t>(out, zip64 ? 12 : 0);
    put<uint16_t>(out, 0);
    put<uint16_t>(out, 0);
    put<uint16_t>(out, 0);
    put(out, kRegularFileMode);
    put(out, zip64 ? kMax32 : static_cast<uint32_t>(record.header_offset));
    put_name(out, record.name);
    if (!zip64) return;
    put(out, kZip64ExtraId);
    put<uint16_t>(out, 8);
    put(out, record.header_offset);
}

void append_end_records(std::vector<std::byte>& out, uint64_t entry_count, uint64_t central_offset,
                        uint64_t central_size) {
    if (entry_count >= kMax16 || central_offset >= kMax32 || central_size >= kMax32) {
        const uint64_t end64_offset = central_offset + central_size;
        put(out, kEnd64Signature);
        put<uint64_t>(out, kEnd64Bytes - 12);
        put<uint16_t>(out, kMadeByUnix | kVersionZip64);
        put<uint16_t>(out, kVersionZip64);
        put<uint32_t>(out, 0);
        put<uint32_t>(out, 0);
        put(out, entry_count);
        put(out, entry_count);
        put(out, central_size);
        put(out, central_offset);
        put(out, kLocator64Signature);
        put<uint32_t>(out, 0);
        put(out, end64_offset);
        put<uint32_t>(out, 1);
    }
    const auto count16 = static_cast<uint16_t>(std::min<uint64_t>(entry_count, kMax16));
    put(out, kEndSignature);
    put<uint16_t>(out, 0);
    put<uint16_t>(out, 0);
    put(out, count16);
    put(out, count16);
    put(out, static_cast<uint32_t>(std::min<uint64_t>(central_size, kMax32)));
    put(out, static_cast<uint32_t>(std::min<uint64_t>(central_offset, kMax32)));
    put<uint16_t>(out, 0);
}

}  // namespace citystream::tiles::archive
