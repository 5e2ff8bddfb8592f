#include "codec/mesh/resident_charts.h"

#include <algorithm>

#include "codec/bits/bit_stream.h"
#include "codec/chart_word.h"
#include "codec/mesh/mesh_resident_layout.h"

namespace citystream::codec::mesh {

namespace {

constexpr uint32_t kTexcoordBits = 16;

}  // namespace

ResidentCharts::Chart& ResidentCharts::chart_of(uint32_t chart_word) {
    const auto [at, added] = numbers_.try_emplace(chart_word, count());
    if (added) charts_.push_back({chart_word, {}, {}, {}});
    return charts_[at->second];
}

ResidentCharts::ResidentCharts(const MeshContent& content) {
    for (const MeshPrism& prism : content.prisms) {
        chart_of(prism.wall_chart);
        chart_of(prism.top_chart);
        if (prism.shape.has_floor) chart_of(prism.floor_chart);
    }
    for (const MeshTriangle& triangle : content.triangles) {
        const bool is_new = !numbers_.contains(triangle.chart_word);
        Chart& chart = chart_of(triangle.chart_word);
        for (size_t k = 0; k < 3; ++k) {
            for (size_t c = 0; c < 2; ++c) {
                const int32_t place = triangle.corners[k].texcoord[c];
                const bool is_first = is_new && k == 0;
                chart.low[c] = is_first ? place : std::min(chart.low[c], place);
                chart.high[c] = is_first ? place : std::max(chart.high[c], place);
            }
        }
    }
    const auto colours = std::stable_partition(charts_.begin(), charts_.end(),
                                               [](const Chart& chart) { return !names_colour(chart.word); });
    images_ = static_cast<uint32_t>(colours - charts_.begin());
    for (uint32_t i = 0; i < count(); ++i) {
        numbers_[charts_[i].word] = i;
        for (size_t c = 0; c < 2; ++c) {
            const auto span = static_cast<uint64_t>(int64_t{charts_[i].high[c]} - charts_[i].low[c]);
            charts_[i].shift[c] = std::max(bits::bits_for(span), kTexcoordBits) - kTexcoordBits;
        }
    }
}

uint32_t ResidentCharts::texcoord(uint32_t number, const std::array<int32_t, 2>& place) const {
    if (number >= images_) return 0;
    const Chart& chart = charts_[number];
    uint32_t word = 0;
    for (size_t c = 0; c < 2; ++c) {
        const auto distance = static_cast<uint64_t>(int64_t{place[c]} - chart.low[c]);
        word |= static_cast<uint32_t>(distance >> chart.shift[c]) << (kTexcoordBits * c);
    }
    return word;
}

std::array<uint32_t, 3> ResidentCharts::frame_of(const Chart& chart) {
    return {static_cast<uint32_t>(chart.low[0]), static_cast<uint32_t>(chart.low[1]),
            chart.shift[0] | chart.shift[1] << 8};
}

std::array<uint32_t, 3> ResidentCharts::frame() const {
    if (images_ == 0) return {};
    const std::array<uint32_t, 3> first = frame_of(charts_[0]);
    const bool common = std::all_of(charts_.begin(), charts_.begin() + images_,
                                    [&](const Chart& chart) { return frame_of(chart) == first; });
    return common ? first : std::array<uint32_t, 3>{0, 0, RESIDENT_FRAMES_OF_THEIR_OWN};
}

std::vector<uint32_t> ResidentCharts::words() const {
    const bool own_frames = frame()[RESIDENT_FRAME_SHIFTS] == RESIDENT_FRAMES_OF_THEIR_OWN;
    std::vector<uint32_t> words;
    for (uint32_t i = 0; i < count(); ++i) {
        words.push_back(charts_[i].word);
        if (i >= images_ || !own_frames) continue;
        const std::array<uint32_t, 3> frame = frame_of(charts_[i]);
        words.insert(words.end(), frame.begin(), frame.end());
    }
    return words;
}

uint32_t ResidentFaces::number(const SurfaceFace& face) {
    const auto [at, added] = numbers_.try_emplace(face, count());
    if (added) faces_.push_back(face);
    return at->second;
}

std::vector<uint32_t> ResidentFaces::words(uint32_t chart_bits, uint32_t code_bits) const {
    bits::BitWriter out;
    for (const SurfaceFace& face : faces_) {
        out.put(face.chart, chart_bits);
        out.put(face.normal, code_bits);
    }
    return out.finish();
}

}  // namespace citystream::codec::mesh
