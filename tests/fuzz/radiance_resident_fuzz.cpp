// Any words as a tile's resident transfer matrix: what the view accepts can be multiplied without reading outside.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "codec/radiance/radiance_resident.h"
#include "tests/fuzz/layer_words.h"

using namespace citystream::codec::radiance;

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::vector<uint32_t> words = citystream::words_of(std::span(data, size));
    const auto view = ResidentRadianceView::create(words);
    if (!view || view->columns() > 1u << 16) return 0;
    const std::vector<Channels<uint32_t>> light(view->columns(), {1, 2, 3});
    const auto rows = view->product(std::span<const Channels<uint32_t>>(light));
    for (uint32_t r = 0; r < view->receivers(); ++r) {
        for (uint32_t j = 0; j < view->locals(); ++j) {
            if (view->row_of(r, j) >= rows.size()) std::abort();
        }
    }
    return 0;
}
