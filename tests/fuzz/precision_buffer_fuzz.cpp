// Any words as a precision buffer with planes behind it: what is accepted reads within itself, changes its level to
// another valid buffer, and comes back the same.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "codec/mesh/adaptive_precision.h"
#include "tests/fuzz/layer_words.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    namespace mesh = citystream::codec::mesh;
    if (size < 3) return 0;
    const uint32_t to_level = data[0];
    const std::vector<uint32_t> words = citystream::words_of(std::span(data, size).subspan(3));
    const size_t buffer_words = data[1] | size_t{data[2]} << 8;
    if (buffer_words > words.size()) return 0;
    const std::vector<uint32_t> buffer(words.begin(), words.begin() + static_cast<std::ptrdiff_t>(buffer_words));
    const auto view = mesh::PrecisionView::create(buffer);
    // Vertices without bits cost nothing in the buffer, but each of them is looked at here.
    if (!view || view->shape().vertices > 4096) return 0;
    uint32_t out[PRECISION_MOST_COMPONENTS] = {};
    for (uint32_t v = 0; v < view->shape().vertices; ++v) view->fetch(v, out);
    const std::vector<uint32_t> planes(words.begin() + static_cast<std::ptrdiff_t>(buffer_words), words.end());
    const auto changed = mesh::change_level(*view, to_level, planes);
    if (!changed) return 0;
    const auto changed_view = mesh::PrecisionView::create(*changed);
    if (!changed_view || changed_view->level() != to_level) std::abort();
    if (to_level < view->level()) return 0;
    const auto again = mesh::change_level(*changed_view, view->level(), {});
    if (!again || *again != buffer) std::abort();
    return 0;
}
