#include "codec/mesh/draco_transport.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "codec/bits/range_coder.h"
#include "codec/chart_word.h"
#include "codec/mesh/byte_numbers.h"
#include "codec/mesh/content_prisms.h"
#include "codec/mesh/draco_corners.h"
#include "codec/mesh/mesh_triangles.h"
#include "codec/mesh/octahedral.h"
#include "codec/mesh/octahedral_residual.h"
#include "codec/mesh/triangle_plane.h"

namespace citystream::codec::mesh {

namespace {

constexpr std::array<char, 4> kMagic = {'C', 'S', 'D', 'M'};
constexpr uint32_t kTexcoordBits = 16;
constexpr int32_t kPlaceLimit = 1 << 30;

struct Chart {
    uint32_t word = 0;
    std::array<int32_t, 2> base{};
    std::array<uint32_t, 2> shift{};
};

/// Charts in use, ascending by word.
std::vector<Chart> charts_of(const MeshContent& content) {
    struct Range {
        std::array<int32_t, 2> low, high;
    };
    std::map<uint32_t, Range> ranges;
    for (const MeshPrism& prism : content.prisms) {
        for (const uint32_t word : {prism.wall_chart, prism.top_chart, prism.floor_chart})
            if (names_colour(word)) ranges.try_emplace(word, Range{});
    }
    for (const MeshTriangle& triangle : content.triangles) {
        for (const MeshCorner& corner : triangle.corners) {
            Range& range =
                ranges.try_emplace(triangle.chart_word, Range{corner.texcoord, corner.texcoord}).first->second;
            for (size_t c = 0; c < 2; ++c) {
                range.low[c] = std::min(range.low[c], corner.texcoord[c]);
                range.high[c] = std::max(range.high[c], corner.texcoord[c]);
            }
        }
    }
    std::vector<Chart> charts;
    for (const auto& [word, range] : ranges) {
        Chart chart{word};
        for (size_t c = 0; c < 2 && !names_colour(word); ++c) {
            const auto span = static_cast<uint64_t>(int64_t{range.high[c]} - range.low[c]);
            const auto bits = static_cast<uint32_t>(std::bit_width(span));
            chart.base[c] = range.low[c];
            chart.shift[c] = bits > kTexcoordBits ? bits - kTexcoordBits : 0;
        }
        charts.push_back(chart);
    }
    return charts;
}

using Triangle = std::array<DracoCorner, 3>;

/// Turned so that its least corner comes first.
Triangle turned_to_least(Triangle triangle) {
    Triangle least = triangle;
    for (int turn = 0; turn < 2; ++turn) {
        std::rotate(triangle.begin(), triangle.begin() + 1, triangle.end());
        least = std::min(least, triangle);
    }
    return least;
}

std::vector<Triangle> sorted_triangles(std::span<const DracoCorner> corners) {
    std::vector<Triangle> triangles;
    for (size_t c = 0; c + 2 < corners.size(); c += 3)
        triangles.push_back(turned_to_least({corners[c], corners[c + 1], corners[c + 2]}));
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

uint32_t plane_code(const std::array<GridPoint, 3>& places, uint32_t bits) {
    return static_cast<uint32_t>(canonical_octahedral(pack_octahedral(plane_vector(places), bits), bits));
}

/// Content as corners.
class CornerWriter {
  public:
    CornerWriter(const MeshContent& content, const std::vector<Chart>& charts) : content_(content), charts_(charts) {
        for (const MeshPrism& prism : content.prisms) {
            for_each_prism_triangle(prism.shape, [&](const std::array<GridPoint, 3>& places, PrismFace face) {
                add_prism_triangle(places, chart_of(prism, face));
            });
        }
        for (const MeshTriangle& triangle : content.triangles) add_triangle(triangle);
    }
    /// Of triangles whose corners are apart, and of all others.
    std::vector<DracoCorner> apart, folded;

  private:
    void add(const Triangle& triangle) {
        const bool is_folded = triangle[0].place == triangle[1].place || triangle[1].place == triangle[2].place ||
                               triangle[2].place == triangle[0].place;
        std::vector<DracoCorner>& to = is_folded ? folded : apart;
        to.insert(to.end(), triangle.begin(), triangle.end());
    }
    DracoCorner corner_at(const GridPoint& place, uint64_t normal, uint32_t chart, bool dressed) const {
        DracoCorner corner;
        for (size_t c = 0; c < 3; ++c) corner.place[c] = place[c] >> content_.dropped.back();
        const uint64_t mask = (uint64_t{1} << content_.normal_bits) - 1;
        corner.normal = {static_cast<int32_t>(normal & mask),
                         static_cast<int32_t>(normal >> content_.normal_bits & mask)};
        corner.face = static_cast<int32_t>(2 * chart + (dressed ? 1 : 0));
        return corner;
    }
    uint32_t number_of(uint32_t word) const {
        const auto found = std::lower_bound(charts_.begin(), charts_.end(), word,
                                            [](const Chart& chart, uint32_t w) { return chart.word < w; });
        return static_cast<uint32_t>(found - charts_.begin());
    }
    void add_prism_triangle(const std::array<GridPoint, 3>& places, uint32_t word) {
        const uint32_t normal = plane_code(places, content_.normal_bits);
        Triangle triangle;
        for (size_t k = 0; k < 3; ++k) triangle[k] = corner_at(places[k], normal, number_of(word), false);
        add(triangle);
    }
    void add_triangle(const MeshTriangle& from) {
        const uint32_t number = number_of(from.chart_word);
        const Chart& chart = charts_[number];
        Triangle triangle;
        for (size_t k = 0; k < 3; ++k) {
            const MeshCorner& corner = from.corners[k];
            const uint64_t normal = canonical_octahedral(corner.normal, content_.normal_bits);
            triangle[k] = corner_at(content_.points[corner.point], normal, number, from.dressed);
            for (size_t c = 0; c < 2 && !names_colour(chart.word); ++c)
                triangle[k].texcoord[c] =
                    static_cast<int32_t>((int64_t{corner.texcoord[c]} - chart.base[c]) >> chart.shift[c]);
        }
        add(triangle);
    }

    const MeshContent& content_;
    const std::vector<Chart>& charts_;
};

bool is_too_wide(std::span<const DracoCorner> corners) {
    for (size_t c = 0; c < 3; ++c) {
        const auto [low, high] =
            std::minmax_element(corners.begin(), corners.end(),
                                [c](const DracoCorner& a, const DracoCorner& b) { return a.place[c] < b.place[c]; });
        if (low != corners.end() && int64_t{high->place[c]} - low->place[c] >= int64_t{1} << kMostDracoPlaceBits)
            return true;
    }
    return false;
}

/// Of each triangle whether it may be part of a prism: undressed, of one colour, the code of its plane at its corners.
std::vector<uint8_t> plane_coloured(const MeshContent& content) {
    std::vector<uint8_t> flags;
    for (const MeshTriangle& triangle : content.triangles) {
        std::array<GridPoint, 3> places;
        for (size_t k = 0; k < 3; ++k) places[k] = content.points[triangle.corners[k].point];
        const uint32_t code = plane_code(places, content.normal_bits);
        const bool is_flat = plane_vector(places) != Direction{} &&
                             std::all_of(triangle.corners.begin(), triangle.corners.end(),
                                         [code](const MeshCorner& corner) { return corner.normal == code; });
        flags.push_back(is_flat && !triangle.dressed && names_colour(triangle.chart_word) ? 1 : 0);
    }
    return flags;
}

/// By the first method that brings all back.
std::optional<std::vector<std::byte>> encode_part(std::span<const DracoCorner> corners,
                                                  std::span<const DracoMethod> methods) {
    const std::vector<Triangle> expected = sorted_triangles(corners);
    for (const DracoMethod method : methods) {
        auto bytes = encode_draco_corners(corners, method);
        if (!bytes) continue;
        const auto back = decode_draco_corners(*bytes, static_cast<uint32_t>(expected.size()));
        if (back && sorted_triangles(*back) == expected) return bytes;
    }
    return std::nullopt;
}

Status put_part(std::vector<std::byte>& bytes, std::span<const DracoCorner> corners,
                std::span<const DracoMethod> methods) {
    const size_t triangles = corners.size() / 3;
    std::vector<std::byte> coded;
    if (triangles > 0) {
        auto part = encode_part(corners, methods);
        if (!part) return Error{"libdraco does not bring this mesh back"};
        coded = std::move(*part);
        coded.resize(std::max(coded.size(), triangles / kDracoTrianglesPerByte + 1));
    }
    put_number(bytes, triangles);
    put_number(bytes, coded.size());
    bytes.insert(bytes.end(), coded.begin(), coded.end());
    return Done{};
}

void put_charts(std::vector<std::byte>& bytes, const std::vector<Chart>& charts) {
    put_number(bytes, charts.size());
    for (const Chart& chart : charts) {
        put_number(bytes, chart.word);
        if (names_colour(chart.word)) continue;
        for (size_t c = 0; c < 2; ++c) {
            put_number(bytes, bits::zigzag(chart.base[c]));
            bytes.push_back(static_cast<std::byte>(chart.shift[c]));
        }
    }
}

class Reader {
  public:
    Reader(std::span<const std::byte> bytes, const MeshLimits& limits) : in_(bytes), limits_(limits) {}

    Result<MeshContent> read() {
        if (Status status = read_header(); !status) return status.error();
        if (Status status = read_charts(); !status) return status.error();
        for (int part = 0; part < 2; ++part) {
            if (Status status = read_part(); !status) return status.error();
        }
        if (in_.left() > 0) return damaged("bytes follow the last mesh");
        take_prisms(content_, plane_coloured(content_));
        return std::move(content_);
    }

  private:
    Error damaged(const char* what) const { return Error{std::string("Draco mesh layer: ") + what, in_.position()}; }

    Status read_header() {
        if (!is_draco_mesh(in_.take(kMagic.size()))) return damaged("wrong magic");
        content_.dropped = {in_.byte()};
        content_.normal_bits = in_.byte();
        const uint8_t topology = in_.byte();
        content_.topology = static_cast<MeshTopology>(topology);
        const bool is_sound = content_.dropped[0] <= kMeshGridBits && content_.normal_bits >= kLeastMeshNormalBits &&
                              content_.normal_bits <= kMostMeshNormalBits &&
                              topology <= static_cast<uint8_t>(MeshTopology::kStripCode);
        if (!in_.ok() || !is_sound) return damaged("header out of range");
        return Done{};
    }

    Status read_charts() {
        const uint64_t count = in_.number(32);
        for (uint64_t i = 0; i < count && in_.ok(); ++i) {
            Chart chart{static_cast<uint32_t>(in_.number(32))};
            for (size_t c = 0; c < 2 && !names_colour(chart.word); ++c) {
                chart.base[c] = bits::unzigzag(static_cast<uint32_t>(in_.number(32)));
                chart.shift[c] = in_.byte();
                if (chart.shift[c] > kTexcoordBits) return damaged("chart shift out of range");
            }
            charts_.push_back(chart);
        }
        if (!in_.ok() || charts_.size() > (1u << 30)) return damaged("charts end too early");
        return Done{};
    }

    Status read_part() {
        const uint64_t triangles = in_.number(32), size = in_.number(32);
        const auto coded = in_.take(size);
        if (!in_.ok()) return damaged("mesh ends too early");
        if (triangles == 0) return size == 0 ? Status(Done{}) : damaged("bytes of no triangles");
        if (triangles > limits_.triangles - content_.triangles.size()) return damaged("more triangles than allowed");
        if (triangles / kDracoTrianglesPerByte >= size) return damaged("more triangles than its bytes can hold");
        const auto corners = decode_draco_corners(coded, static_cast<uint32_t>(triangles));
        if (!corners) return corners.error();
        for (size_t c = 0; c < corners->size(); c += 3) {
            if (!add(std::span(*corners).subspan(c).first<3>())) return damaged("corner out of range");
        }
        return content_.points.size() <= limits_.points ? Status(Done{}) : damaged("more points than allowed");
    }

    bool add(std::span<const DracoCorner, 3> corners) {
        const auto face = static_cast<uint32_t>(corners[0].face);
        if (face / 2 >= charts_.size()) return false;
        const Chart& chart = charts_[face / 2];
        MeshTriangle& triangle = content_.triangles.emplace_back();
        triangle.chart_word = chart.word;
        triangle.dressed = face % 2 == 1;
        for (size_t k = 0; k < 3; ++k) {
            MeshCorner& corner = triangle.corners[k];
            if (!read_place(corners[k].place, corner.point) || !read_normal(corners[k].normal, corner.normal))
                return false;
            if (!names_colour(chart.word) && !read_texcoord(chart, corners[k].texcoord, corner.texcoord)) return false;
        }
        return true;
    }

    bool read_place(const std::array<int32_t, 3>& from, uint32_t& point) {
        GridPoint place{};
        const int64_t unit = int64_t{1} << content_.dropped[0];
        for (size_t c = 0; c < 3; ++c) {
            const int64_t word = from[c] * unit;
            if (word <= -kPlaceLimit || word >= kPlaceLimit) return false;
            place[c] = static_cast<int32_t>(word);
        }
        const auto [at, added] = numbers_.try_emplace(place, static_cast<uint32_t>(content_.points.size()));
        if (added) content_.points.push_back(place);
        point = at->second;
        return true;
    }

    bool read_normal(const std::array<int32_t, 2>& from, uint32_t& normal) const {
        const uint32_t bits = content_.normal_bits;
        for (const int32_t parameter : from) {
            if (parameter < 0 || parameter >> bits != 0) return false;
        }
        const uint64_t code = static_cast<uint64_t>(from[0]) | static_cast<uint64_t>(from[1]) << bits;
        normal = static_cast<uint32_t>(canonical_octahedral(code, bits));
        return true;
    }

    static bool read_texcoord(const Chart& chart, const std::array<int32_t, 2>& from, std::array<int32_t, 2>& to) {
        for (size_t c = 0; c < 2; ++c) {
            if (from[c] < 0 || from[c] >> kTexcoordBits != 0) return false;
            const int64_t at = chart.base[c] + (int64_t{from[c]} << chart.shift[c]);
            if (at > std::numeric_limits<int32_t>::max()) return false;
            to[c] = static_cast<int32_t>(at);
        }
        return true;
    }

    NumberReader in_;
    const MeshLimits& limits_;
    MeshContent content_;
    std::vector<Chart> charts_;
    std::map<GridPoint, uint32_t> numbers_;
};

}  // namespace

bool is_draco_mesh(std::span<const std::byte> bytes) {
    return bytes.size() >= kMagic.size() &&
           std::equal(kMagic.begin(), kMagic.end(), bytes.begin(),
                      [](char expected, std::byte byte) { return static_cast<std::byte>(expected) == byte; });
}

Result<MeshWire> encode_draco_mesh(const MeshContent& content) {
    constexpr std::array<DracoMethod, 2> kSmallestFirst = {DracoMethod::kEdgebreaker, DracoMethod::kSequential};
    const std::vector<Chart> charts = charts_of(content);
    const CornerWriter corners(content, charts);
    if (is_too_wide(corners.apart) || is_too_wide(corners.folded)) return Error{"a mesh too wide for Draco"};
    const auto magic = std::as_bytes(std::span(kMagic));
    std::vector<std::byte> bytes(magic.begin(), magic.end());
    for (const uint32_t field : {content.dropped.back(), content.normal_bits, static_cast<uint32_t>(content.topology)})
        bytes.push_back(static_cast<std::byte>(field));
    put_charts(bytes, charts);
    if (Status put = put_part(bytes, corners.apart, kSmallestFirst); !put) return put.error();
    if (Status put = put_part(bytes, corners.folded, std::span(kSmallestFirst).last(1)); !put) return put.error();
    auto decoded = decode_draco_mesh(bytes, {~uint32_t{0}, ~uint32_t{0}});
    if (!decoded) return decoded.error();
    MeshWire wire;
    wire.steps.push_back(std::move(bytes));
    wire.content = std::move(decoded).value();
    return wire;
}

Result<MeshContent> decode_draco_mesh(std::span<const std::byte> bytes, const MeshLimits& limits) {
    return Reader(bytes, limits).read();
}

}  // namespace citystream::codec::mesh
