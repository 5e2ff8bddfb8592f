#include "codec/mesh/mesh_attributes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <map>

#include "codec/chart_word.h"
#include "codec/mesh/chart_word_code.h"
#include "codec/mesh/corner_normals.h"
#include "codec/mesh/edge_neighbours.h"
#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_residual.h"
#include "codec/mesh/place_predictor.h"
#include "codec/mesh/texcoord_code.h"

namespace citystream::codec::mesh {

namespace {

constexpr uint32_t kNone = EdgeNeighbours::kNone;

Vector difference(const GridPoint& a, const GridPoint& b) {
    return {double{1} * a[0] - b[0], double{1} * a[1] - b[1], double{1} * a[2] - b[2]};
}
Vector cross(const Vector& a, const Vector& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double dot(const Vector& a, const Vector& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Where a triangle faces, by its first corner's normal.
enum Facing : uint32_t { kAside, kUp, kDown, kAslant, kFacings };
Facing facing_of(uint32_t normal, uint32_t bits) {
    const auto direction = unfold_octahedral(normal, bits);
    if (direction[2] == 0) return kAside;
    if (direction[0] == 0 && direction[1] == 0) return direction[2] > 0 ? kUp : kDown;
    return kAslant;
}

/// Least, greatest or between, of three numbers.
uint32_t side_of(double value, double low, double high) {
    const double margin = (high - low) / 8;
    return value <= low + margin ? 0 : value >= high - margin ? 1 : 2;
}

/// Both directions: a writer is given triangles, a reader fills them.
template <typename Coder>
class AttributeCoder {
  public:
    AttributeCoder(Coder& coder, const GridMesh& mesh, uint32_t normal_bits, std::span<MeshTriangle> triangles)
        : coder_(coder),
          mesh_(mesh),
          normal_bits_(normal_bits),
          triangles_(triangles),
          neighbours_(mesh.points.size()) {
        last_word_.fill(ChartWordCode::kNone);
        if constexpr (!Coder::kDecodes) find_common_bits();
    }
    AttributeBits code() {
        for (uint32_t t = 0; t < triangles_.size() && going_on(); ++t) {
            look_around(t);
            code_dressed(triangles_[t]);
            code_word(triangles_[t]);
            if (!names_colour(triangles_[t].chart_word)) code_texcoords(t);
            neighbours_.add(mesh_.triangles[t]);
        }
        return bits_;
    }

  private:
    /// An earlier triangle beyond an edge of the one in hand.
    struct Beside {
        uint32_t corner = kNone;  ///< of that triangle: the start of its edge
        bool in_plane = false;
    };
    bool going_on() const {
        if constexpr (Coder::kDecodes) return coder_.ok();
        return true;
    }
    double cost() const {
        if constexpr (Coder::kDecodes)
            return 0;
        else
            return coder_.cost();
    }
    bool is_flat(const MeshTriangle& t) const {
        return t.corners[0].normal == t.corners[1].normal && t.corners[1].normal == t.corners[2].normal;
    }
    const MeshCorner& corner(uint32_t index) const { return triangles_[index / 3].corners[index % 3]; }
    const GridPoint& place(uint32_t triangle, uint32_t c) const {
        return mesh_.points[mesh_.triangles[triangle][c % 3]];
    }
    void find_common_bits();
    void look_around(uint32_t index);
    void code_dressed(MeshTriangle& triangle);
    void code_word(MeshTriangle& triangle);
    void code_texcoords(uint32_t index);
    void take_sides(uint32_t index);
    uint32_t corner_with_chart(uint32_t index, uint32_t c) const;
    void map(uint32_t index, uint32_t c, TexcoordPlace& place) const;

    Coder& coder_;
    const GridMesh& mesh_;
    uint32_t normal_bits_;
    std::span<MeshTriangle> triangles_;
    EdgeNeighbours neighbours_;
    AttributeBits bits_;

    std::array<Beside, 3> beside_{};
    uint32_t main_ = kNone, other_ = kNone;  ///< triangles beside: the one most alike, and another
    bool main_in_plane_ = false;
    Facing facing_ = kAside;
    uint32_t last_dressed_ = 0;
    bits::BitModel dressed_[3 * 2 * kFacings][2];
    std::array<uint32_t, kFacings * 2> last_word_{};
    ChartWordCode words_;
    std::map<uint32_t, ChartTexcoords> charts_;
    TexcoordCode texcoords_;
    std::array<std::array<uint32_t, 2>, 3> sides_{};  ///< of the corners of the triangle in hand, by axis
    std::array<std::array<double, 2>, 3> plane_{};    ///< where they are in its plane
};

template <typename Coder>
void AttributeCoder<Coder>::find_common_bits() {
    for (const MeshTriangle& t : triangles_) {
        if (names_colour(t.chart_word)) continue;
        ChartTexcoords& chart = charts_[t.chart_word];
        if (!chart.begun) chart.first = t.corners[0].texcoord;
        chart.begun = true;
        for (const MeshCorner& c : t.corners) {
            for (size_t axis = 0; axis < 2; ++axis)
                chart.common_bits[axis] |=
                    static_cast<uint32_t>(c.texcoord[axis]) - static_cast<uint32_t>(chart.first[axis]);
        }
    }
    for (auto& [word, chart] : charts_) {
        chart.begun = false;
        for (uint32_t& bits : chart.common_bits) bits = bits == 0 ? 16 : static_cast<uint32_t>(std::countr_zero(bits));
    }
}

template <typename Coder>
void AttributeCoder<Coder>::look_around(uint32_t index) {
    const auto& points = mesh_.triangles[index];
    const MeshTriangle& triangle = triangles_[index];
    facing_ = facing_of(triangle.corners[0].normal, normal_bits_);
    main_ = other_ = kNone;
    main_in_plane_ = false;
    for (size_t i = 0; i < 3; ++i) {
        Beside& beside = beside_[i];
        beside = {neighbours_.beyond(points[i], points[(i + 1) % 3]), false};
        if (beside.corner == kNone) continue;
        const uint32_t there = beside.corner / 3;
        const MeshTriangle& neighbour = triangles_[there];
        beside.in_plane =
            is_flat(triangle) && is_flat(neighbour) && triangle.corners[0].normal == neighbour.corners[0].normal;
        if (main_ == kNone || (beside.in_plane && !main_in_plane_)) {
            other_ = main_;
            main_ = there;
            main_in_plane_ = beside.in_plane;
        } else if (other_ == kNone) {
            other_ = there;
        }
    }
}

template <typename Coder>
void AttributeCoder<Coder>::code_dressed(MeshTriangle& triangle) {
    const double before = cost();
    const uint32_t there = main_ == kNone ? 2 : triangles_[main_].dressed ? 1 : 0;
    bits::BitModel& model = dressed_[(there * 2 + (main_in_plane_ ? 1u : 0u)) * kFacings + facing_][last_dressed_];
    last_dressed_ = coder_.bit(model, triangle.dressed ? 1 : 0);
    triangle.dressed = last_dressed_ != 0;
    bits_.dressed += cost() - before;
}

template <typename Coder>
void AttributeCoder<Coder>::code_word(MeshTriangle& triangle) {
    const double before = cost();
    const auto word_of = [&](uint32_t t) { return t == kNone ? ChartWordCode::kNone : triangles_[t].chart_word; };
    uint32_t& last = last_word_[facing_ * 2 + last_dressed_];
    const uint32_t beside = main_ == kNone                                  ? 0
                            : triangles_[main_].dressed != triangle.dressed ? 1
                            : !main_in_plane_                               ? 2
                                                                            : 3;
    const uint32_t place = (beside * kFacings + facing_) * 2 + last_dressed_;
    triangle.chart_word = words_.code(coder_, place, {word_of(main_), last, word_of(other_)}, triangle.chart_word);
    last = triangle.chart_word;
    bits_.charts += cost() - before;
}

/// Where the corners of a triangle lie in its plane: to the right and up, as seen from outside.
template <typename Coder>
void AttributeCoder<Coder>::take_sides(uint32_t index) {
    const Vector first = difference(place(index, 1), place(index, 0)),
                 second = difference(place(index, 2), place(index, 0));
    const Vector normal = cross(first, second);
    const double aside = normal[0] * normal[0] + normal[1] * normal[1];
    const bool level = normal[2] * normal[2] > 4 * aside;
    for (uint32_t c = 0; c < 3; ++c) {
        const Vector at = c == 0 ? Vector{} : c == 1 ? first : second;
        plane_[c] = {level ? at[0] : at[1] * normal[0] - at[0] * normal[1], level ? at[1] : at[2]};
    }
    for (size_t axis = 0; axis < 2; ++axis) {
        const auto [low, high] = std::minmax({plane_[0][axis], plane_[1][axis], plane_[2][axis]});
        for (uint32_t c = 0; c < 3; ++c) sides_[c][axis] = side_of(plane_[c][axis], low, high);
    }
}

/// An earlier corner at the same point in the same chart, of a triangle beside if possible.
template <typename Coder>
uint32_t AttributeCoder<Coder>::corner_with_chart(uint32_t index, uint32_t c) const {
    const uint32_t word = triangles_[index].chart_word;
    const auto has_chart = [&](uint32_t at) { return triangles_[at / 3].chart_word == word; };
    // The edge that begins at the corner, and the one that ends there.
    const uint32_t out = beside_[c].corner, in = beside_[(c + 2) % 3].corner;
    if (out != kNone && has_chart(out)) return out / 3 * 3 + (out + 1) % 3;
    if (in != kNone && has_chart(in)) return in;
    constexpr uint32_t kMostCorners = 8;
    uint32_t found = kNone;
    neighbours_.each_corner_at(mesh_.triangles[index][c], kMostCorners, [&](uint32_t at) {
        if (!has_chart(at)) return false;
        found = at;
        return true;
    });
    return found;
}

/// Texture coordinates by the mapping of a triangle beside that has the same chart.
template <typename Coder>
void AttributeCoder<Coder>::map(uint32_t index, uint32_t c, TexcoordPlace& result) const {
    const Beside* from = nullptr;
    for (const Beside& beside : beside_) {
        if (beside.corner == kNone || triangles_[beside.corner / 3].chart_word != triangles_[index].chart_word)
            continue;
        if (from == nullptr || (beside.in_plane && !from->in_plane)) from = &beside;
    }
    if (from == nullptr) return;
    const uint32_t there = from->corner / 3, third = (from->corner + 2) % 3;
    std::array<GridPoint, 3> places;
    std::array<Texcoord, 3> texcoords;
    for (uint32_t i = 0; i < 3; ++i) {  // the point that is not shared comes first
        places[i] = place(there, third + i);
        texcoords[i] = triangles_[there].corners[(third + i) % 3].texcoord;
    }
    const GridPoint& wanted = place(index, c);
    result.is_mapped = result.is_parallelogram = true;
    for (size_t k = 0; k < 3; ++k) {
        const int64_t off = int64_t{places[1][k]} + places[2][k] - places[0][k] - wanted[k];
        if (std::abs(off) > 2) result.is_parallelogram = false;
    }
    const Vector a = difference(places[1], places[0]), b = difference(places[2], places[0]),
                 w = difference(wanted, places[0]);
    const double aa = dot(a, a), ab = dot(a, b), bb = dot(b, b), aw = dot(a, w), bw = dot(b, w);
    const double determinant = aa * bb - ab * ab;
    double s = 1, t = 1;
    if (!result.is_parallelogram && determinant > 0) {
        s = (aw * bb - bw * ab) / determinant;
        t = (bw * aa - aw * ab) / determinant;
    }
    for (size_t axis = 0; axis < 2; ++axis) {
        const double value = texcoords[0][axis] + s * (double{1} * texcoords[1][axis] - texcoords[0][axis]) +
                             t * (double{1} * texcoords[2][axis] - texcoords[0][axis]);
        result.mapped[axis] = static_cast<int32_t>(std::clamp(std::floor(value + 0.5), -2147483648.0, 2147483647.0));
    }
}

template <typename Coder>
void AttributeCoder<Coder>::code_texcoords(uint32_t index) {
    const double before = cost();
    MeshTriangle& triangle = triangles_[index];
    ChartTexcoords& chart = charts_[triangle.chart_word];
    if (!chart.begun) texcoords_.code_chart(coder_, chart);
    take_sides(index);
    for (uint32_t c = 0; c < 3; ++c) {
        MeshCorner& told = triangle.corners[c];
        const uint32_t met = corner_with_chart(index, c);
        if (met != kNone) {
            const Texcoord& same = corner(met).texcoord;
            const bool in_plane = beside_[c].in_plane || beside_[(c + 2) % 3].in_plane;
            if (texcoords_.code_same(coder_, in_plane ? 1 : 0, told.texcoord == same)) {
                told.texcoord = same;
                continue;
            }
        }
        TexcoordPlace place;
        place.ordinal = c;
        place.side = sides_[c];
        for (uint32_t i = 0; i < c; ++i) {
            place.earlier[i] = triangle.corners[i].texcoord;
            for (size_t axis = 0; axis < 2; ++axis) {
                const double span = std::abs(plane_[0][axis] - plane_[1][axis]) +
                                    std::abs(plane_[1][axis] - plane_[2][axis]) +
                                    std::abs(plane_[2][axis] - plane_[0][axis]);
                if (std::abs(plane_[c][axis] - plane_[i][axis]) * 16 <= span) place.level[axis] |= 1u << i;
            }
        }
        map(index, c, place);
        told.texcoord = texcoords_.code(coder_, chart, place, told.texcoord);
    }
    bits_.texcoords += cost() - before;
}

}  // namespace

AttributeBits encode_attributes(bits::RangeEncoder& encoder, const GridMesh& mesh, uint32_t normal_bits,
                                std::span<const MeshTriangle> triangles) {
    std::vector<uint64_t> normals;
    std::vector<MeshTriangle> told(triangles.begin(), triangles.end());
    for (MeshTriangle& t : told) {
        for (MeshCorner& c : t.corners) {
            c.normal = static_cast<uint32_t>(canonical_octahedral(c.normal, normal_bits));
            normals.push_back(c.normal);
        }
    }
    const double before = encoder.cost();
    encode_corner_normals(encoder, mesh, normals, normal_bits);
    const double of_normals = encoder.cost() - before;
    AttributeBits bits = AttributeCoder<bits::RangeEncoder>(encoder, mesh, normal_bits, told).code();
    bits.normals = of_normals;
    return bits;
}

std::vector<MeshTriangle> decode_attributes(bits::RangeDecoder& decoder, const GridMesh& mesh, uint32_t normal_bits) {
    const std::vector<uint64_t> normals = decode_corner_normals(decoder, mesh, normal_bits);
    std::vector<MeshTriangle> triangles(mesh.triangles.size());
    for (size_t t = 0; t < triangles.size(); ++t) {
        for (size_t c = 0; c < 3; ++c) {
            triangles[t].corners[c].point = mesh.triangles[t][c];
            triangles[t].corners[c].normal = static_cast<uint32_t>(normals[3 * t + c]);
        }
    }
    AttributeCoder<bits::RangeDecoder>(decoder, mesh, normal_bits, triangles).code();
    return triangles;
}

}  // namespace citystream::codec::mesh
