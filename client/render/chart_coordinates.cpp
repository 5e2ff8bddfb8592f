#include "client/render/chart_coordinates.h"

#include <bit>
#include <optional>

#include "codec/atlas/page_layer.h"
#include "codec/atlas/wrap_coordinate_layout.h"
#include "codec/chart_word.h"
#include "codec/mesh/mesh_resident.h"

namespace citystream::client {
namespace {

using codec::mesh::ResidentMeshView;

constexpr int32_t kRepeat = 1 << 16;  // of mesh texture coordinates
constexpr int64_t kPackedStep = kRepeat / WRAP_PLACE_ONE;
constexpr uint32_t kUniformPages = WRAP_PLACE_MASK + 1;
static_assert(codec::atlas::kWrapStep * kRepeat == kPackedStep);

struct ChartWords {
    uint32_t u = 0, v = 0, flags = 0;
    bool is_flat() const { return (flags & PAGES_CHART_FLAT) != 0; }
    uint32_t page() const { return flags >> 16; }
};

struct ChartTable {
    std::span<const uint32_t> words;

    uint32_t count() const { return words[PAGES_WORD_CHART_COUNT]; }
    uint32_t pages() const { return words[PAGES_WORD_PAGE_COUNT]; }
    uint32_t border() const { return words[PAGES_WORD_MIPS] >> 8; }
    ChartWords chart(uint32_t chart_word) const {
        if (codec::names_colour(chart_word)) return {chart_word & CHART_WORD_COLOUR_MASK, 0, PAGES_CHART_FLAT};
        const size_t entry =
            PAGES_HEADER_WORDS + size_t{PAGES_PAGE_WORDS} * pages() + size_t{PAGES_CHART_WORDS} * chart_word;
        return {words[entry + PAGES_CHART_U], words[entry + PAGES_CHART_V], words[entry + PAGES_CHART_FLAGS]};
    }
};

std::array<uint32_t, 2> uniform_words(const ChartWords& chart) {
    const uint32_t flags = chart.flags & WRAP_PLACE_MASK;
    return chart.is_flat() ? std::array<uint32_t, 2>{chart.u, flags}
                           : std::array<uint32_t, 2>{chart.u | chart.page(), chart.v | flags};
}

std::vector<ChartRun> make_runs(const ResidentMeshView& mesh, const ChartTable& table) {
    std::vector<ChartRun> runs;
    uint32_t triangle = 0, previous = 0;
    for (uint32_t range = 0; range < mesh.ranges().size(); ++range) {
        for (uint32_t i = 0; i < mesh.ranges()[range].triangles; ++i, ++triangle) {
            const uint32_t chart = mesh.chart_word(triangle);
            if (i == 0 || chart != previous) runs.push_back({range, i, 0, uniform_words(table.chart(chart))});
            ++runs.back().triangles;
            previous = chart;
        }
    }
    return runs;
}

std::array<float, COORDINATE_FRAME_WORDS> attribute_frame(const ChartWords& chart, uint32_t border) {
    if (chart.is_flat()) return {static_cast<float>(chart.u), 0, 0, 0};
    const codec::atlas::ChartFrame frame = codec::atlas::frame_of({chart.u, chart.v}, border);
    return {frame.origin_u + static_cast<float>(chart.page() * COORDINATE_PAGE_STEP), frame.origin_v,
            (chart.flags & PAGES_CHART_REPEAT_U) != 0 ? frame.size_u : -frame.size_u,
            (chart.flags & PAGES_CHART_REPEAT_V) != 0 ? frame.size_v : -frame.size_v};
}

std::vector<uint32_t> make_attributes(const ResidentMeshView& mesh, const ChartTable& table) {
    std::vector<uint32_t> words;
    words.reserve(size_t{3} * COORDINATE_FRAME_WORDS * mesh.triangle_count());
    for (uint32_t triangle = 0; triangle < mesh.triangle_count(); ++triangle) {
        const auto frame = attribute_frame(table.chart(mesh.chart_word(triangle)), table.border());
        for (int corner = 0; corner < 3; ++corner) {
            for (const float value : frame) words.push_back(std::bit_cast<uint32_t>(value));
        }
    }
    return words;
}

// A corner's word of an axis; nothing: packed, its place would be another.
std::optional<uint32_t> packed_word(uint32_t chart, int32_t texcoord, int32_t base, bool repeats) {
    const int64_t place = int64_t{texcoord} - (repeats ? base & ~(kRepeat - 1) : 0);
    const auto word = codec::atlas::move_wrap_axis(chart, static_cast<double>(place) / kRepeat);
    if (!word || codec::atlas::decode_wrap_axis(*word, 0).place * kPackedStep != place) return std::nullopt;
    return *word;
}

// Empty: a place is not on the packed grid.
std::optional<std::vector<uint32_t>> make_packed(const ResidentMeshView& mesh, const ChartTable& table) {
    std::vector<uint32_t> words;
    words.reserve(size_t{COORDINATE_TRIANGLE_WORDS} * mesh.triangle_count());
    for (uint32_t triangle = 0; triangle < mesh.triangle_count(); ++triangle) {
        const ChartWords chart = table.chart(mesh.chart_word(triangle));
        int32_t base[2], texcoord[2];
        mesh.texcoord_base(triangle, base);
        words.push_back(chart.flags);
        for (uint32_t corner = 0; corner < 3; ++corner) {
            if (chart.is_flat()) {
                words.insert(words.end(), {chart.u, 0});
                continue;
            }
            mesh.texcoord(triangle, corner, texcoord);
            const auto u = packed_word(chart.u, texcoord[0], base[0], (chart.flags & PAGES_CHART_REPEAT_U) != 0);
            const auto v = packed_word(chart.v, texcoord[1], base[1], (chart.flags & PAGES_CHART_REPEAT_V) != 0);
            if (!u || !v) return std::nullopt;
            words.insert(words.end(), {*u, *v});
        }
    }
    return words;
}

}  // namespace

uint64_t page_table_words(std::span<const uint32_t> header) {
    if (header.size() < PAGES_HEADER_WORDS || !codec::atlas::is_page_layer(header)) return 0;
    return PAGES_HEADER_WORDS + uint64_t{PAGES_PAGE_WORDS} * header[PAGES_WORD_PAGE_COUNT] +
           uint64_t{PAGES_CHART_WORDS} * header[PAGES_WORD_CHART_COUNT];
}

Result<ChartCoordinates> make_chart_coordinates(ChartTransport wanted, std::span<const uint32_t> mesh,
                                                std::span<const uint32_t> table) {
    const uint64_t table_words = page_table_words(table);
    if (table_words == 0 || table_words > table.size()) return Error{"an atlas without a chart table"};
    const ChartTable charts{table};
    const auto view = ResidentMeshView::create(mesh, charts.count());
    if (!view) return view.error();
    ChartCoordinates made;
    if (wanted == ChartTransport::kUniform && charts.pages() <= kUniformPages) {
        made.transport = wanted;
        made.runs = make_runs(*view, charts);
    }
    if (wanted == ChartTransport::kPacked) {
        if (auto words = make_packed(*view, charts)) {
            made.transport = wanted;
            made.words = std::move(*words);
            return made;
        }
        wanted = ChartTransport::kAttribute;
    }
    if (wanted == ChartTransport::kAttribute && charts.pages() <= COORDINATE_MOST_PAGES) {
        made.transport = wanted;
        made.words = make_attributes(*view, charts);
    }
    return made;
}

}  // namespace citystream::client
