// Any words as a facade map of a form that is looked up by texel: what the check accepts can be looked up everywhere,
// and what decodes encodes and decodes to the same again.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/facade/facade_form.h"
#include "tests/codec/facade/texel_forms.h"
#include "tests/fuzz/layer_words.h"

namespace {

using namespace citystream::codec::facade;

/// Re-encoding large maps would only make the fuzzer slow.
constexpr uint32_t kMostTexels = 1u << 13;

void look_up(const TexelForm& form, Words words, const FormHead& head) {
    for (const uint32_t x : {0u, head.width / 2, head.width - 1}) {
        for (const uint32_t y : {0u, head.height / 3, head.height - 1}) {
            (void)form.label(words, x, y);
            if (!form.box) continue;
            const FreeBox box = form.box(words, x, y);
            if (box.x0 >= box.x1 || box.x1 > head.width || box.y0 >= box.y1 || box.y1 > head.height) std::abort();
        }
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    static const std::vector<TexelForm> forms = texel_forms();
    const std::vector<uint32_t> words = citystream::words_of({data, size});
    for (const TexelForm& form : forms) {
        if (!form.check(words).ok()) {
            if (form.decode(words).ok()) std::abort();
            continue;
        }
        const FormHead head = read_form_head(words).value();
        // Raw maps may have no boxes, and then none is asked for.
        const bool is_without_boxes = form.name == "raw" && raw_box_count(words) == 0;
        if (!is_without_boxes) look_up(form, words, head);
        if (head.width * head.height > kMostTexels) continue;
        const auto grid = form.decode(words);
        if (!grid.ok()) continue;
        if (!is_valid(*grid) || grid->width() != head.width || grid->height() != head.height) std::abort();
        const auto again = form.encode(*grid);
        if (!again.ok() && !form.refuses) std::abort();
        if (again.ok() && !(form.decode(*again).value() == *grid)) std::abort();
    }
    return 0;
}
