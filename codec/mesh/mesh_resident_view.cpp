#include <algorithm>

#include "codec/chart_word.h"
#include "codec/mesh/local_strips.h"
#include "codec/mesh/mesh_resident.h"
#include "codec/mesh/mesh_resident_check.h"
#include "codec/mesh/octahedral.h"
#include "codec/mesh/resident_range.h"

namespace citystream::codec::mesh {

namespace {

constexpr std::array<int32_t, 3> kUp = {0, 0, 1}, kDown = {0, 0, -1}, kNowhere = {1, 0, 0};

/// A triangle and where it is.
struct TrianglePlace {
    ResidentRange range;
    uint32_t range_number, triangle;  ///< of its range
};

TrianglePlace place_of(std::span<const uint32_t> words, uint32_t triangle) {
    uint32_t number = 0;
    while (number + 1 < words[RESIDENT_WORD_RANGES] && ResidentRange(words, number + 1).first_triangle <= triangle)
        ++number;
    const ResidentRange range(words, number);
    return {range, number, triangle - range.first_triangle};
}

/// Position words with the bits that their bin has.
struct KnownPosition {
    std::array<uint32_t, 3> words{};
    uint32_t level = 0, least_level = 0;
};

class PositionReader {
  public:
    PositionReader(std::span<const uint32_t> layer, const PrecisionView& buffer) : layer_(layer), buffer_(buffer) {}

    KnownPosition read(const std::array<uint32_t, 3>& places) const {
        KnownPosition known;
        for (size_t c = 0; c < 3; ++c) known.level = buffer_.fetch(places[c], std::span(&known.words[c], 1));
        for (const PrecisionBin& bin : buffer_.shape().bins)
            if (bin.first_vertex <= places[0]) known.least_level = bin.least_level;
        return known;
    }
    std::array<int32_t, 3> shown(const KnownPosition& known, const PositionView& view) const {
        PrecisionGrid grid;
        grid.reading = Reconstruction::kThirds;
        std::array<int32_t, 3> from_camera{};
        for (size_t c = 0; c < 3; ++c) {
            grid.origin[c] = static_cast<int32_t>(layer_[RESIDENT_WORD_ORIGIN_X + c]);
            from_camera[c] = view.from_camera[c] + grid.origin[c];
        }
        const uint32_t granted = dropped_in_box(view.rule, from_camera, known.words, known.words);
        return grid.point_of(known.words, dropped(known, std::max(granted, view.least_dropped)));
    }
    uint32_t dropped(const KnownPosition& known, uint32_t wanted) const {
        const uint32_t full = buffer_.shape().full_bits;
        return std::max(std::min(wanted, full - known.least_level), full - known.level);
    }

  private:
    std::span<const uint32_t> layer_;
    const PrecisionView& buffer_;
};

/// Corner of a triangle of a prism: which point of the loop, and the place of its height in the buffer.
struct PrismCorner {
    uint32_t point, height;
};

PrismCorner prism_corner(const ResidentRange& range, uint32_t record, uint32_t prism, uint32_t triangle, uint32_t k) {
    const uint32_t n = range.points;
    if (triangle < 2 * n) {
        const uint32_t wall = triangle / 2;
        const bool second = (triangle & 1) != 0;
        const bool over = second ? k >= 1 : k == 2;
        const bool next = second ? k == 1 : k >= 1;
        const uint32_t base = range.has(RESIDENT_FLAG_WALL_BASES) ? record + RESIDENT_PRISM_POINTS + 2 * n + wall
                                                                  : record + RESIDENT_PRISM_BASE;
        return {next ? (wall + 1 == n ? 0 : wall + 1) : wall, over ? record + RESIDENT_PRISM_TOP : base};
    }
    const bool floor = triangle >= 3 * n - 2;
    const uint32_t of_row = triangle - (floor ? 3 * n - 2 : 2 * n);
    const uint32_t corner = floor ? 2 - k : k;
    return {range.row_corner(range.prism_top(prism), of_row, corner),
            record + (floor ? RESIDENT_PRISM_BASE : RESIDENT_PRISM_TOP)};
}

uint32_t prism_part(const ResidentRange& range, uint32_t triangle) {
    if (triangle < 2 * range.points) return 0;
    return triangle < 3 * range.points - 2 ? 1 : 2;
}

}  // namespace

Result<ResidentMeshView> ResidentMeshView::create(std::span<const uint32_t> words, uint32_t atlas_chart_count) {
    Result<CheckedResident> checked = check_resident(words, atlas_chart_count);
    if (!checked) return checked.error();
    ResidentMeshView view;
    view.words_ = words;
    view.positions_ = std::move(checked->positions);
    view.strips_ = std::move(checked->strips);
    for (uint32_t r = 0; r < words[RESIDENT_WORD_RANGES]; ++r) {
        const ResidentRange range(words, r);
        view.ranges_.push_back({range.triangles, range.kind, range.has(RESIDENT_FLAG_DRESSED), range.topology,
                                range.topology_words, range.flags});
    }
    return view;
}

uint32_t ResidentMeshView::triangle_count() const {
    return words_[RESIDENT_WORD_TRIANGLES];
}

uint32_t ResidentMeshView::position_begin() const {
    return words_[RESIDENT_WORD_POSITIONS];
}

uint32_t ResidentMeshView::vertex(uint32_t range, uint32_t triangle, uint32_t k) const {
    const ResidentRange read(words_, range);
    if (read.kind == RESIDENT_KIND_INDICES) return read.index(uint64_t{3} * triangle + k);
    if (read.kind == RESIDENT_KIND_LOCAL_STRIPS) return local_triangle(read.topology_span(), triangle)[k];
    return strips_[range][triangle][k];
}

uint32_t ResidentMeshView::chart_entry(uint32_t chart) const {
    const uint32_t frames = has_own_frames() ? std::min(chart, words_[RESIDENT_WORD_IMAGES]) : 0;
    return words_[RESIDENT_WORD_CHART_TABLE] + chart + frames * RESIDENT_FRAME_WORDS;
}

bool ResidentMeshView::has_own_frames() const {
    return words_[RESIDENT_WORD_FRAME + RESIDENT_FRAME_SHIFTS] == RESIDENT_FRAMES_OF_THEIR_OWN;
}

std::span<const uint32_t> ResidentMeshView::frame_of(uint32_t chart_entry) const {
    return words_.subspan(has_own_frames() ? chart_entry + RESIDENT_CHART_FRAME : RESIDENT_WORD_FRAME);
}

uint32_t ResidentMeshView::entry_of(uint32_t triangle) const {
    const auto [range, number, t] = place_of(words_, triangle);
    const uint32_t images = words_[RESIDENT_WORD_IMAGES];
    if (range.kind == RESIDENT_KIND_PRISMS) {
        const auto each = static_cast<uint32_t>(range.prism_triangles());
        return chart_entry(images + range.prism_colour(t / each, prism_part(range, t % each)));
    }
    const uint32_t face = range.face(t);
    if (range.has(RESIDENT_FLAG_NORMALS)) return chart_entry(range.has(RESIDENT_FLAG_TEXCOORDS) ? face : images + face);
    return chart_entry(face_field(face, 0));
}

uint32_t ResidentMeshView::face_field(uint32_t face, uint32_t part) const {
    const uint32_t chart_bits = words_[RESIDENT_WORD_BITS] >> 8;
    const uint32_t code_bits = 2 * (words_[RESIDENT_WORD_BITS] & 255);
    const uint64_t bit = uint64_t{face} * (chart_bits + code_bits) + (part == 0 ? 0 : chart_bits);
    return bits::read_bits(words_.subspan(words_[RESIDENT_WORD_FACE_TABLE]), bit, part == 0 ? chart_bits : code_bits);
}

ResidentCorner ResidentMeshView::prism_corner_of(uint32_t triangle, uint32_t k, const PositionView& view) const {
    const auto [range, number, t] = place_of(words_, triangle);
    const auto each = static_cast<uint32_t>(range.prism_triangles());
    const uint32_t prism = t / each, part = prism_part(range, t % each);
    const auto record = static_cast<uint32_t>(range.first_position + prism * range.record_words());
    const PositionReader reader(words_, positions_);
    const auto known = [&](const PrismCorner& corner) {
        const uint32_t point = record + RESIDENT_PRISM_POINTS + 2 * corner.point;
        return reader.read({point, point + 1, corner.height});
    };
    ResidentCorner corner;
    corner.position = reader.shown(known(prism_corner(range, record, prism, t % each, k)), view);
    corner.normal = part == 1 ? kUp : kDown;
    if (part != 0) return corner;
    // Of the wall's edge as the step on show has it.
    const KnownPosition p = known(prism_corner(range, record, prism, t % each & ~1u, 0));
    const KnownPosition q = known(prism_corner(range, record, prism, t % each & ~1u, 1));
    const uint32_t dropped = reader.dropped(p, view.least_dropped);
    const auto along = [&](size_t c) {
        return static_cast<int32_t>((q.words[c] >> dropped << dropped) - (p.words[c] >> dropped << dropped));
    };
    corner.normal = {along(1), -along(0), 0};
    if (corner.normal[0] == 0 && corner.normal[1] == 0) corner.normal = kNowhere;
    return corner;
}

ResidentCorner ResidentMeshView::corner(uint32_t triangle, uint32_t k, const PositionView& view) const {
    const auto [range, number, t] = place_of(words_, triangle);
    ResidentCorner corner;
    if (range.kind == RESIDENT_KIND_PRISMS) {
        corner = prism_corner_of(triangle, k, view);
    } else {
        const uint32_t v = vertex(number, t, k), place = range.first_position + 3 * range.point(v);
        const PositionReader reader(words_, positions_);
        corner.position = reader.shown(reader.read({place, place + 1, place + 2}), view);
        const uint32_t normal_bits = words_[RESIDENT_WORD_BITS] & 255;
        const uint32_t code = range.has(RESIDENT_FLAG_NORMALS)
                                  ? range.field(range.normals, uint64_t{2} * normal_bits * v, 2 * normal_bits)
                                  : face_field(range.face(t), 1);
        corner.normal = unfold_octahedral(code, normal_bits);
        if (range.has(RESIDENT_FLAG_TEXCOORDS)) corner.texcoord = range.texcoord(v);
    }
    corner.chart_entry = entry_of(triangle);
    return corner;
}

uint32_t ResidentMeshView::chart_word(uint32_t triangle) const {
    return words_[entry_of(triangle) + RESIDENT_CHART_WORD];
}

bool ResidentMeshView::dressed(uint32_t triangle) const {
    return place_of(words_, triangle).range.has(RESIDENT_FLAG_DRESSED);
}

void ResidentMeshView::texcoord_base(uint32_t triangle, int32_t out[2]) const {
    const uint32_t entry = entry_of(triangle);
    const bool colour = names_colour(words_[entry + RESIDENT_CHART_WORD]);
    for (uint32_t c = 0; c < 2; ++c)
        out[c] = colour ? 0 : static_cast<int32_t>(frame_of(entry)[RESIDENT_FRAME_BASE_U + c]);
}

void ResidentMeshView::texcoord(uint32_t triangle, uint32_t k, int32_t out[2]) const {
    texcoord_base(triangle, out);
    const uint32_t entry = entry_of(triangle);
    const auto [range, number, t] = place_of(words_, triangle);
    if (names_colour(words_[entry + RESIDENT_CHART_WORD]) || !range.has(RESIDENT_FLAG_TEXCOORDS)) return;
    const uint32_t word = range.texcoord(vertex(number, t, k));
    const uint32_t shifts = frame_of(entry)[RESIDENT_FRAME_SHIFTS];
    for (uint32_t c = 0; c < 2; ++c) {
        const uint32_t offset = (word >> (16 * c) & 0xffff) << (shifts >> (8 * c) & 255);
        out[c] = static_cast<int32_t>(static_cast<uint32_t>(out[c]) + offset);
    }
}

}  // namespace citystream::codec::mesh
