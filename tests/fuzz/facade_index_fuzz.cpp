// Parses arbitrary bytes as the facade index: the first two bytes are the number of maps, and the checksum is made
// right so that the rest is reached.
#include <cstdint>

#include "tiles/tileset/facade_index.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::tiles::tileset;
    if (size < 2) return 0;
    Manifest manifest;
    manifest.facade_map_count = data[0] + 256U * data[1];
    manifest.facade_index_decoded_bytes = manifest.facade_map_count * 24;
    manifest.facade_index_bytes = size - 2;
    manifest.facade_index_checksum = checksum_of(data + 2, size - 2);
    (void)parse_facade_index({reinterpret_cast<const std::byte*>(data) + 2, size - 2}, manifest).ok();
    return 0;
}
