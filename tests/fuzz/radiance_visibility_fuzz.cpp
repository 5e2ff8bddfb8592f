// Any bytes as the steps of a tile's visibility: a tile that encodes to itself again, or an error, in bounded time and
// memory.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "codec/radiance/visibility_wire.h"

namespace {

using namespace citystream::codec::radiance;
using Spans = std::vector<std::span<const std::byte>>;

constexpr RadianceLimits kLimits{48, 1 << 14};

/// Receivers of three frames in turns.
VisibilityTile frames_of(uint32_t receivers) {
    const uint32_t codes[] = {pack_frame({0, 0, 1}), pack_frame({1, 0, 0}), pack_frame({-0.5, 0.6, 0.3})};
    VisibilityTile tile;
    for (uint32_t r = 0; r < receivers; ++r) tile.add_receiver(codes[r % 3]);
    return tile;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    if (size < 3) return 0;
    // The first two bytes say, in 1/256 of the rest, where the second and the third step begin; 0: there is none. The
    // third one says how many receivers there are.
    const auto bytes = std::as_bytes(std::span(data, size).subspan(3));
    const VisibilityTile known = frames_of(data[2]);
    const size_t first = bytes.size() * data[0] / 256, second = (bytes.size() - first) * data[1] / 256;
    Spans steps = {bytes};
    if (data[0] != 0) steps = {bytes.first(first), bytes.subspan(first)};
    if (data[0] != 0 && data[1] != 0)
        steps = {bytes.first(first), bytes.subspan(first, second), bytes.subspan(first + second)};
    const auto tile = decode_visibility(known, steps, kLimits);
    if (!tile) return 0;
    if (tile->words.size() != size_t{tile->receivers()} * tile->words_a_receiver()) std::abort();
    VisibilityTile clear = *tile;
    clear_below_planes(clear);
    if (clear != *tile) std::abort();
    const auto again = encode_visibility(*tile);
    Spans told;
    for (const auto& step : again) told.push_back(step.bytes);
    const auto same = decode_visibility(known, told, kLimits);
    if (!same || *same != *tile) std::abort();
    return 0;
}
