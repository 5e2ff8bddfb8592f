// Any words as a facade map: what the check accepts decodes, can be looked up and hit by rays without leaving the
// words, and encodes to what decodes to the same again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/facade/facade_form.h"
#include "tests/fuzz/layer_words.h"
#include "tests/shaders/facade_on_cpu.h"

namespace {

using namespace citystream::codec::facade;

/// Re-encoding large maps would only make the fuzzer slow.
constexpr uint32_t kMostTexels = 1u << 13;

/// The shaders throw where they leave the words: a crash here.
void look_and_cast(const std::vector<uint32_t>& words, const FormHead& head) {
    const auto width = static_cast<float>(head.width), height = static_cast<float>(head.height);
    const auto top = static_cast<float>(head.depths.max_mm) + 1;
    for (const uint32_t x : {0u, head.width / 2, head.width - 1}) {
        for (const uint32_t y : {0u, head.height / 3, head.height - 1})
            citystream::shaders_test::lookup_on_cpu(words, x, y);
    }
    const float origins[][3] = {{width / 2, height / 2, top}, {-1, height / 3, top - 5}, {width, height, top}};
    for (const auto& origin : origins) {
        const float direction[3] = {width / 3 - origin[0], height / 4 - origin[1],
                                    static_cast<float>(head.depths.min_mm) - origin[2]};
        citystream::shaders_test::cast_on_cpu(citystream::shaders_test::exact_renderer_of(head.form), words, origin,
                                              direction);
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    const std::vector<uint32_t> words = citystream::words_of({data, size});
    if (!check_form(words).ok()) {
        if (decode_form(words).ok()) std::abort();
        return 0;
    }
    const FormHead head = read_form_head(words).value();
    look_and_cast(words, head);
    if (head.width * head.height > kMostTexels) return 0;
    const auto grid = decode_form(words);
    if (!grid.ok()) return 0;  // factors may pass the check and not fit together
    if (!is_valid(*grid) || grid->width() != head.width || grid->height() != head.height) std::abort();
    const auto again = encode_form(head.form, *grid);
    if (again.ok() && !(decode_form(*again).value() == *grid)) std::abort();
    return 0;
}
