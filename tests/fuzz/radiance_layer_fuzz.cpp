// Any bytes as the first steps of a radiance layer of any transport: words that can be lit, and a tile that encodes to
// itself again and has the same words by every transport, or an error, in bounded time and memory.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <utility>
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

/// A layer as it is received.
struct Layer {
    std::vector<RadianceLayerStep> steps;
    Spans wire;
    uint64_t decoded_bytes = 0;

    Layer(const RadianceTile& tile, RadianceTransport transport) {
        auto encoded = encode_radiance_layer(tile, 1, 7, 0, transport);
        if (!encoded || *read_bake_hash(encoded->front().wire) != 7) std::abort();
        steps = std::move(*encoded);
        for (const auto& step : steps) {
            wire.emplace_back(step.wire);
            decoded_bytes += step.decoded_bytes;
        }
    }
    std::vector<uint32_t> words(MatrixForm form) const {
        auto decoded = decode_radiance_layer(wire, decoded_bytes, form);
        if (!decoded) std::abort();
        return std::move(*decoded);
    }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size < 3) return 0;
    // The first two bytes say, in 1/256 of the rest, where the second and the third step begin; 0: there is none. The
    // third one is the form, and the transport by which the tile is sent again.
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
    if (words && !tile && *read_radiance_transport(steps[0]) == RadianceTransport::kVisibility) std::abort();
    if (!tile) return 0;
    const Layer again(*tile, RadianceTransport::kVisibility);
    const auto same = decode_radiance_tile(again.wire, again.decoded_bytes);
    if (!same || *same != *tile) std::abort();
    const auto transport = static_cast<RadianceTransport>(data[2] / 2 % kRadianceTransportNames.size());
    if (Layer(*tile, transport).words(form) != again.words(form)) std::abort();
    return 0;
}
