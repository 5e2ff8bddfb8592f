// JPEG files in memory, by OpenImageIO: what a viewer that knows nothing of charts would fetch.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace citystream::bench {

/// RGB, 8 bits, rows in the file's order, in quality 1..100, chroma at half size, as is usual. Empty: the library
/// cannot.
std::vector<unsigned char> jpeg_file(std::span<const uint8_t> rgb, uint32_t width, uint32_t height, int quality);

/// What a file of width x height pixels shows, RGB; empty when it cannot be read.
std::vector<uint8_t> jpeg_pixels(const std::vector<unsigned char>& file, uint32_t width, uint32_t height);

}  // namespace citystream::bench
