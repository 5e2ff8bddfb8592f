#include "codec/mesh/chart_texcoords.h"

#include <algorithm>

#include "codec/bits/bit_stream.h"
#include "codec/chart_word.h"

namespace citystream::codec::mesh {

namespace {

int32_t rounded_in(int32_t low, int32_t high, int32_t texcoord) {
    const auto range = static_cast<uint64_t>(int64_t{high} - low);
    const uint32_t bits = bits::bits_for(range);
    const uint32_t shift = bits > ChartTexcoords::kBits ? bits - ChartTexcoords::kBits : 0;
    const uint64_t half = shift > 0 ? uint64_t{1} << (shift - 1) : 0;
    const auto distance = static_cast<uint64_t>(int64_t{texcoord} - low);
    const uint64_t code = std::min((distance + half) >> shift, range >> shift);
    return static_cast<int32_t>(int64_t{low} + static_cast<int64_t>(code << shift));
}

}  // namespace

ChartTexcoords::ChartTexcoords(const MeshTile& tile) {
    for (size_t corner = 0; corner < tile.indices.size(); ++corner) {
        const uint32_t chart = tile.triangle_chart[corner / 3];
        if (names_colour(chart)) continue;
        const MeshVertex& vertex = tile.vertices[tile.indices[corner]];
        const std::array<int32_t, 2> at = {vertex.texcoord[0], vertex.texcoord[1]};
        Range& range = ranges_.try_emplace(chart, Range{at, at}).first->second;
        for (size_t c = 0; c < 2; ++c) {
            range.low[c] = std::min(range.low[c], at[c]);
            range.high[c] = std::max(range.high[c], at[c]);
        }
    }
}

std::array<int32_t, 2> ChartTexcoords::rounded(uint32_t chart_word, const int32_t texcoord[2]) const {
    if (names_colour(chart_word)) return {};
    const Range& range = ranges_.at(chart_word);
    std::array<int32_t, 2> out{};
    for (size_t c = 0; c < 2; ++c) out[c] = rounded_in(range.low[c], range.high[c], texcoord[c]);
    return out;
}

}  // namespace citystream::codec::mesh
