#include "tiles/quadtree/spool_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

namespace citystream::tiles::quadtree {
namespace {

constexpr size_t kPendingBytes = 1 << 20;

Error system_error(const std::string& what, const std::string& path) {
    return Error{what + " " + path + ": " + std::strerror(errno)};
}

}  // namespace

Result<std::unique_ptr<SpoolFolder>> SpoolFolder::create(const std::string& parent) {
    std::string pattern = (std::filesystem::path(parent) / ".citystream-build-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) return system_error("cannot make a temporary folder in", parent);
    return std::unique_ptr<SpoolFolder>(new SpoolFolder(std::move(pattern)));
}

SpoolFolder::~SpoolFolder() {
    std::error_code ignored;  // nothing sensible can be done about a folder that does not go away
    std::filesystem::remove_all(path_, ignored);
}

Result<std::unique_ptr<SpoolFile>> SpoolFile::create(const std::string& path) {
    const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (descriptor < 0) return system_error("cannot create", path);
    return std::unique_ptr<SpoolFile>(new SpoolFile(descriptor, path));
}

SpoolFile::~SpoolFile() {
    close(descriptor_);
}

Status SpoolFile::flush() {
    size_t done = 0;
    while (done < pending_.size()) {
        const ssize_t written =
            pwrite(descriptor_, pending_.data() + done, pending_.size() - done, static_cast<off_t>(flushed_ + done));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return system_error("cannot write", path_);
        done += static_cast<size_t>(written);
    }
    flushed_ += pending_.size();
    pending_.clear();
    return Done{};
}

Result<SpoolRange> SpoolFile::append(std::span<const std::byte> bytes) {
    const std::lock_guard lock(mutex_);
    const SpoolRange range{size_, bytes.size()};
    pending_.insert(pending_.end(), bytes.begin(), bytes.end());
    size_ += bytes.size();
    if (pending_.size() >= kPendingBytes) {
        if (Status status = flush(); !status) return status.error();
    }
    return range;
}

Status SpoolFile::read(SpoolRange range, std::vector<std::byte>& out) {
    {
        const std::lock_guard lock(mutex_);
        if (range.offset + range.size > flushed_) {
            if (Status status = flush(); !status) return status;
        }
    }
    const size_t begin = out.size();
    out.resize(begin + range.size);
    size_t done = 0;
    while (done < range.size) {
        const ssize_t got =
            pread(descriptor_, out.data() + begin + done, range.size - done, static_cast<off_t>(range.offset + done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return system_error("cannot read", path_);
        done += static_cast<size_t>(got);
    }
    return Done{};
}

}  // namespace citystream::tiles::quadtree
