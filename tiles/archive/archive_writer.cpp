#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <unordered_set>
#include <utility>

#include "tiles/archive/archive.h"
#include "tiles/archive/hash_index.h"
#include "tiles/archive/zip_format.h"

namespace citystream::tiles::archive {
namespace {

using Bytes = std::span<const std::byte>;

constexpr size_t kBufferBytes = size_t{1} << 20;
constexpr int kMaxTemporaryNames = 64;

/// A file written front to back through a buffer, with places patched afterwards.
class OutputFile {
  public:
    OutputFile(std::string path, int descriptor) : path_(std::move(path)), descriptor_(descriptor) {
        buffer_.reserve(kBufferBytes);
    }
    ~OutputFile() { remove(); }
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    uint64_t position() const { return flushed_ + buffer_.size(); }

    Status write(Bytes bytes) {
        if (buffer_.size() + bytes.size() > kBufferBytes) {
            if (auto status = flush(); !status) return status;
        }
        if (bytes.size() <= kBufferBytes) {
            buffer_.insert(buffer_.end(), bytes.begin(), bytes.end());
            return Done{};
        }
        auto status = write_at(bytes, flushed_);
        if (status) flushed_ += bytes.size();
        return status;
    }

    /// Overwrites bytes that were written before.
    Status patch(Bytes bytes, uint64_t offset) {
        if (offset >= flushed_) {
            std::memcpy(buffer_.data() + (offset - flushed_), bytes.data(), bytes.size());
            return Done{};
        }
        if (auto status = flush(); !status) return status;
        return write_at(bytes, offset);
    }

    /// Everything on the disk under `final_path`, which appears whole or not at all.
    Status publish(const std::string& final_path) {
        if (auto status = flush(); !status) return status;
        if (::fsync(descriptor_) != 0) return failure("cannot sync");
        if (::close(std::exchange(descriptor_, -1)) != 0) return failure("cannot close");
        if (std::rename(path_.c_str(), final_path.c_str()) != 0) return failure("cannot rename");
        path_.clear();
        return sync_folder(final_path);
    }

    void remove() {
        if (descriptor_ >= 0) ::close(std::exchange(descriptor_, -1));
        if (!path_.empty()) ::unlink(path_.c_str());
        path_.clear();
    }

  private:
    Error failure(const char* what) const { return {fmt::format("{}: {}: {}", path_, what, std::strerror(errno))}; }

    Status flush() {
        auto status = write_at(buffer_, flushed_);
        if (!status) return status;
        flushed_ += buffer_.size();
        buffer_.clear();
        return Done{};
    }

    Status write_at(Bytes bytes, uint64_t offset) {
        while (!bytes.empty()) {
            const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
            if (written < 0 && errno == EINTR) continue;
            if (written <= 0) return failure("cannot write");
            bytes = bytes.subspan(static_cast<size_t>(written));
            offset += static_cast<uint64_t>(written);
        }
        return Done{};
    }

    // Without this a crash of the machine could forget the rename.
    static Status sync_folder(const std::string& final_path) {
        std::string folder = std::filesystem::path(final_path).parent_path().string();
        if (folder.empty()) folder = ".";
        const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
        if (descriptor < 0) return Error{folder + ": cannot open: " + std::strerror(errno)};
        const int failed = ::fsync(descriptor);
        const int reason = errno;
        ::close(descriptor);
        // Some file systems cannot sync a folder; the rename itself stands.
        if (failed != 0 && reason != EINVAL) return Error{folder + ": cannot sync: " + std::strerror(reason)};
        return Done{};
    }

    std::string path_;
    int descriptor_ = -1;
    std::vector<std::byte> buffer_;
    uint64_t flushed_ = 0;
};

class Writer final : public ArchiveWriter {
  public:
    Writer(std::string final_path, std::string temporary_path, int descriptor)
        : final_path_(std::move(final_path)), file_(std::move(temporary_path), descriptor) {}

    Status add(const std::string& name, Bytes bytes) override {
        if (auto status = begin_entry(name); !status) return status;
        if (auto status = append(bytes); !status) return status;
        return end_entry();
    }

    Status begin_entry(const std::string& name) override {
        if (failed_) return *failed_;
        if (open_) return fail({"entry " + records_.back().name + " is still open"});
        if (name == kIndexName) return fail({name + ": this name is the archive's own"});
        if (const auto defect = name_defect(name))
            return fail({"entry name \"" + name + "\" is not allowed: " + *defect});
        if (!names_.insert(name).second) return fail({name + ": is already in the archive"});
        return begin_record(name);
    }

    Status append(Bytes bytes) override {
        if (failed_) return *failed_;
        if (!open_) return fail({"no entry is open"});
        ZipRecord& record = records_.back();
        if (bytes.size() > kMaxEntryBytes - record.size) return fail({record.name + ": 3TZ entries end below 4 GiB"});
        record.crc32 = static_cast<uint32_t>(
            crc32_z(record.crc32, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
        record.size += bytes.size();
        return keep(file_.write(bytes));
    }

    Status end_entry() override {
        if (failed_) return *failed_;
        if (!open_) return fail({"no entry is open"});
        const ZipRecord& record = records_.back();
        if (record.size == 0) return fail({record.name + ": is empty, which 3TZ readers refuse"});
        header_.clear();
        append_local_header(header_, record);
        open_ = false;
        return keep(file_.patch(header_, record.header_offset));
    }

    Status finish() override {
        if (failed_) return *failed_;
        if (open_) return fail({"entry " + records_.back().name + " is still open"});
        if (finished_) return Error{"the archive is finished already"};
        if (records_.empty()) return fail({"an archive needs an entry"});
        const std::vector<std::byte> index = build_index(records_);
        if (auto status = begin_record(std::string(kIndexName)); !status) return status;
        if (auto status = append(index); !status) return status;
        if (auto status = end_entry(); !status) return status;
        if (auto status = write_central_directory(); !status) return status;
        if (auto status = keep(file_.publish(final_path_)); !status) return status;
        finished_ = true;
        return Done{};
    }

  private:
    // After a failure nothing more is written and the temporary file is gone; every later call says the same.
    Error fail(Error error) {
        failed_ = error;
        file_.remove();
        return error;
    }
    Status keep(Status status) {
        if (!status) return fail(status.error());
        return status;
    }

    // The header is a placeholder until end_entry knows size and CRC.
    Status begin_record(const std::string& name) {
        records_.push_back({name, file_.position(), 0, 0});
        open_ = true;
        header_.clear();
        append_local_header(header_, records_.back());
        return keep(file_.write(header_));
    }

    Status write_central_directory() {
        const uint64_t offset = file_.position();
        for (const ZipRecord& record : records_) {
            header_.clear();
            append_central_header(header_, record);
            if (auto status = keep(file_.write(header_)); !status) return status;
        }
        header_.clear();
        append_end_records(header_, records_.size(), offset, file_.position() - offset);
        return keep(file_.write(header_));
    }

    std::string final_path_;
    OutputFile file_;
    std::vector<ZipRecord> records_;
    std::unordered_set<std::string> names_;
    std::vector<std::byte> header_;
    std::optional<Error> failed_;
    bool open_ = false;
    bool finished_ = false;
};

}  // namespace

Result<std::unique_ptr<ArchiveWriter>> ArchiveWriter::create(const std::string& path) {
    const std::string base = fmt::format("{}.partial-{}", path, ::getpid());
    for (int attempt = 0; attempt < kMaxTemporaryNames; ++attempt) {
        // A killed process with the same id may have left its temporary file behind.
        const std::string temporary = attempt == 0 ? base : fmt::format("{}.{}", base, attempt);
        const int descriptor = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
        if (descriptor >= 0)
            return std::unique_ptr<ArchiveWriter>(std::make_unique<Writer>(path, temporary, descriptor));
        if (errno != EEXIST) return Error{fmt::format("{}: cannot create: {}", temporary, std::strerror(errno))};
    }
    return Error{base + ": cannot create: too many files of killed builds lie beside it"};
}

}  // namespace citystream::tiles::archive
