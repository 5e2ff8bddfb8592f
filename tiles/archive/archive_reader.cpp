#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "tiles/archive/archive.h"
#include "tiles/archive/archive_layout.h"
#include "tiles/archive/verify.h"

namespace citystream::tiles::archive {
namespace {

using Bytes = std::span<const std::byte>;

/// A read-only mapping of a whole file; the descriptor is closed at once.
class Mapping {
  public:
    static Result<Mapping> open(const std::string& path) {
        const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
        if (descriptor < 0) return Error{path + ": cannot open: " + std::strerror(errno)};
        auto mapping = map(path, descriptor);
        ::close(descriptor);
        return mapping;
    }
    Mapping() = default;
    Mapping(Mapping&& other) noexcept : bytes_(std::exchange(other.bytes_, Bytes{})) {}
    Mapping& operator=(Mapping&& other) noexcept {
        std::swap(bytes_, other.bytes_);
        return *this;
    }
    Mapping(const Mapping&) = delete;
    Mapping& operator=(const Mapping&) = delete;
    ~Mapping() {
        if (!bytes_.empty()) ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
    }
    Bytes bytes() const { return bytes_; }

  private:
    static Result<Mapping> map(const std::string& path, int descriptor) {
        struct stat status {};
        if (::fstat(descriptor, &status) != 0) return Error{path + ": cannot read: " + std::strerror(errno)};
        if (!S_ISREG(status.st_mode)) return Error{path + ": not a file"};
        if (status.st_size == 0) return Error{path + ": not an archive: the file is empty", 0};
        const auto size = static_cast<size_t>(status.st_size);
        void* address = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor, 0);
        if (address == MAP_FAILED) return Error{path + ": cannot map: " + std::strerror(errno)};
        Mapping mapping;
        mapping.bytes_ = {static_cast<const std::byte*>(address), size};
        return mapping;
    }
    Bytes bytes_;
};

class Reader final : public ArchiveReader {
  public:
    Reader(Mapping mapping, Bytes file, ArchiveLayout layout)
        : mapping_(std::move(mapping)), file_(file), layout_(std::move(layout)) {
        entries_.reserve(layout_.entries.size());
        for (const PlacedRecord& placed : layout_.entries) {
            entries_.push_back({placed.record.name, placed.data_offset, placed.record.size, placed.record.crc32});
        }
    }

    Bytes find(std::string_view name) const override {
        const auto found =
            std::lower_bound(layout_.by_name.begin(), layout_.by_name.end(), name,
                             [&](size_t position, std::string_view wanted) { return name_of(position) < wanted; });
        if (found == layout_.by_name.end() || name_of(*found) != name) return {};
        const PlacedRecord& placed = layout_.entries[*found];
        return file_.subspan(placed.data_offset, placed.record.size);
    }

    const std::vector<ArchiveEntry>& entries() const override { return entries_; }
    uint64_t file_size() const override { return file_.size(); }
    std::vector<Error> verify() const override { return verify_archive(file_, layout_); }

  private:
    std::string_view name_of(size_t position) const { return layout_.entries[position].record.name; }

    Mapping mapping_;  // owns what file_ views, or nothing when the caller owns the bytes
    Bytes file_;
    ArchiveLayout layout_;
    std::vector<ArchiveEntry> entries_;
};

}  // namespace

Result<std::shared_ptr<ArchiveReader>> ArchiveReader::open(const std::string& path) {
    auto mapping = Mapping::open(path);
    if (!mapping) return mapping.error();
    const Bytes file = mapping->bytes();
    auto layout = read_layout(file);
    if (!layout) return Error{path + ": " + layout.error().message, layout.error().offset};
    return std::shared_ptr<ArchiveReader>(std::make_shared<Reader>(std::move(*mapping), file, std::move(*layout)));
}

Result<std::shared_ptr<ArchiveReader>> open_archive_bytes(Bytes bytes) {
    auto layout = read_layout(bytes);
    if (!layout) return layout.error();
    return std::shared_ptr<ArchiveReader>(std::make_shared<Reader>(Mapping{}, bytes, std::move(*layout)));
}

}  // namespace citystream::tiles::archive
