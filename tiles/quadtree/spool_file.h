// Temporary files of the builder: append-only blobs, read back by position. They live in one unique folder that goes
// away with its owner.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "codec/result.h"

namespace citystream::tiles::quadtree {

/// A unique folder; removed with everything in it on destruction.
class SpoolFolder {
  public:
    /// Makes the folder inside `parent` (which must exist).
    static Result<std::unique_ptr<SpoolFolder>> create(const std::string& parent);
    ~SpoolFolder();
    SpoolFolder(const SpoolFolder&) = delete;
    SpoolFolder& operator=(const SpoolFolder&) = delete;
    const std::string& path() const { return path_; }

  private:
    explicit SpoolFolder(std::string path) : path_(std::move(path)) {}
    std::string path_;
};

struct SpoolRange {
    uint64_t offset = 0;
    uint64_t size = 0;
};

/// One append-only file. Appends are buffered; reading flushes first. Thread-safe.
class SpoolFile {
  public:
    static Result<std::unique_ptr<SpoolFile>> create(const std::string& path);
    ~SpoolFile();
    SpoolFile(const SpoolFile&) = delete;
    SpoolFile& operator=(const SpoolFile&) = delete;

    Result<SpoolRange> append(std::span<const std::byte> bytes);
    /// Appends the range to `out`.
    Status read(SpoolRange range, std::vector<std::byte>& out);
    uint64_t size() const { return size_; }

  private:
    SpoolFile(int descriptor, std::string path) : descriptor_(descriptor), path_(std::move(path)) {}
    Status flush();

    int descriptor_;
    std::string path_;
    std::mutex mutex_;
    std::vector<std::byte> pending_;
    uint64_t flushed_ = 0, size_ = 0;
};

}  // namespace citystream::tiles::quadtree
