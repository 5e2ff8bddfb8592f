// Images for benches of block compression: read, cut, decoded from blocks, and sent through JPEG.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace citystream::bench {

/// RGB, 8 bits, row-major; sides are multiples of 4.
struct BlockImage {
    std::string name;
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> rgb;
    uint64_t texels() const { return uint64_t{width} * height; }
};

/// The middle of an image file, at most most_width x most_height. Empty rgb: not a colour image of at least 4 x 4
/// texels.
BlockImage read_block_image(const std::string& file, uint32_t most_width, uint32_t most_height);

/// Photographs and textures of ../shared/data, where it is there: `set` is "kodak", "cc0" or "facades".
std::vector<std::string> shared_image_files(const std::string& set);

/// Made here: gradients, brick, plaster, a facade of repeated windows, flat colours, noise.
std::vector<BlockImage> procedural_block_images();

double psnr_of(const BlockImage& image, const std::vector<uint8_t>& shown);

/// What BC1 blocks show. Three-colour blocks as BC1 has them, if `standard`, which other encoders make.
std::vector<uint8_t> shown_by_blocks(const std::vector<uint32_t>& words, uint32_t width, uint32_t height,
                                     bool standard);

struct JpegResult {
    uint64_t bytes = 0;  ///< 0: the library cannot
    double psnr = 0;
};
/// The image as a JPEG file of a quality 1..100 (chroma at half size, as is usual).
JpegResult through_jpeg(const BlockImage& image, int quality);

}  // namespace citystream::bench
