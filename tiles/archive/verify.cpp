#include "tiles/archive/verify.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "tiles/archive/hash_index.h"

namespace citystream::tiles::archive {
namespace {

using Bytes = std::span<const std::byte>;

// Length of the common beginning of what lies at `offset` and what should lie there; all of it when they are equal.
bool equal_at(Bytes file, uint64_t offset, Bytes expected, uint64_t& first_difference) {
    const uint64_t present = std::min<uint64_t>(file.size() - offset, expected.size());
    const auto [found, wanted] =
        std::mismatch(file.begin() + static_cast<ptrdiff_t>(offset),
                      file.begin() + static_cast<ptrdiff_t>(offset + present), expected.begin());
    first_difference = offset + static_cast<uint64_t>(wanted - expected.begin());
    return wanted == expected.end();
}

class Verifier {
  public:
    Verifier(Bytes file, const ArchiveLayout& layout) : file_(file), layout_(layout) {}

    std::vector<Error> run() {
        for (const PlacedRecord& placed : layout_.entries) check_entry(placed);
        check_entry(layout_.index);
        check_gap(layout_.central_offset, "the central directory");
        check_index();
        check_central();
        check_end();
        return std::move(errors_);
    }

  private:
    void report(std::string message, uint64_t offset) { errors_.push_back({std::move(message), offset}); }

    void check_gap(uint64_t next, std::string_view what) {
        if (next > accounted_) {
            report(fmt::format("{} bytes before {} belong to no entry", next - accounted_, what), accounted_);
        }
    }

    void check_entry(const PlacedRecord& placed) {
        const ZipRecord& record = placed.record;
        check_gap(record.header_offset, record.name);
        header_.clear();
        append_local_header(header_, record);
        uint64_t difference = 0;
        if (placed.data_offset != record.header_offset + header_.size() ||
            !equal_at(file_, record.header_offset, header_, difference)) {
            report(record.name + ": local header damaged", std::max(difference, record.header_offset));
        }
        const Bytes contents = file_.subspan(placed.data_offset, record.size);
        const auto crc =
            static_cast<uint32_t>(crc32_z(0, reinterpret_cast<const unsigned char*>(contents.data()), contents.size()));
        if (crc != record.crc32) {
            report(fmt::format("{}: contents damaged (CRC-32 {:08x}, the directory says {:08x})", record.name, crc,
                               record.crc32),
                   placed.data_offset);
        }
        accounted_ = placed.data_offset + record.size;
    }

    void check_index() {
        std::vector<ZipRecord> records;
        records.reserve(layout_.entries.size());
        for (const PlacedRecord& placed : layout_.entries) records.push_back(placed.record);
        uint64_t difference = 0;
        if (!equal_at(file_, layout_.index.data_offset, build_index(records), difference)) {
            report(fmt::format("{}: does not match the names and places of the entries", kIndexName), difference);
        }
    }

    void check_central_record(const PlacedRecord& placed, uint64_t expected_offset) {
        header_.clear();
        append_central_header(header_, placed.record);
        uint64_t difference = 0;
        if (placed.central_offset != expected_offset || placed.central_bytes != header_.size() ||
            !equal_at(file_, placed.central_offset, header_, difference)) {
            report(placed.record.name + ": central directory record damaged or out of order",
                   std::max(difference, placed.central_offset));
        }
    }

    void check_central() {
        uint64_t at = layout_.central_offset;
        for (const PlacedRecord& placed : layout_.entries) {
            check_central_record(placed, at);
            at += placed.central_bytes;
        }
        check_central_record(layout_.index, at);
    }

    void check_end() {
        std::vector<std::byte> expected;
        append_end_records(expected, layout_.entries.size() + 1, layout_.central_offset, layout_.central_bytes);
        const uint64_t at = layout_.central_offset + layout_.central_bytes;
        uint64_t difference = 0;
        if (file_.size() - at != expected.size() || !equal_at(file_, at, expected, difference)) {
            report("end records damaged", std::max(difference, at));
        }
    }

    Bytes file_;
    const ArchiveLayout& layout_;
    uint64_t accounted_ = 0;  // every byte below belongs to an entry that was checked
    std::vector<std::byte> header_;
    std::vector<Error> errors_;
};

}  // namespace

std::vector<Error> verify_archive(Bytes file, const ArchiveLayout& layout) {
    return Verifier(file, layout).run();
}

}  // namespace citystream::tiles::archive
