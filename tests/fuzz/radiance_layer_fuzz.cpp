// Any bytes as the first steps of a radiance layer: words that can be lit, and a tile that encodes to itself again, or
// an error, in bounded time and memory.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "codec/radiance/irradiance.h"
#include "codec/radiance/radiance_layer.h"
#include "codec/radiance/radiance_resident_layout.h"

namespace {

using namespace citystream::codec::radiance;
using Spans = std::vector<std::span<const std::byte>>;

constexpr uint64_t kDecodedBytes = 4096;

void check_words(const std::vector<uint32_t>& words) {
    if (4 * words.size() > kDecodedBytes) std::abort();
    const auto view = RadianceLayerView::create(words);
    if (!view) std::abort();
    WholeLight light;
    light.values.assign(view->matrix()[RADIANCE_WORD_COLUMNS], {1, 0, 0xffffffff});
    if (irradiance_words(*view, light).size() != IRRADIANCE_WORDS * view->receivers()) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size < 3) return 0;
    // The first two bytes say, in 1/256 of the rest, where the second and the third step begin; 0: there is none. The
    // third one is the form.
    const auto bytes = std::as_bytes(std::span(data, size).subspan(3));
    const size_t first = bytes.size() * data[0] / 256, second = (bytes.size() - first) * data[1] / 256;
    Spans steps = {bytes};
    if (data[0] != 0) steps = {bytes.first(first), bytes.subspan(first)};
    if (data[0] != 0 && data[1] != 0)
        steps = {bytes.first(first), bytes.subspan(first, second), bytes.subspan(first + second)};
    const MatrixForm form = data[2] % 2 == 0 ? MatrixForm::kBiclusters : MatrixForm::kRows;
    const auto words = decode_radiance_layer(steps, kDecodedBytes, form);
    if (words) check_words(*words);
    const auto tile = decode_radiance_tile(steps, kDecodedBytes);
    if (words && !tile) std::abort();
    if (!tile) return 0;
    const auto again = encode_radiance_layer(*tile, 1, 7);
    if (!again || *read_bake_hash(again->front().wire) != 7) std::abort();
    Spans told;
    uint64_t told_bytes = 0;
    for (const auto& step : *again) {
        told.emplace_back(step.wire);
        told_bytes += step.decoded_bytes;
    }
    const auto same = decode_radiance_tile(told, told_bytes);
    if (!same || *same != *tile) std::abort();
    return 0;
}
