// Blocks of the images that make up one step of a layer, appended to its words.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "codec/atlas/atlas_layer.h"

namespace citystream::codec::atlas {

class Bc1RateEncoder;

class StepBlocks {
  public:
    /// `words`: of the step; outlives this. `rate_distortion`: as AtlasOptions::rate_distortion. With it, images of
    /// several blocks have each block chosen by those before; images of one block always keep their best one.
    StepBlocks(std::vector<uint32_t>& words, uint32_t rate_distortion);
    ~StepBlocks();
    StepBlocks(const StepBlocks&) = delete;
    StepBlocks& operator=(const StepBlocks&) = delete;

    /// Appends the blocks of an image (sides >= 1), bottom row first: BC1, or BC3 where it has alpha; beyond its edges
    /// the last column and row repeat.
    void append(const ChartImage& image);
    /// BC1 of RGB, 3 * width * height bytes.
    void append(std::span<const uint8_t> rgb, uint32_t width, uint32_t height);

  private:
    void append_rows(std::span<const uint8_t> rgb, uint32_t width, uint32_t height, bool rated);

    std::vector<uint32_t>& words_;
    std::unique_ptr<Bc1RateEncoder> rate_;
};

}  // namespace citystream::codec::atlas
