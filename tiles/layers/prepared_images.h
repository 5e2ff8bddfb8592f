// The images of a city as tiles take them: each as fine as any tile can show it, with its coarser mips, in a spool file
// on disk. Thread-safe.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "codec/atlas/atlas_layer.h"
#include "codec/result.h"
#include "tiles/quadtree/spool_file.h"

namespace citystream::tiles::layers {

using codec::atlas::ChartImage;

class PreparedImages {
  public:
    /// For `count` images, in a file inside `folder`. Error: the disk.
    static Result<std::unique_ptr<PreparedImages>> create(const std::string& folder, size_t count);

    /// Stores an image and its mips (codec::atlas::downsample) down to 1 x 1. Error: the disk.
    Status store(uint32_t image, ChartImage finest);
    /// That store() holds, at most.
    static uint64_t bytes_to_store(uint64_t texels, bool alpha = false) { return (alpha ? 16 : 10) * texels; }
    /// Notes that an image has no pixels to show.
    void fail(uint32_t image);

    enum class State : uint8_t { kUnknown, kStored, kFailed };
    State state(uint32_t image) const;
    /// Sides of the finest mip of a stored image; 0 of any other.
    std::array<uint32_t, 2> sides(uint32_t image) const;
    bool has_alpha(uint32_t image) const;
    /// Mips of a stored image: the last is 1 x 1.
    uint32_t levels(uint32_t image) const;
    /// The finest mip of a stored image with at most this many texels (> 0); 0 of any other.
    uint32_t level_of_size(uint32_t image, uint64_t texels) const;
    /// A mip of a stored image; beyond the last, the last. Error: the disk.
    Result<ChartImage> read(uint32_t image, uint32_t level) const;

    uint64_t bytes() const { return file_->size(); }  ///< on disk

  private:
    struct Entry {
        State state = State::kUnknown;
        uint32_t width = 0, height = 0;
        bool alpha = false;
        std::vector<uint64_t> offsets;  // of the mips: colours, then alpha
    };
    PreparedImages(std::unique_ptr<quadtree::SpoolFile> file, size_t count) : file_(std::move(file)), entries_(count) {}
    Entry entry(uint32_t image) const;

    std::unique_ptr<quadtree::SpoolFile> file_;
    mutable std::mutex mutex_;  // guards entries_
    std::vector<Entry> entries_;
};

}  // namespace citystream::tiles::layers
