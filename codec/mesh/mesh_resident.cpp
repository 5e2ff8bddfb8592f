#include "codec/mesh/mesh_resident.h"

#include <algorithm>
#include <bit>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "codec/bits/bit_stream.h"
#include "codec/chart_word.h"
#include "codec/mesh/binned_buffer.h"
#include "codec/mesh/resident_charts.h"
#include "codec/mesh/resident_prisms.h"
#include "codec/mesh/resident_surface.h"

namespace citystream::codec::mesh {

namespace {

using Corners = std::array<uint32_t, 3>;

constexpr uint64_t kMostPositions = (uint64_t{1} << PRECISION_BIN_LEVEL_SHIFT) - 1;
constexpr uint64_t kMostBits = 0xffffffff;
constexpr uint32_t kNone = ~uint32_t{0};
/// So that a camera's distance to what any layer says stays an int32.
constexpr uint32_t kMostPositionBits = 30;

/// Words = coordinate - origin, cut to `bits`: whatever the content, no word is larger.
struct PositionGrid {
    std::array<int32_t, 3> origin{};
    uint32_t bits = 0;

    uint32_t word(size_t axis, int32_t coordinate) const {
        return (static_cast<uint32_t>(coordinate) - static_cast<uint32_t>(origin[axis])) & ((1u << bits) - 1);
    }
};

/// The smallest grid of the content as its first step has it: later bits change neither origin nor width. On each axis
/// the whole grid, not only what the content says, stays within +-2^(kMostPositionBits - 1).
class GridFinder {
  public:
    explicit GridFinder(uint32_t dropped) : dropped_(dropped) {}

    void add(size_t axis, int32_t coordinate) {
        low_[axis] = std::min(low_[axis], coordinate >> dropped_);
        high_[axis] = std::max(high_[axis], coordinate >> dropped_);
    }
    PositionGrid find() const {
        const uint32_t aligned = std::max<uint32_t>(dropped_, RESIDENT_CELL_BITS);
        constexpr int64_t kLimit = int64_t{1} << (kMostPositionBits - 1);
        PositionGrid grid;
        uint64_t most = 1;
        for (size_t axis = 0; axis < 3; ++axis) {
            if (low_[axis] > high_[axis]) continue;
            const int64_t low = std::clamp(int64_t{low_[axis]} * (int64_t{1} << dropped_), -kLimit, kLimit - 1);
            const int64_t high = (int64_t{high_[axis]} + 1) * (int64_t{1} << dropped_) - 1;
            const int64_t origin = (low >> aligned) * (int64_t{1} << aligned);
            grid.origin[axis] = static_cast<int32_t>(origin);
            most = std::max(most, static_cast<uint64_t>(std::clamp(high, low, kLimit - 1) - origin));
        }
        grid.bits = std::min(bits::bits_for(most), kMostPositionBits);
        const int64_t greatest_origin = kLimit - (int64_t{1} << std::max(grid.bits, aligned));
        for (int32_t& origin : grid.origin) origin = static_cast<int32_t>(std::min<int64_t>(origin, greatest_origin));
        return grid;
    }

  private:
    uint32_t dropped_;
    std::array<int32_t, 3> low_ = {INT32_MAX, INT32_MAX, INT32_MAX}, high_ = {INT32_MIN, INT32_MIN, INT32_MIN};
};

PositionGrid find_grid(const MeshContent& content) {
    GridFinder finder(content.dropped[0]);
    for (const GridPoint& point : content.points)
        for (size_t axis = 0; axis < 3; ++axis) finder.add(axis, point[axis]);
    for (const MeshPrism& prism : content.prisms) {
        finder.add(2, prism.shape.base);
        finder.add(2, prism.shape.top);
        for (const PrismWall& wall : prism.shape.walls) finder.add(2, wall.base);
        for (const Ring& ring : prism.shape.rings)
            for (const auto& point : ring.points)
                for (size_t axis = 0; axis < 2; ++axis) finder.add(axis, point[axis]);
    }
    return finder.find();
}

/// Writes the words range by range.
class ResidentWriter {
  public:
    explicit ResidentWriter(const MeshContent& content)
        : content_(content), grid_(find_grid(content)), charts_(content) {}

    ResidentMesh write() {
        shape_positions();
        const uint32_t finest = grid_.bits - std::min(grid_.bits, content_.dropped.back());
        const std::vector<PrismGroup> groups = group_prisms(content_, finest);
        std::vector<SurfaceRange> surfaces = split_surface(content_, charts_);
        if (!fits(groups, surfaces)) return {};
        mesh_.words.resize(RESIDENT_HEADER_WORDS + RESIDENT_RANGE_WORDS * (groups.size() + surfaces.size()));
        header_[RESIDENT_WORD_CHART_TABLE] = append(charts_.words());
        for (const PrismGroup& group : groups) write_prisms(group);
        if (!content_.most_dropped.empty()) pool_points(surfaces);
        for (SurfaceRange& surface : surfaces) write_surface(surface);
        header_[RESIDENT_WORD_FACE_TABLE] = append(faces_.words(chart_bits(), code_bits()));
        mesh_.shape.vertices = static_cast<uint32_t>(mesh_.position_words.size());
        write_header();
        return fits_bits() ? std::move(mesh_) : ResidentMesh{};
    }

  private:
    void shape_positions() {
        mesh_.shape.components = 1;
        mesh_.shape.full_bits = grid_.bits;
        mesh_.shape.bins = {{0, level_at_drop(kMeshGridBits)}};
        for (const uint32_t dropped : content_.dropped) mesh_.levels.push_back(level_at_drop(dropped));
    }
    uint32_t level_at_drop(uint32_t dropped) const { return grid_.bits - std::min(grid_.bits, dropped); }
    uint32_t chart_bits() const { return bits::bits_for(std::max(charts_.count(), 1u) - 1); }
    uint32_t code_bits() const { return 2 * content_.normal_bits; }

    /// Sizes whose fields might pass 2^32 bits, or positions their buffer.
    bool fits(std::span<const PrismGroup> groups, std::span<const SurfaceRange> surfaces) const {
        uint64_t positions = 0, triangles = 0;
        for (const PrismGroup& group : groups) {
            if (group.points > 0xffff) return false;
            positions += group.record_words() * group.prisms.size();
            triangles += group.triangles() * group.prisms.size();
        }
        for (const SurfaceRange& surface : surfaces) {
            positions += 3 * surface.vertices.size();
            triangles += surface.triangles.size();
        }
        // A strip code puts in up to four triangles for each; an index has up to 27 bits.
        return positions <= kMostPositions && triangles * 5 * 3 * 27 <= kMostBits &&
               positions * grid_.bits <= kMostBits;
    }
    bool fits_bits() const { return uint64_t{32} * mesh_.words.size() <= kMostBits && check_shape(mesh_.shape).ok(); }

    uint32_t here() const { return static_cast<uint32_t>(mesh_.words.size()); }
    uint32_t append(std::span<const uint32_t> words) {
        const uint32_t begin = here();
        mesh_.words.insert(mesh_.words.end(), words.begin(), words.end());
        return begin;
    }
    uint32_t append(bits::BitWriter& fields) { return append(fields.finish()); }
    uint32_t append_fields(std::span<const uint32_t> values, uint32_t bits) {
        bits::BitWriter fields;
        for (const uint32_t value : values) fields.put(value, bits);
        return append(fields);
    }

    using RangeWords = std::array<uint32_t, RESIDENT_RANGE_WORDS>;
    RangeWords new_range(uint32_t kind, uint32_t flags, uint32_t points) const {
        RangeWords range{};
        range[RESIDENT_RANGE_KIND] = kind | flags << 8 | points << 16;
        range[RESIDENT_RANGE_FIRST_TRIANGLE] = triangles_;
        range[RESIDENT_RANGE_FIRST_POSITION] = static_cast<uint32_t>(mesh_.position_words.size());
        return range;
    }
    void finish_range(RangeWords& range, uint64_t triangles) {
        range[RESIDENT_RANGE_TRIANGLES] = static_cast<uint32_t>(triangles);
        const size_t at = RESIDENT_HEADER_WORDS + RESIDENT_RANGE_WORDS * mesh_.ranges.size();
        std::copy(range.begin(), range.end(), mesh_.words.begin() + static_cast<ptrdiff_t>(at));
        const uint32_t kind = range[RESIDENT_RANGE_KIND];
        mesh_.ranges.push_back({range[RESIDENT_RANGE_TRIANGLES], kind & 255, (kind >> 8 & RESIDENT_FLAG_DRESSED) != 0,
                                range[RESIDENT_RANGE_TOPOLOGY], range[RESIDENT_RANGE_TOPOLOGY_WORDS], kind >> 8 & 255});
        triangles_ += range[RESIDENT_RANGE_TRIANGLES];
    }

    void put_position(size_t axis, int32_t coordinate) { mesh_.position_words.push_back(grid_.word(axis, coordinate)); }
    void put_record(const PrismRecord& record, bool wall_bases) {
        put_position(2, record.base);
        put_position(2, record.top);
        for (const auto& point : record.points) {
            put_position(0, point[0]);
            put_position(1, point[1]);
        }
        if (!wall_bases) return;
        for (const int32_t base : record.wall_bases) put_position(2, base);
    }
    void put_point(uint32_t point) {
        for (size_t axis = 0; axis < 3; ++axis) put_position(axis, content_.points[point][axis]);
    }

    void write_prisms(const PrismGroup& group) {
        const uint32_t flags =
            (group.wall_bases ? RESIDENT_FLAG_WALL_BASES : 0) | (group.floors ? RESIDENT_FLAG_FLOORS : 0);
        RangeWords range = new_range(RESIDENT_KIND_PRISMS, flags, group.points);
        std::map<std::vector<Corners>, uint32_t> numbers;
        std::vector<uint32_t> tops;
        bits::BitWriter rows;
        const uint32_t index_bits = bits::bits_for(group.points - 1);
        for (const uint32_t prism : group.prisms) {
            PrismRecord record = prism_record(content_.prisms[prism].shape, content_.dropped[0], group.points);
            put_record(record, group.wall_bases);
            const auto next = static_cast<uint32_t>(numbers.size());
            const auto [at, added] = numbers.try_emplace(std::move(record.top_triangles), next);
            tops.push_back(at->second);
            if (!added) continue;
            for (const Corners& corners : at->first)
                for (const uint32_t corner : corners) rows.put(corner, index_bits);
        }
        const uint32_t top_bits = bits::bits_for(numbers.size() - 1);
        range[RESIDENT_RANGE_TOPOLOGY] = append(rows);
        range[RESIDENT_RANGE_TOPOLOGY_WORDS] = here() - range[RESIDENT_RANGE_TOPOLOGY];
        const uint32_t face_bits = write_prism_faces(group, tops, top_bits, range);
        range[RESIDENT_RANGE_BITS] = index_bits | face_bits << 8 | top_bits << 16;
        range[RESIDENT_RANGE_VERTICES] = static_cast<uint32_t>(group.prisms.size());
        finish_range(range, group.triangles() * group.prisms.size());
    }

    /// Of each prism: number of its top, colours of walls, top and floor. Returns the bits of a colour.
    uint32_t write_prism_faces(const PrismGroup& group, std::span<const uint32_t> tops, uint32_t top_bits,
                               RangeWords& range) {
        std::vector<uint32_t> colours;
        for (const uint32_t prism : group.prisms) {
            const MeshPrism& shown = content_.prisms[prism];
            colours.push_back(charts_.number(shown.wall_chart) - charts_.images());
            colours.push_back(charts_.number(shown.top_chart) - charts_.images());
            if (group.floors) colours.push_back(charts_.number(shown.floor_chart) - charts_.images());
        }
        const uint32_t face_bits = bits::bits_for(*std::max_element(colours.begin(), colours.end()));
        const size_t each = group.floors ? 3 : 2;
        bits::BitWriter fields;
        for (size_t i = 0; i < tops.size(); ++i) {
            fields.put(tops[i], top_bits);
            for (size_t c = 0; c < each; ++c) fields.put(colours[each * i + c], face_bits);
        }
        range[RESIDENT_RANGE_FACES] = append(fields);
        return face_bits;
    }

    static uint32_t flags_of(const SurfaceRange& surface) {
        return (surface.dressed ? RESIDENT_FLAG_DRESSED : 0) | (surface.textured ? RESIDENT_FLAG_TEXCOORDS : 0) |
               (surface.smooth ? RESIDENT_FLAG_NORMALS : 0);
    }
    /// With as many bits as the range needs: whole pictures on walls have two places along each axis.
    void write_texcoords(std::span<const SurfaceVertex> vertices, RangeWords& range) {
        uint32_t any = 0;
        for (const SurfaceVertex& vertex : vertices) any |= vertex.texcoord;
        std::array<uint32_t, 2> zeros{}, size{};
        for (size_t c = 0; c < 2; ++c) {
            const uint32_t axis = any >> (16 * c) & 0xffff;
            zeros[c] = axis == 0 ? 0 : static_cast<uint32_t>(std::countr_zero(axis));
            size[c] = bits::bits_for(axis >> zeros[c]);
            range[RESIDENT_RANGE_KIND] |= size[c] << (16 + 8 * c);
            range[RESIDENT_RANGE_BITS] |= zeros[c] << (24 + 4 * c);
        }
        bits::BitWriter fields;
        for (const SurfaceVertex& vertex : vertices)
            for (size_t c = 0; c < 2; ++c) fields.put((vertex.texcoord >> (16 * c) & 0xffff) >> zeros[c], size[c]);
        range[RESIDENT_RANGE_TEXCOORDS] = append(fields);
    }
    void write_attributes(const SurfaceRange& surface, RangeWords& range) {
        if (surface.textured) write_texcoords(surface.vertices, range);
        if (!surface.smooth) return;
        bits::BitWriter codes;
        for (const SurfaceVertex& vertex : surface.vertices) codes.put(vertex.normal, code_bits());
        range[RESIDENT_RANGE_NORMALS] = append(codes);
    }
    /// All but vertices.
    void write_triangles(const SurfaceRange& surface, const RangeTopology& topology, RangeWords& range) {
        range[RESIDENT_RANGE_TOPOLOGY] = append(topology.words);
        range[RESIDENT_RANGE_TOPOLOGY_WORDS] = static_cast<uint32_t>(topology.words.size());
        if (surface.smooth)
            write_charts(surface, range);
        else if (runs_are_smaller(surface.faces))
            write_runs(surface.faces, range);
        else
            write_face_numbers(surface.faces, range);
        finish_range(range, surface.triangles.size());
    }
    void write_face_fields(std::span<const uint32_t> fields, RangeWords& range) {
        const uint32_t face_bits = bits::bits_for(*std::max_element(fields.begin(), fields.end()));
        range[RESIDENT_RANGE_BITS] |= face_bits << 8;
        range[RESIDENT_RANGE_FACES] = append_fields(fields, face_bits);
    }
    void write_charts(const SurfaceRange& surface, RangeWords& range) {
        std::vector<uint32_t> charts;
        for (const SurfaceFace& face : surface.faces)
            charts.push_back(surface.textured ? face.chart : face.chart - charts_.images());
        write_face_fields(charts, range);
    }
    void write_face_numbers(std::span<const SurfaceFace> faces, RangeWords& range) {
        std::vector<uint32_t> numbers;
        for (const SurfaceFace& face : faces) numbers.push_back(faces_.number(face));
        write_face_fields(numbers, range);
    }
    /// Against a number a triangle and each new face once.
    bool runs_are_smaller(std::span<const SurfaceFace> faces) const {
        std::set<SurfaceFace> fresh;
        uint64_t runs = 1;
        for (size_t t = 0; t < faces.size(); ++t) {
            runs += t > 0 && faces[t] != faces[t - 1] ? 1 : 0;
            if (!faces_.contains(faces[t])) fresh.insert(faces[t]);
        }
        const uint64_t entry = chart_bits() + code_bits();
        const uint64_t numbers = faces.size() * bits::bits_for(faces_.count() + fresh.size() - 1);
        return (faces.size() + 31) / 32 * 32 * RESIDENT_RUN_WORDS + runs * entry < numbers + fresh.size() * entry;
    }
    void write_runs(std::span<const SurfaceFace> faces, RangeWords& range) {
        range[RESIDENT_RANGE_KIND] |= RESIDENT_FLAG_RUNS << 8;
        range[RESIDENT_RANGE_FACES] = here();
        for (size_t t = 0; t < faces.size(); ++t) {
            const bool begins = t == 0 || faces[t] != faces[t - 1];
            if (begins) faces_.append(faces[t]);
            if (t % 32 == 0) {
                mesh_.words.push_back(0);
                mesh_.words.push_back(faces_.count() - 1);
            } else if (begins) {
                mesh_.words[mesh_.words.size() - RESIDENT_RUN_WORDS + RESIDENT_RUN_BEGINS] |= 1u << t % 32;
            }
        }
    }

    void write_surface(SurfaceRange& surface) {
        const RangeTopology topology = lay_topology(surface, content_.topology);
        RangeWords range = new_range(topology.kind, flags_of(surface), 0);
        range[RESIDENT_RANGE_VERTICES] = static_cast<uint32_t>(surface.vertices.size());
        range[RESIDENT_RANGE_BITS] = topology.index_bits;
        if (pool_.empty())
            write_points(surface, range);
        else
            write_pooled(surface, range);
        write_attributes(surface, range);
        write_triangles(surface, topology, range);
    }

    /// Each point once and a number a vertex where that takes less, else each vertex with a point of its own.
    void write_points(const SurfaceRange& surface, RangeWords& range) {
        std::vector<uint32_t> numbers, points;
        if (surface.textured || surface.smooth) {
            std::vector<uint32_t> number_of(content_.points.size(), kNone);
            for (const SurfaceVertex& vertex : surface.vertices) {
                uint32_t& number = number_of[vertex.point];
                if (number == kNone) {
                    number = static_cast<uint32_t>(points.size());
                    points.push_back(vertex.point);
                }
                numbers.push_back(number);
            }
            const uint64_t each = uint64_t{3} * level_at_drop(content_.dropped.back());
            const uint64_t shared = points.size() * each + numbers.size() * bits::bits_for(points.size() - 1);
            if (shared < numbers.size() * each / 8 * 7) {
                for (const uint32_t point : points) put_point(point);
                name_points(numbers, range);
                return;
            }
        }
        for (const SurfaceVertex& vertex : surface.vertices) put_point(vertex.point);
    }
    void name_points(std::span<const uint32_t> numbers, RangeWords& range) {
        const uint32_t point_bits = bits::bits_for(*std::max_element(numbers.begin(), numbers.end()));
        range[RESIDENT_RANGE_KIND] |= RESIDENT_FLAG_POINTS << 8;
        range[RESIDENT_RANGE_BITS] |= point_bits << 16;
        range[RESIDENT_RANGE_POINTS] = append_fields(numbers, point_bits);
    }

    /// Constrained precision: the points of all ranges in one order, by least level.
    void pool_points(std::span<const SurfaceRange> surfaces) {
        pool_.assign(content_.points.size(), kNone);
        pool_begin_ = static_cast<uint32_t>(mesh_.position_words.size());
        std::vector<uint32_t> points, levels;
        for (const SurfaceRange& surface : surfaces) {
            for (const SurfaceVertex& vertex : surface.vertices) {
                if (std::exchange(pool_[vertex.point], 0) != kNone) continue;
                points.push_back(vertex.point);
                levels.push_back(level_at_drop(std::min<uint32_t>(content_.most_dropped[vertex.point], kMeshGridBits)));
            }
        }
        uint32_t number = 0;
        for (const uint32_t i : order_by_level(levels)) {
            begin_bin(levels[i]);
            put_point(points[i]);
            pool_[points[i]] = number++;
        }
    }
    void write_pooled(const SurfaceRange& surface, RangeWords& range) {
        std::vector<uint32_t> numbers;
        for (const SurfaceVertex& vertex : surface.vertices) numbers.push_back(pool_[vertex.point]);
        range[RESIDENT_RANGE_FIRST_POSITION] = pool_begin_;
        name_points(numbers, range);
    }
    /// A position of that least level follows.
    void begin_bin(uint32_t level) {
        const auto begin = static_cast<uint32_t>(mesh_.position_words.size());
        std::vector<PrecisionBin>& bins = mesh_.shape.bins;
        if (begin == 0)
            bins = {{0, level}};
        else if (level > bins.back().least_level)
            bins.push_back({begin, level});
    }

    void write_header() {
        header_[RESIDENT_WORD_MAGIC] = RESIDENT_MAGIC;
        header_[RESIDENT_WORD_RANGES] = static_cast<uint32_t>(mesh_.ranges.size());
        header_[RESIDENT_WORD_TRIANGLES] = triangles_;
        for (size_t axis = 0; axis < 3; ++axis)
            header_[RESIDENT_WORD_ORIGIN_X + axis] = static_cast<uint32_t>(grid_.origin[axis] - kMeshBias);
        header_[RESIDENT_WORD_POSITIONS] = here();
        header_[RESIDENT_WORD_CHARTS] = charts_.count();
        header_[RESIDENT_WORD_IMAGES] = charts_.images();
        header_[RESIDENT_WORD_FACES] = faces_.count();
        header_[RESIDENT_WORD_BITS] = content_.normal_bits | chart_bits() << 8;
        const std::array<uint32_t, 3> frame = charts_.frame();
        std::copy(frame.begin(), frame.end(), header_.begin() + RESIDENT_WORD_FRAME);
        std::copy(header_.begin(), header_.end(), mesh_.words.begin());
    }

    const MeshContent& content_;
    const PositionGrid grid_;
    const ResidentCharts charts_;
    ResidentFaces faces_;
    ResidentMesh mesh_;
    std::array<uint32_t, RESIDENT_HEADER_WORDS> header_{};
    uint32_t triangles_ = 0;
    std::vector<uint32_t> pool_;  ///< of constrained precision: the number of each point of the content
    uint32_t pool_begin_ = 0;
};

}  // namespace

Status check_charts(const MeshContent& content, uint32_t atlas_chart_count) {
    const auto is_colour = [](uint32_t word) { return names_colour(word) && is_chart_word(word, 0); };
    for (const MeshPrism& prism : content.prisms) {
        if (!is_colour(prism.wall_chart) || !is_colour(prism.top_chart) ||
            (prism.shape.has_floor && !is_colour(prism.floor_chart)))
            return Error{"mesh: a prism shows no colour"};
    }
    for (const MeshTriangle& triangle : content.triangles)
        if (!is_chart_word(triangle.chart_word, atlas_chart_count))
            return Error{"mesh: chart " + std::to_string(triangle.chart_word) + ", but there are only " +
                         std::to_string(atlas_chart_count)};
    return Done{};
}

ResidentMesh make_resident(const MeshContent& content) {
    return ResidentWriter(content).write();
}

std::vector<uint32_t> ResidentMesh::with_steps(uint32_t steps) const {
    std::vector<uint32_t> all = words;
    const std::vector<uint32_t> positions = pack_precision(shape, position_words, levels[steps - 1]);
    all.insert(all.end(), positions.begin(), positions.end());
    return all;
}

std::vector<uint32_t> ResidentMesh::planes(uint32_t from, uint32_t to) const {
    std::vector<uint32_t> planes;
    for (uint32_t plane = levels[from - 1]; plane < levels[to - 1]; ++plane) {
        const std::vector<uint32_t> bits = precision_plane(shape, position_words, plane);
        planes.insert(planes.end(), bits.begin(), bits.end());
    }
    return planes;
}

uint64_t ResidentMesh::added_words(uint32_t step) const {
    const uint64_t now = shape.words_at(levels[step]);
    return step == 0 ? words.size() + now : now - shape.words_at(levels[step - 1]);
}

}  // namespace citystream::codec::mesh
