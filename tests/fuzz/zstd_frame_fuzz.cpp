// Any bytes as a zstd frame. Two bytes in front: the decoded size that the directory would have said.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "codec/bits/zstd_frame.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size < 2) return 0;
    const size_t decoded_size = data[0] | size_t{data[1]} << 8;
    const auto frame = std::as_bytes(std::span(data + 2, size - 2));
    const auto raw = citystream::codec::bits::decompress_frame(frame, decoded_size);
    if (raw && raw->size() != decoded_size) std::abort();
    return 0;
}
