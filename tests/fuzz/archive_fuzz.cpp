// Opens arbitrary bytes as an archive; whatever opens is verified and every entry is looked up.
#include <cstdint>
#include <cstdlib>

#include "tiles/archive/archive.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::tiles::archive;
    const auto reader = open_archive_bytes({reinterpret_cast<const std::byte*>(data), size});
    if (!reader) return 0;
    for (const ArchiveEntry& entry : (*reader)->entries()) {
        if (entry.data_offset > size || entry.size > size - entry.data_offset) std::abort();
        (*reader)->find(entry.name);
    }
    (*reader)->verify();
    return 0;
}
