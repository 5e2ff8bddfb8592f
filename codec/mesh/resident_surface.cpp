#include "codec/mesh/resident_surface.h"

#include <algorithm>
#include <span>
#include <unordered_map>

#include "codec/bits/bit_stream.h"
#include "codec/chart_word.h"
#include "codec/mesh/local_strips.h"
#include "codec/mesh/mesh_resident_layout.h"
#include "codec/mesh/strip_code.h"

namespace citystream::codec::mesh {

namespace {

using Corners = std::array<uint32_t, 3>;

constexpr uint32_t kNone = ~uint32_t{0};

/// What vertices of a class hold, as bits.
constexpr size_t kTextured = 1, kSmooth = 2, kClasses = 4;
/// What one draw more counts for, in words of the layer, with the range's own.
constexpr size_t kRangeWords = RESIDENT_RANGE_WORDS + 32;

size_t class_of(const MeshTriangle& triangle) {
    const auto& [a, b, c] = triangle.corners;
    const bool smooth = a.normal != b.normal || a.normal != c.normal;
    return (names_colour(triangle.chart_word) ? 0 : kTextured) | (smooth ? kSmooth : 0);
}

/// Words of vertices that hold more than they need, about two vertices for three triangles.
size_t words_to_join(size_t triangles, size_t from, size_t to) {
    const size_t more = to & ~from;
    const size_t words = ((more & kTextured) != 0 ? 2 : 0) + ((more & kSmooth) != 0 ? 1 : 0);
    return triangles * 2 / 3 * words / 2;
}

/// Which class each joins, itself or one that holds more.
std::array<size_t, kClasses> join_classes(std::array<size_t, kClasses> triangles) {
    std::array<size_t, kClasses> joined = {0, 1, 2, 3};
    for (size_t from = 0; from < kClasses; ++from) {
        size_t best = kRangeWords;
        for (size_t to = from + 1; to < kClasses; ++to) {
            if ((from & ~to) != 0 || triangles[to] == 0) continue;
            const size_t words = words_to_join(triangles[from], from, to);
            if (words >= best) continue;
            best = words;
            joined[from] = to;
        }
        if (joined[from] != from) triangles[joined[from]] += triangles[from];
    }
    for (size_t from = kClasses; from-- > 0;) joined[from] = joined[joined[from]];
    return joined;
}

struct VertexHash {
    size_t operator()(const SurfaceVertex& vertex) const {
        uint64_t hash = vertex.point * 0x9e3779b97f4a7c15u;
        hash = (hash ^ hash >> 32 ^ vertex.texcoord) * 0xd6e8feb86659fd93u;
        hash = (hash ^ hash >> 32 ^ vertex.normal) * 0xd6e8feb86659fd93u;
        return static_cast<size_t>(hash ^ hash >> 32);
    }
};

/// Welds by what the vertices of the range hold.
class RangeMaker {
  public:
    RangeMaker(const ResidentCharts& charts, size_t points, SurfaceRange& range) : charts_(charts), range_(range) {
        if (!range.textured && !range.smooth) by_point_.resize(points, kNone);
    }

    void add(const MeshTriangle& triangle) {
        const uint32_t chart = charts_.number(triangle.chart_word);
        Corners& corners = range_.triangles.emplace_back();
        for (size_t k = 0; k < 3; ++k) {
            const MeshCorner& corner = triangle.corners[k];
            corners[k] = number({corner.point, range_.textured ? charts_.texcoord(chart, corner.texcoord) : 0,
                                 range_.smooth ? corner.normal : 0});
        }
        range_.faces.push_back({chart, range_.smooth ? 0 : triangle.corners[0].normal});
    }

  private:
    uint32_t number(const SurfaceVertex& vertex) {
        const auto next = static_cast<uint32_t>(range_.vertices.size());
        uint32_t& known =
            by_point_.empty() ? numbers_.try_emplace(vertex, kNone).first->second : by_point_[vertex.point];
        if (known == kNone) {
            known = next;
            range_.vertices.push_back(vertex);
        }
        return known;
    }

    const ResidentCharts& charts_;
    SurfaceRange& range_;
    std::vector<uint32_t> by_point_;
    std::unordered_map<SurfaceVertex, uint32_t, VertexHash> numbers_;
};

/// Fields of the indices below `vertices`.
RangeTopology indices_of(std::span<const Corners> triangles, size_t vertices) {
    RangeTopology topology{RESIDENT_KIND_INDICES, {}, bits::bits_for(vertices - 1)};
    bits::BitWriter out;
    for (const Corners& corners : triangles)
        for (const uint32_t vertex : corners) out.put(vertex, topology.index_bits);
    topology.words = out.finish();
    return topology;
}

void reorder_vertices(SurfaceRange& range, std::span<const uint32_t> order) {
    std::vector<SurfaceVertex> vertices;
    vertices.reserve(order.size());
    for (const uint32_t v : order) vertices.push_back(range.vertices[v]);
    range.vertices = std::move(vertices);
}

void reorder_faces(SurfaceRange& range, std::span<const StripTriangle> stream) {
    std::vector<SurfaceFace> faces;
    faces.reserve(stream.size());
    for (const StripTriangle& place : stream) {
        if (place.triangle != kPutIn)
            faces.push_back(range.faces[place.triangle]);
        else
            faces.push_back(faces.empty() ? SurfaceFace{} : SurfaceFace{faces.back()});
    }
    range.faces = std::move(faces);
}

template <typename Strips>
RangeTopology take_strips(SurfaceRange& range, const Strips& strips, uint32_t kind, CornerList triangles) {
    reorder_vertices(range, strips.vertices);
    reorder_faces(range, strips.stream);
    range.triangles = std::move(triangles);
    return {kind, strips.words, 0};
}

}  // namespace

std::vector<SurfaceRange> split_surface(const MeshContent& content, const ResidentCharts& charts) {
    std::array<std::array<size_t, kClasses>, 2> counts{};
    for (const MeshTriangle& triangle : content.triangles) ++counts[triangle.dressed ? 1 : 0][class_of(triangle)];
    const std::array<std::array<size_t, kClasses>, 2> joined = {join_classes(counts[0]), join_classes(counts[1])};
    std::vector<SurfaceRange> ranges;
    for (const bool dressed : {false, true}) {
        for (size_t kind = 0; kind < kClasses; ++kind) {
            SurfaceRange range{dressed, (kind & kTextured) != 0, (kind & kSmooth) != 0, {}, {}, {}};
            RangeMaker maker(charts, content.points.size(), range);
            for (const MeshTriangle& triangle : content.triangles) {
                if (triangle.dressed == dressed && joined[dressed ? 1 : 0][class_of(triangle)] == kind)
                    maker.add(triangle);
            }
            if (!range.triangles.empty()) ranges.push_back(std::move(range));
        }
    }
    return ranges;
}

RangeTopology lay_topology(SurfaceRange& range, MeshTopology wanted) {
    RangeTopology indices = indices_of(range.triangles, range.vertices.size());
    const auto vertices = static_cast<uint32_t>(range.vertices.size());
    if (wanted == MeshTopology::kLocalStrips) {
        const Result<LocalStrips> strips = encode_local_strips(range.triangles, vertices);
        if (strips && strips->words.size() < indices.words.size())
            return take_strips(range, *strips, RESIDENT_KIND_LOCAL_STRIPS, *decode_local_strips(strips->words));
    }
    if (wanted == MeshTopology::kStripCode) {
        const Result<StripCode> strips = encode_strips(range.triangles, vertices);
        if (strips && strips->words.size() < indices.words.size())
            return take_strips(range, *strips, RESIDENT_KIND_STRIP_CODE, *decode_strips(strips->words));
    }
    return indices;
}

}  // namespace citystream::codec::mesh
