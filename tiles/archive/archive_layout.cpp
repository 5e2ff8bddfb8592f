#include "tiles/archive/archive_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <string>
#include <string_view>
#include <utility>

#include "tiles/archive/hash_index.h"

namespace citystream::tiles::archive {
namespace {

using Bytes = std::span<const std::byte>;

// The caller has checked that offset + sizeof(T) lies in the bytes.
template <typename T>
T get(Bytes bytes, uint64_t offset) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

struct EndRecords {
    uint64_t entry_count = 0;
    uint64_t central_offset = 0;
    uint64_t central_bytes = 0;
    uint64_t begin = 0;  // of the first end record
};

Result<EndRecords> read_end64(Bytes file, uint64_t end_offset) {
    if (end_offset < kLocator64Bytes + kEnd64Bytes) return Error{"ZIP64 end records are cut off", end_offset};
    const uint64_t locator = end_offset - kLocator64Bytes;
    if (get<uint32_t>(file, locator) != kLocator64Signature) return Error{"ZIP64 locator is missing", locator};
    const uint64_t end64 = locator - kEnd64Bytes;
    if (get<uint64_t>(file, locator + 8) != end64) return Error{"ZIP64 locator points elsewhere", locator};
    if (get<uint32_t>(file, end64) != kEnd64Signature) return Error{"ZIP64 end record is missing", end64};
    EndRecords end;
    end.entry_count = get<uint64_t>(file, end64 + 32);
    end.central_bytes = get<uint64_t>(file, end64 + 40);
    end.central_offset = get<uint64_t>(file, end64 + 48);
    end.begin = end64;
    return end;
}

Result<EndRecords> read_end(Bytes file) {
    if (file.size() < kEndBytes) return Error{"not an archive: shorter than a ZIP end record", 0};
    const uint64_t at = file.size() - kEndBytes;
    if (get<uint32_t>(file, at) != kEndSignature) {
        return Error{"no ZIP end record at the end: the file is cut off, has something after its end, or is no archive",
                     at};
    }
    if (get<uint16_t>(file, at + 20) != 0) return Error{"the ZIP end record announces a comment", at + 20};
    EndRecords end;
    end.entry_count = get<uint16_t>(file, at + 10);
    end.central_bytes = get<uint32_t>(file, at + 12);
    end.central_offset = get<uint32_t>(file, at + 16);
    end.begin = at;
    if (end.entry_count == kMax16 || end.central_bytes == kMax32 || end.central_offset == kMax32) {
        auto end64 = read_end64(file, at);
        if (!end64) return end64;
        end = *end64;
    }
    if (end.central_offset > end.begin || end.central_bytes != end.begin - end.central_offset) {
        return Error{"the central directory does not end where the end record begins", at};
    }
    if (end.entry_count > end.central_bytes / kCentralHeaderBytes) {
        return Error{
            fmt::format("the end record claims {} entries, more than the central directory holds", end.entry_count),
            at};
    }
    return end;
}

// The header offset from the record or from its ZIP64 extra field.
Result<uint64_t> read_header_offset(Bytes file, uint64_t at, Bytes extra) {
    const auto offset = get<uint32_t>(file, at + 42);
    if (offset != kMax32) return uint64_t{offset};
    for (size_t i = 0; i + 4 <= extra.size();) {
        const auto id = get<uint16_t>(extra, i);
        const size_t bytes = get<uint16_t>(extra, i + 2);
        if (bytes > extra.size() - i - 4) break;
        if (id == 1 && bytes >= 8) return get<uint64_t>(extra, i + 4);
        i += 4 + bytes;
    }
    return Error{"ZIP64 offset is missing", at};
}

Result<PlacedRecord> read_central_record(Bytes file, uint64_t at, uint64_t end) {
    if (end - at < kCentralHeaderBytes) return Error{"central directory is cut off", at};
    if (get<uint32_t>(file, at) != kCentralSignature) return Error{"central directory record is damaged", at};
    const size_t name_bytes = get<uint16_t>(file, at + 28);
    const size_t extra_bytes = get<uint16_t>(file, at + 30);
    const size_t comment_bytes = get<uint16_t>(file, at + 32);
    const size_t bytes = kCentralHeaderBytes + name_bytes + extra_bytes + comment_bytes;
    if (bytes > end - at) return Error{"central directory record is cut off", at};
    PlacedRecord placed;
    ZipRecord& record = placed.record;
    record.name.resize(name_bytes);
    if (name_bytes > 0) std::memcpy(record.name.data(), file.data() + at + kCentralHeaderBytes, name_bytes);
    if (const auto defect = name_defect(record.name)) return Error{"an entry's name is not allowed: " + *defect, at};
    if ((get<uint16_t>(file, at + 8) & 1) != 0) return Error{record.name + ": encrypted entries are not supported", at};
    if (get<uint16_t>(file, at + 10) != 0) return Error{record.name + ": compressed entries are not supported", at};
    record.crc32 = get<uint32_t>(file, at + 16);
    record.size = get<uint32_t>(file, at + 24);
    if (get<uint32_t>(file, at + 20) != record.size) return Error{record.name + ": its two sizes differ", at};
    if (record.size > kMaxEntryBytes) return Error{record.name + ": entries of 4 GiB and more are not allowed", at};
    auto offset = read_header_offset(file, at, file.subspan(at + kCentralHeaderBytes + name_bytes, extra_bytes));
    if (!offset) return Error{record.name + ": " + offset.error().message, at};
    record.header_offset = *offset;
    placed.central_offset = at;
    placed.central_bytes = bytes;
    return placed;
}

// Finds where the contents begin. The local header is as long as its fixed part, the name and its extra field. Where
// the next thing in the file follows directly there is no room for an extra field, and the header (one page of the file
// for each entry) need not be read.
Status place_contents(Bytes file, PlacedRecord& placed, uint64_t limit) {
    const ZipRecord& record = placed.record;
    const uint64_t header_bytes = kLocalHeaderBytes + record.name.size();
    if (record.header_offset > limit || limit - record.header_offset < header_bytes + record.size) {
        return Error{record.name + ": lies outside the file or overlaps what follows it", placed.central_offset};
    }
    placed.data_offset = record.header_offset + header_bytes;
    const uint64_t room = limit - placed.data_offset - record.size;
    if (room == 0) return Done{};
    if (get<uint32_t>(file, record.header_offset) != kLocalSignature) {
        return Error{record.name + ": local header is damaged", record.header_offset};
    }
    const uint64_t extra_bytes = get<uint16_t>(file, record.header_offset + 28);
    if (get<uint16_t>(file, record.header_offset + 26) != record.name.size() || extra_bytes > room) {
        return Error{record.name + ": local header is damaged", record.header_offset};
    }
    placed.data_offset += extra_bytes;
    return Done{};
}

Status place_all(Bytes file, ArchiveLayout& layout) {
    auto& entries = layout.entries;
    std::sort(entries.begin(), entries.end(), [](const PlacedRecord& a, const PlacedRecord& b) {
        return a.record.header_offset < b.record.header_offset;
    });
    for (size_t i = 0; i < entries.size(); ++i) {
        const ZipRecord& next = i + 1 < entries.size() ? entries[i + 1].record : layout.index.record;
        const uint64_t limit = std::min(next.header_offset, layout.central_offset);
        if (auto status = place_contents(file, entries[i], limit); !status) return status;
    }
    return place_contents(file, layout.index, layout.central_offset);
}

/// Sorts the names, of which none may appear twice or be the index's.
Status order_names(ArchiveLayout& layout) {
    const auto name_of = [&](size_t position) -> const std::string& { return layout.entries[position].record.name; };
    std::vector<size_t>& order = layout.by_name;
    order.resize(layout.entries.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return name_of(a) < name_of(b); });
    const auto twice =
        std::adjacent_find(order.begin(), order.end(), [&](size_t a, size_t b) { return name_of(a) == name_of(b); });
    if (twice != order.end()) return Error{name_of(*twice) + ": appears twice"};
    const auto index = std::lower_bound(order.begin(), order.end(), kIndexName,
                                        [&](size_t a, std::string_view name) { return name_of(a) < name; });
    if (index != order.end() && name_of(*index) == kIndexName) return Error{name_of(*index) + ": appears twice"};
    return Done{};
}

// As many index entries as entries, sorted, each at the header of an entry that no other points to.
Status check_index(Bytes file, const ArchiveLayout& layout) {
    const PlacedRecord& placed = layout.index;
    const Bytes index = file.subspan(placed.data_offset, placed.record.size);
    if (index.size() != layout.entries.size() * kIndexEntryBytes) {
        return Error{fmt::format("{}: has {} bytes, {} entries need {}", kIndexName, index.size(),
                                 layout.entries.size(), layout.entries.size() * kIndexEntryBytes),
                     placed.data_offset};
    }
    std::vector<bool> seen(layout.entries.size());
    for (size_t i = 0; i < layout.entries.size(); ++i) {
        const IndexEntry entry = index_entry(index, i);
        const uint64_t at = placed.data_offset + i * kIndexEntryBytes;
        if (i > 0 && entry.hash < index_entry(index, i - 1).hash) {
            return Error{fmt::format("{}: not sorted", kIndexName), at};
        }
        const auto found =
            std::lower_bound(layout.entries.begin(), layout.entries.end(), entry.header_offset,
                             [](const PlacedRecord& a, uint64_t offset) { return a.record.header_offset < offset; });
        if (found == layout.entries.end() || found->record.header_offset != entry.header_offset) {
            return Error{fmt::format("{}: points where no entry begins", kIndexName), at};
        }
        const auto position = static_cast<size_t>(found - layout.entries.begin());
        if (seen[position]) return Error{fmt::format("{}: points twice to one entry", kIndexName), at};
        seen[position] = true;
    }
    return Done{};
}

}  // namespace

Result<ArchiveLayout> read_layout(Bytes file) {
    const auto end = read_end(file);
    if (!end) return end.error();
    ArchiveLayout layout;
    layout.central_offset = end->central_offset;
    layout.central_bytes = end->central_bytes;
    layout.entries.reserve(end->entry_count);
    uint64_t at = end->central_offset;
    for (uint64_t i = 0; i < end->entry_count; ++i) {
        auto record = read_central_record(file, at, end->begin);
        if (!record) return record.error();
        at += record->central_bytes;
        layout.entries.push_back(std::move(*record));
    }
    if (at != end->begin) return Error{"bytes between the central directory and the end record", at};
    if (layout.entries.empty() || layout.entries.back().record.name != kIndexName) {
        return Error{fmt::format("the last entry is not {}: not a 3TZ archive", kIndexName), end->central_offset};
    }
    layout.index = std::move(layout.entries.back());
    layout.entries.pop_back();
    if (auto status = place_all(file, layout); !status) return status.error();
    if (auto status = order_names(layout); !status) return status.error();
    if (auto status = check_index(file, layout); !status) return status.error();
    return layout;
}

}  // namespace citystream::tiles::archive
