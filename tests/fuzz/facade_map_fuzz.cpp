// Any words as a facade map: what the view accepts encodes to itself again and can be hit by rays.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/facade/facade_map.h"
#include "tests/fuzz/layer_words.h"

namespace {

/// Re-encoding large maps would only make the fuzzer slow.
constexpr uint32_t kMostTexels = 1u << 16;

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    using namespace citystream::codec::facade;
    const std::vector<uint32_t> words = citystream::words_of({data, size});
    const auto map = FacadeMapView::create(words);
    if (!map) return 0;
    const double width = map->width();
    const double height = map->height();
    const double origins[][3] = {{width / 2, height / 2, 40000}, {-1, height / 3, -5}, {width, height, 33000}};
    for (const auto& origin : origins) {
        const double direction[3] = {width / 3 - origin[0], height / 4 - origin[1], map->depth_min_mm() - origin[2]};
        (void)cast_facade_ray(*map, origin, direction);
    }
    if (map->width() * map->height() > kMostTexels) return 0;
    const auto image = decode_facade_map(words);
    if (!image) std::abort();
    const auto again = encode_facade_map(*image);
    if (!again || !(decode_facade_map(*again).value() == *image)) std::abort();
    return 0;
}
