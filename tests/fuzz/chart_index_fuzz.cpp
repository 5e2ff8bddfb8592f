// Parses arbitrary bytes as the columns of the chart index: the first two bytes are the number of charts; the rest is
// put into a frame that is right about itself, so that the records are reached.
#include <cstdint>
#include <cstdlib>

#include "codec/bits/zstd_frame.h"
#include "tiles/tileset/chart_index.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::tiles::tileset;
    if (size < 2) return 0;
    Manifest manifest;
    manifest.shared_chart_count = data[0] + 256U * data[1];
    const std::span<const std::byte> raw(reinterpret_cast<const std::byte*>(data) + 2, size - 2);
    const std::vector<std::byte> frame = citystream::codec::bits::compress_frame(raw, 1);
    manifest.chart_index_decoded_bytes = raw.size();
    manifest.chart_index_bytes = frame.size();
    manifest.chart_index_checksum = checksum_of(frame.data(), frame.size());
    // What the levels add up to, so that only the records decide.
    const size_t levels_begin = 8 * manifest.shared_chart_count;
    const size_t levels = raw.size() > levels_begin ? (raw.size() - levels_begin) / 4 : 0;
    for (size_t i = 0; i < levels; ++i) {
        for (size_t plane = 0; plane < 4; ++plane)
            manifest.chart_levels_bytes += static_cast<uint64_t>(raw[levels_begin + plane * levels + i]) << (8 * plane);
    }
    auto charts = parse_chart_index(frame, manifest);
    if (charts && (!check_charts(*charts) || place_chart_levels(*charts) != manifest.chart_levels_bytes)) std::abort();
    return 0;
}
