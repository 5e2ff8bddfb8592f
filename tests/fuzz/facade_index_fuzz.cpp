// Parses arbitrary bytes as the columns of the facade index: the first two bytes are the number of maps; the rest is
// put into a frame that is right about itself, so that the records are reached.
#include <cstdint>

#include <cstdlib>

#include "codec/bits/zstd_frame.h"
#include "tiles/tileset/facade_index.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::tiles::tileset;
    if (size < 2) return 0;
    Manifest manifest;
    manifest.facade_map_count = data[0] + 256U * data[1];
    const std::span<const std::byte> raw(reinterpret_cast<const std::byte*>(data) + 2, size - 2);
    const std::vector<std::byte> frame = citystream::codec::bits::compress_frame(raw, 1);
    manifest.facade_index_decoded_bytes = raw.size();
    manifest.facade_index_bytes = frame.size();
    manifest.facade_index_checksum = checksum_of(frame.data(), frame.size());
    const auto maps = parse_facade_index(frame, manifest);
    if (maps && !check_facade_maps(*maps)) std::abort();
    return 0;
}
