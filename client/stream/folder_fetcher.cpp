#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "client/stream/local_fetcher.h"

namespace citystream::client {
namespace {

/// A file descriptor that closes itself.
class Descriptor {
  public:
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() {
        if (fd_ >= 0) ::close(fd_);
    }
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int get() const { return fd_; }
    bool good() const { return fd_ >= 0; }

  private:
    int fd_;
};

/// Opens part by part and never through a link, so that nothing outside the folder can be reached.
Descriptor open_inside(int folder, const std::string& path) {
    Descriptor at(::dup(folder));
    size_t begin = 0;
    while (at.good()) {
        const size_t end = std::min(path.find('/', begin), path.size());
        const bool last = end == path.size();
        const std::string part = path.substr(begin, end - begin);
        const int flags = O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK | (last ? 0 : O_DIRECTORY);
        at = Descriptor(::openat(at.get(), part.c_str(), flags));
        if (last) break;
        begin = end + 1;
    }
    return at;
}

Status read_at(int fd, uint64_t offset, std::vector<std::byte>& bytes, const std::string& path) {
    size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t n = ::pread(fd, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
        if (n < 0 && errno == EINTR) continue;
        if (n < 0) return Error{path + ": " + std::strerror(errno)};
        if (n == 0) return Error{path + ": became shorter while being read", offset + done};
        done += static_cast<size_t>(n);
    }
    return Done{};
}

Result<std::vector<std::byte>> read_inside(int folder, const FetchRequest& request) {
    if (!is_safe_path(request.path)) return Error{request.path + ": not a path inside the city"};
    const Descriptor file = open_inside(folder, request.path);
    struct stat status {};
    if (!file.good() || ::fstat(file.get(), &status) != 0 || !S_ISREG(status.st_mode)) {
        return Error{request.path + ": no such file in the folder"};
    }
    const Result<ByteRange> range = range_within(request, static_cast<uint64_t>(status.st_size));
    if (!range) return range.error();
    std::vector<std::byte> bytes(range->length);
    const Status read = read_at(file.get(), range->offset, bytes, request.path);
    if (!read) return read.error();
    return bytes;
}

}  // namespace

Result<std::unique_ptr<Fetcher>> open_folder_fetcher(const std::string& folder, const FetcherOptions& options) {
    auto root = std::make_shared<Descriptor>(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (!root->good()) return Error{folder + ": cannot open the folder: " + std::strerror(errno)};
    return make_local_fetcher([root](const FetchRequest& request) { return read_inside(root->get(), request); },
                              options);
}

}  // namespace citystream::client
