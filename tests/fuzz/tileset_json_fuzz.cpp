// Parses arbitrary bytes as tileset.json; whatever is accepted must survive being written and parsed again.
#include <cstdint>
#include <cstdlib>
#include <string>

#include "tiles/tileset/tileset_json.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::tiles::tileset;
    const auto manifest = parse_tileset_json({reinterpret_cast<const std::byte*>(data), size});
    if (!manifest) return 0;
    const std::string written = write_tileset_json(*manifest);
    const auto again = parse_tileset_json(std::as_bytes(std::span(written)));
    if (!again || *again != *manifest) std::abort();
    return 0;
}
