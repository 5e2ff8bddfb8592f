#include "codec/mesh/mesh_resident_check.h"

#include <algorithm>
#include <bit>

#include "codec/chart_word.h"
#include "codec/mesh/local_strips.h"
#include "codec/mesh/local_strips_layout.h"
#include "codec/mesh/mesh_content.h"
#include "codec/mesh/resident_range.h"
#include "codec/mesh/strip_code.h"

namespace citystream::codec::mesh {

namespace {

constexpr int64_t kCoordinateLimit = int64_t{1} << 30;
constexpr uint64_t kMostBits = 0xffffffff;
constexpr uint32_t kMostFieldBits = 32, kMostShift = 16;
constexpr uint32_t kMostTriangles = 1u << 30;  ///< three corners each are counted in 32 bits

class Checker {
  public:
    Checker(std::span<const uint32_t> words, uint32_t atlas_chart_count) : words_(words), atlas_(atlas_chart_count) {}

    Result<CheckedResident> check() {
        if (!header_fits()) return Error{"mesh layer: header", 0};
        Result<PrecisionView> positions = PrecisionView::create(words_.subspan(end_));
        if (!positions) return positions.error();
        checked_.positions = std::move(*positions);
        if (!positions_fit()) return Error{"mesh layer: grid of positions", 4 * end_};
        if (!charts_fit()) return Error{"mesh layer: charts", uint64_t{4} * words_[RESIDENT_WORD_CHART_TABLE]};
        if (!faces_fit()) return Error{"mesh layer: faces", uint64_t{4} * words_[RESIDENT_WORD_FACE_TABLE]};
        uint64_t triangles = 0;
        for (uint32_t r = 0; r < words_[RESIDENT_WORD_RANGES]; ++r) {
            const ResidentRange range(words_, r);
            checked_.strips.emplace_back();
            if (range.first_triangle != triangles || !range_fits(range, r))
                return Error{"mesh layer: range", 4 * (RESIDENT_HEADER_WORDS + uint64_t{r} * RESIDENT_RANGE_WORDS)};
            triangles += range.triangles;
        }
        if (triangles != words_[RESIDENT_WORD_TRIANGLES])
            return Error{"mesh layer: triangles", 4 * RESIDENT_WORD_TRIANGLES};
        return std::move(checked_);
    }

  private:
    bool fields_fit(uint32_t offset, uint64_t count, uint64_t bits) const {
        if (bits == 0 || count == 0) return true;
        if (count > kMostBits / bits) return false;
        return offset <= end_ && (count * bits + 31) / 32 <= end_ - offset;
    }
    uint32_t field(uint32_t offset, uint64_t bit, uint32_t bits) const {
        return bits == 0 ? 0 : bits::read_bits(words_.subspan(offset), bit, bits);
    }

    bool header_fits() {
        if (words_.size() < RESIDENT_HEADER_WORDS || words_[RESIDENT_WORD_MAGIC] != RESIDENT_MAGIC) return false;
        end_ = words_[RESIDENT_WORD_POSITIONS];
        const uint64_t tables = RESIDENT_HEADER_WORDS + uint64_t{words_[RESIDENT_WORD_RANGES]} * RESIDENT_RANGE_WORDS;
        const uint32_t bits = words_[RESIDENT_WORD_BITS];
        normal_bits_ = bits & 255;
        face_chart_bits_ = bits >> 8;
        return end_ <= words_.size() && tables <= end_ && 32 * end_ <= kMostBits &&
               normal_bits_ >= kLeastMeshNormalBits && normal_bits_ <= kMostMeshNormalBits &&
               face_chart_bits_ < kMostFieldBits;
    }

    bool positions_fit() const {
        const PrecisionShape& shape = checked_.positions.shape();
        if (shape.components != 1 || shape.leading[0] != 0) return false;
        const int64_t extent = int64_t{1} << std::max<uint32_t>(shape.full_bits, RESIDENT_CELL_BITS);
        for (size_t axis = 0; axis < 3; ++axis) {
            const auto origin = static_cast<int32_t>(words_[RESIDENT_WORD_ORIGIN_X + axis]);
            if (origin < -kCoordinateLimit || origin + extent > kCoordinateLimit) return false;
        }
        return true;
    }

    bool charts_fit() const {
        const uint64_t charts = words_[RESIDENT_WORD_CHARTS], images = words_[RESIDENT_WORD_IMAGES];
        const uint32_t at = words_[RESIDENT_WORD_CHART_TABLE];
        const bool own_frames = words_[RESIDENT_WORD_FRAME + RESIDENT_FRAME_SHIFTS] == RESIDENT_FRAMES_OF_THEIR_OWN;
        const uint64_t image_words = own_frames ? 1 + RESIDENT_FRAME_WORDS : 1;
        if (images > charts || !fields_fit(at, charts - images + images * image_words, 32)) return false;
        if (!own_frames && !frame_fits(words_.subspan(RESIDENT_WORD_FRAME))) return false;
        const auto table = words_.subspan(charts > 0 ? at : 0);
        for (uint64_t i = 0; i < charts; ++i) {
            const bool image = i < images;
            const auto entry = table.subspan(image ? i * image_words : images * (image_words - 1) + i);
            if (!is_chart_word(entry[RESIDENT_CHART_WORD], atlas_) || names_colour(entry[RESIDENT_CHART_WORD]) == image)
                return false;
            if (image && own_frames && !frame_fits(entry.subspan(RESIDENT_CHART_FRAME))) return false;
        }
        return true;
    }
    static bool frame_fits(std::span<const uint32_t> frame) {
        const uint32_t u = frame[RESIDENT_FRAME_SHIFTS] & 255, v = frame[RESIDENT_FRAME_SHIFTS] >> 8;
        return u <= kMostShift && v <= kMostShift;
    }

    bool faces_fit() const {
        const uint32_t faces = words_[RESIDENT_WORD_FACES], at = words_[RESIDENT_WORD_FACE_TABLE];
        const uint32_t bits = face_chart_bits_ + 2 * normal_bits_;
        if (!fields_fit(at, faces, bits)) return false;
        for (uint64_t i = 0; i < faces; ++i)
            if (field(at, i * bits, face_chart_bits_) >= words_[RESIDENT_WORD_CHARTS]) return false;
        return true;
    }

    uint32_t colours() const { return words_[RESIDENT_WORD_CHARTS] - words_[RESIDENT_WORD_IMAGES]; }

    bool range_fits(const ResidentRange& range, uint32_t number) {
        if (range.triangles == 0 || range.triangles > kMostTriangles || range.vertices == 0 ||
            range.index_bits > kMostFieldBits || range.face_bits > kMostFieldBits || range.top_bits > kMostFieldBits)
            return false;
        if (!fields_fit(range.topology, range.topology_words, 32)) return false;
        if (range.kind == RESIDENT_KIND_PRISMS) return prisms_fit(range);
        constexpr uint32_t kFlags = RESIDENT_FLAG_DRESSED | RESIDENT_FLAG_TEXCOORDS | RESIDENT_FLAG_NORMALS |
                                    RESIDENT_FLAG_POINTS | RESIDENT_FLAG_RUNS;
        return texcoords_fit(range) && (range.flags & ~kFlags) == 0 && vertices_fit(range) &&
               topology_fits(range, number) && face_fields_fit(range);
    }

    bool prisms_fit(const ResidentRange& range) const {
        constexpr uint32_t kFlags = RESIDENT_FLAG_WALL_BASES | RESIDENT_FLAG_FLOORS;
        if (range.points < 3 || (range.flags & ~kFlags) != 0) return false;
        if (range.vertices * range.prism_triangles() != range.triangles) return false;
        const PrecisionShape& shape = checked_.positions.shape();
        if (range.first_position + range.vertices * range.record_words() > shape.bin_end(0)) return false;
        if (!fields_fit(range.faces, range.vertices, range.prism_field_bits())) return false;
        uint64_t rows = 0;
        // Fields without bits are all the same.
        const uint32_t distinct = range.prism_field_bits() == 0 ? 1 : range.vertices;
        for (uint32_t prism = 0; prism < distinct; ++prism) {
            rows = std::max(rows, uint64_t{range.prism_top(prism)} + 1);
            for (uint32_t part = 0; part < range.prism_colours(); ++part)
                if (range.prism_colour(prism, part) >= colours()) return false;
        }
        if (range.row_bits() > kMostBits || !fields_fit(0, rows, range.row_bits())) return false;
        if (rows * range.row_bits() > uint64_t{32} * range.topology_words) return false;
        if (range.index_bits == 0) return true;
        const uint64_t corners = rows * (range.points - 2) * 3;
        for (uint64_t i = 0; i < corners; ++i)
            if (range.index(i) >= range.points) return false;
        return true;
    }

    bool texcoords_fit(const ResidentRange& range) const {
        uint32_t bits = 0;
        for (size_t c = 0; c < 2; ++c) {
            if (range.texcoord_bits[c] + range.texcoord_zeros[c] > 16) return false;
            bits += range.texcoord_bits[c];
        }
        return range.has(RESIDENT_FLAG_TEXCOORDS) ? fields_fit(range.texcoords, range.vertices, bits) : bits == 0;
    }

    /// One more than the greatest point of a vertex.
    static uint64_t points_of(const ResidentRange& range) {
        if (!range.has(RESIDENT_FLAG_POINTS)) return range.vertices;
        uint64_t points = 0;
        const uint32_t distinct = range.top_bits == 0 ? 1 : range.vertices;
        for (uint32_t v = 0; v < distinct; ++v) points = std::max(points, uint64_t{range.point(v)} + 1);
        return points;
    }

    /// Positions, none of which is split by the beginning of a bin, texture coordinates and normals.
    bool vertices_fit(const ResidentRange& range) const {
        const PrecisionShape& shape = checked_.positions.shape();
        if (!fields_fit(range.points_of_vertices, range.vertices, range.has(RESIDENT_FLAG_POINTS) ? range.top_bits : 0))
            return false;
        if (range.first_position + 3 * points_of(range) > shape.vertices) return false;
        for (const PrecisionBin& bin : shape.bins)
            if (bin.first_vertex > range.first_position && (bin.first_vertex - range.first_position) % 3 != 0)
                return false;
        return (!range.has(RESIDENT_FLAG_NORMALS) || fields_fit(range.normals, range.vertices, 2 * normal_bits_));
    }

    bool topology_fits(const ResidentRange& range, uint32_t number) {
        const std::span<const uint32_t> topology =
            range.topology_words > 0 ? range.topology_span() : std::span<const uint32_t>{};
        if (range.kind == RESIDENT_KIND_INDICES) {
            const uint64_t corners = uint64_t{3} * range.triangles;
            if (corners * range.index_bits > uint64_t{32} * range.topology_words ||
                !fields_fit(range.topology, corners, range.index_bits))
                return false;
            const uint64_t distinct = range.index_bits == 0 ? 1 : corners;
            for (uint64_t corner = 0; corner < distinct; ++corner)
                if (range.index(corner) >= range.vertices) return false;
            return true;
        }
        if (range.kind == RESIDENT_KIND_LOCAL_STRIPS) {
            return check_local_strips(topology).ok() && topology[LOCAL_STRIPS_WORD_TRIANGLES] == range.triangles &&
                   topology[LOCAL_STRIPS_WORD_VERTICES] <= range.vertices;
        }
        if (range.kind != RESIDENT_KIND_STRIP_CODE) return false;
        const Result<StripHeader> header = read_strip_header(topology);
        if (!header || header->triangles != range.triangles || header->vertices > range.vertices) return false;
        Result<CornerList> corners = decode_strips(topology);
        if (!corners) return false;
        checked_.strips[number] = std::move(*corners);
        return true;
    }

    bool runs_fit(const ResidentRange& range) const {
        const uint32_t blocks = (range.triangles + 31) / 32;
        if (range.has(RESIDENT_FLAG_NORMALS) || !fields_fit(range.faces, blocks, 32 * RESIDENT_RUN_WORDS)) return false;
        for (uint32_t block = 0; block < blocks; ++block) {
            const auto run = words_.subspan(range.faces + size_t{block} * RESIDENT_RUN_WORDS, RESIDENT_RUN_WORDS);
            const auto begun = static_cast<uint32_t>(std::popcount(run[RESIDENT_RUN_BEGINS]));
            if (uint64_t{run[RESIDENT_RUN_FACE]} + begun >= words_[RESIDENT_WORD_FACES]) return false;
        }
        return true;
    }

    bool face_fields_fit(const ResidentRange& range) const {
        if (range.has(RESIDENT_FLAG_RUNS)) return runs_fit(range);
        if (!fields_fit(range.faces, range.triangles, range.face_bits)) return false;
        const uint32_t charts = range.has(RESIDENT_FLAG_TEXCOORDS) ? words_[RESIDENT_WORD_CHARTS] : colours();
        const uint32_t most = range.has(RESIDENT_FLAG_NORMALS) ? charts : words_[RESIDENT_WORD_FACES];
        const uint32_t fields = range.face_bits == 0 ? 1 : range.triangles;
        for (uint32_t i = 0; i < fields; ++i)
            if (range.face(i) >= most) return false;
        return true;
    }

    std::span<const uint32_t> words_;
    uint32_t atlas_;
    uint64_t end_ = 0;  ///< where the positions begin
    uint32_t normal_bits_ = 0, face_chart_bits_ = 0;
    CheckedResident checked_;
};

}  // namespace

Result<CheckedResident> check_resident(std::span<const uint32_t> words, uint32_t atlas_chart_count) {
    return Checker(words, atlas_chart_count).check();
}

}  // namespace citystream::codec::mesh
