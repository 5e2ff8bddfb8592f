// A small picture of the whole city from above, for the server's page. Thread-safe; the picture does not depend on the
// order of drawing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "tiles/layers/facade_painter.h"
#include "tiles/quadtree/build_object.h"

namespace citystream::tiles::layers {

class Preview {
  public:
    static constexpr uint32_t kSize = 512;  ///< of the longer side, pixels

    Preview(const quadtree::GridBox& extent, ImageCache& images);
    void draw(const std::vector<quadtree::BuildObject>& objects);
    /// PNG bytes; empty when the encoder fails.
    std::vector<std::byte> encode(const std::string& scratch_path) const;

  private:
    struct Pixel {
        int64_t z = INT64_MIN;
        std::array<uint8_t, 3> rgb = {225, 228, 230};
    };
    void draw_triangle(const std::array<GridPoint, 3>& corners, const std::array<uint8_t, 3>& rgb);

    GridPoint corner_;
    double pixels_per_unit_ = 1;
    uint32_t width_ = 1, height_ = 1;
    ImageCache& images_;
    std::mutex mutex_;
    std::vector<Pixel> pixels_;
};

}  // namespace citystream::tiles::layers
