// Any bytes as a level of a shared chart: four bytes of its width and height, one of flags, one of the level; the rest
// is its blocks, in a payload that is right about itself, and once more as the payload. What decodes is a layer.
#include <xxhash.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <vector>

#include "codec/atlas/shared_chart.h"
#include "codec/bits/zstd_frame.h"

namespace {

using namespace citystream::codec;

struct Asked {
    uint32_t width, height, flags, step;
};

void decode(std::span<const std::byte> payload, const Asked& asked) {
    const auto words = atlas::decode_chart_level(payload, asked.width, asked.height, asked.flags, asked.step);
    if (!words) return;
    if (words->size() != atlas::atlas_step_words(asked.width, asked.height, asked.flags, asked.step)) std::abort();
    if (asked.step > 0) return;
    const auto view = atlas::shared_chart_view(*words, asked.width, asked.height, asked.flags, 1);
    if (!view) std::abort();
    uint8_t rgb[3];
    view->texel(0, view->mip_count(0) - 1, 0, 0, rgb);
    if (view->alpha(0, view->mip_count(0) - 1, 0, 0) < 255 && !view->has_alpha(0)) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size < 6) return 0;
    Asked asked{};
    asked.width = 1 + (data[0] + 256U * data[1]) % 8192;
    asked.height = 1 + (data[2] + 256U * data[3]) % 8192;
    asked.flags = data[4] & atlas::kSharedChartFlags;
    asked.step = data[5] % atlas::atlas_step_count(asked.width, asked.height, asked.flags);
    const std::span<const std::byte> rest(reinterpret_cast<const std::byte*>(data) + 6, size - 6);
    decode(rest, asked);
    std::vector<std::byte> payload(4);
    const std::vector<std::byte> frame = bits::compress_frame(rest, 1);
    const auto checksum = static_cast<uint32_t>(XXH3_64bits(frame.data(), frame.size()));
    std::memcpy(payload.data(), &checksum, sizeof(checksum));
    payload.insert(payload.end(), frame.begin(), frame.end());
    decode(payload, asked);
    return 0;
}
