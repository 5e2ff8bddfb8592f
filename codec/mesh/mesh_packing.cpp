#include "codec/mesh/mesh_packing.h"

#include <array>
#include <cstring>
#include <string>

#include "codec/bits/bit_stream.h"
#include "codec/mesh/mesh_layout.h"

namespace citystream::codec::mesh {
namespace {

using bits::BitWriter;
using bits::read_bits;
using bits::words_for;

constexpr uint32_t kMagic = 0x504d5343;  // "CSMP"
/// Words of the header that are kept as they are: counts, origin, widths. Offsets follow from them.
constexpr uint32_t kKeptBegin = MESH_WORD_VERTEX_COUNT, kKeptEnd = MESH_WORD_CHART_TABLE;
constexpr size_t kHeadWords = 1 + (kKeptEnd - kKeptBegin) + 2;  // magic, kept, bytes of indices and of charts
constexpr uint32_t kMostBits = 32, kMostPositionBits = 30;
constexpr uint32_t kMostVarintBytes = 5;

/// Where the parts of step 0 lie when they follow one another without gaps.
struct Layout {
    uint64_t vertices = 0, triangles = 0, charts = 0;
    uint32_t index_bits = 0, chart_bits = 0, position_bits = 0;
    std::array<uint64_t, 7> begin{};  ///< chart table, indices, charts, normals, texture coordinates, positions, end

    explicit Layout(std::span<const uint32_t> header)
        : vertices(header[MESH_WORD_VERTEX_COUNT]),
          triangles(header[MESH_WORD_TRIANGLE_COUNT]),
          charts(header[MESH_WORD_CHART_COUNT]),
          index_bits(header[MESH_WORD_WIDTHS] & 255U),
          chart_bits(header[MESH_WORD_WIDTHS] >> 8 & 255U),
          position_bits(header[MESH_WORD_WIDTHS] >> 16 & 255U) {
        const std::array<uint64_t, 6> sizes = {MESH_CHART_WORDS * charts,
                                               words_for(3 * triangles, index_bits),
                                               words_for(triangles, chart_bits),
                                               words_for(vertices, 16),
                                               vertices,
                                               words_for(3 * vertices, position_bits)};
        begin[0] = MESH_HEADER_WORDS;
        for (size_t i = 0; i < sizes.size(); ++i) begin[i + 1] = begin[i] + sizes[i];
    }
    bool is_sound() const {
        return index_bits <= kMostBits && chart_bits <= kMostBits && position_bits <= kMostPositionBits &&
               (triangles == 0 || index_bits > 0);
    }
    /// Bytes of a coordinate's difference: its sign takes a bit more.
    uint32_t position_planes() const { return (position_bits + 1 + 7) / 8; }
    uint64_t fixed_bytes() const {
        return 16 * charts + 2 * vertices + 4 * vertices + 3 * vertices * position_planes();
    }
};

uint32_t fold(uint32_t difference) {
    return difference << 1 ^ (0U - (difference >> 31));
}
uint32_t unfold(uint32_t folded) {
    return folded >> 1 ^ (0U - (folded & 1U));
}

void put_varint(std::vector<std::byte>& out, uint32_t value) {
    for (; value >= 128; value >>= 7) out.push_back(static_cast<std::byte>(value | 128U));
    out.push_back(static_cast<std::byte>(value));
}

void put_words(std::vector<std::byte>& out, std::span<const uint32_t> words) {
    const auto bytes = std::as_bytes(words);
    out.insert(out.end(), bytes.begin(), bytes.end());
}

/// Byte `plane` of every value, for each of `planes`.
void put_planes(std::vector<std::byte>& out, const std::vector<uint32_t>& values, uint32_t planes) {
    for (uint32_t plane = 0; plane < planes; ++plane) {
        for (const uint32_t value : values) out.push_back(static_cast<std::byte>(value >> (8 * plane)));
    }
}

/// Takes bytes from the front; all sizes were checked before.
class ByteReader {
  public:
    explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::span<const std::byte> take(uint64_t count) {
        const auto front = bytes_.first(static_cast<size_t>(count));
        bytes_ = bytes_.subspan(static_cast<size_t>(count));
        return front;
    }
    std::vector<uint32_t> take_planes(uint64_t count, uint32_t planes) {
        std::vector<uint32_t> values(static_cast<size_t>(count));
        for (uint32_t plane = 0; plane < planes; ++plane) {
            const auto bytes = take(count);
            for (size_t i = 0; i < values.size(); ++i) values[i] |= std::to_integer<uint32_t>(bytes[i]) << (8 * plane);
        }
        return values;
    }

  private:
    std::span<const std::byte> bytes_;
};

/// Fields of fewer bytes the nearer they are to what came before. Fails at the end of the bytes.
bool take_varint(std::span<const std::byte>& bytes, uint32_t& value) {
    value = 0;
    for (uint32_t i = 0; i < kMostVarintBytes && i < bytes.size(); ++i) {
        const auto byte = std::to_integer<uint32_t>(bytes[i]);
        value |= (byte & 127U) << (7 * i);
        if (byte >= 128) continue;
        bytes = bytes.subspan(i + 1);
        return true;
    }
    return false;
}

/// Each index as its distance below the next new vertex. False when a vertex is used before those in front of it.
bool put_indices(std::vector<std::byte>& out, std::span<const uint32_t> words, const Layout& layout) {
    uint32_t next = 0;
    for (uint64_t i = 0, bit = 32 * layout.begin[1]; i < 3 * layout.triangles; ++i, bit += layout.index_bits) {
        const uint32_t index = read_bits(words, bit, layout.index_bits);
        if (index > next) return false;
        put_varint(out, next - index);
        next += index == next ? 1 : 0;
    }
    return true;
}

Status take_indices(std::span<const std::byte> bytes, const Layout& layout, BitWriter& writer) {
    uint32_t next = 0;
    for (uint64_t i = 0; i < 3 * layout.triangles; ++i) {
        uint32_t below = 0;
        if (!take_varint(bytes, below) || below > next) return Error{"packed mesh: damaged vertex indices"};
        const uint32_t index = next - below;
        if (layout.index_bits < kMostBits && index >> layout.index_bits != 0)
            return Error{"packed mesh: vertex index of too many bits"};
        writer.put(index, layout.index_bits);
        next += below == 0 ? 1 : 0;
    }
    return bytes.empty() ? Status(Done{}) : Error{"packed mesh: bytes follow the vertex indices"};
}

void put_charts(std::vector<std::byte>& out, std::span<const uint32_t> words, const Layout& layout) {
    uint32_t before = 0;
    for (uint64_t i = 0, bit = 32 * layout.begin[2]; i < layout.triangles; ++i, bit += layout.chart_bits) {
        const uint32_t chart = read_bits(words, bit, layout.chart_bits);
        put_varint(out, fold(chart - before));
        before = chart;
    }
}

Status take_charts(std::span<const std::byte> bytes, const Layout& layout, BitWriter& writer) {
    uint32_t chart = 0;
    for (uint64_t i = 0; i < layout.triangles; ++i) {
        uint32_t folded = 0;
        if (!take_varint(bytes, folded)) return Error{"packed mesh: damaged charts"};
        chart += unfold(folded);
        if (layout.chart_bits < kMostBits && chart >> layout.chart_bits != 0)
            return Error{"packed mesh: chart of too many bits"};
        writer.put(chart, layout.chart_bits);
    }
    return bytes.empty() ? Status(Done{}) : Error{"packed mesh: bytes follow the charts"};
}

void put_positions(std::vector<std::byte>& out, std::span<const uint32_t> words, const Layout& layout) {
    std::vector<uint32_t> differences(static_cast<size_t>(layout.vertices));
    for (uint32_t axis = 0; axis < 3; ++axis) {
        uint32_t before = 0;
        uint64_t bit = 32 * layout.begin[5] + uint64_t{axis} * layout.position_bits;
        for (uint32_t& difference : differences) {
            const uint32_t value = read_bits(words, bit, layout.position_bits);
            difference = fold(value - before);
            before = value;
            bit += uint64_t{3} * layout.position_bits;
        }
        put_planes(out, differences, layout.position_planes());
    }
}

void take_positions(ByteReader& reader, const Layout& layout, BitWriter& writer) {
    std::array<std::vector<uint32_t>, 3> axes;
    for (auto& axis : axes) axis = reader.take_planes(layout.vertices, layout.position_planes());
    const uint32_t mask = (uint32_t{1} << layout.position_bits) - 1;
    std::array<uint32_t, 3> at{};
    for (size_t vertex = 0; vertex < layout.vertices; ++vertex) {
        for (size_t axis = 0; axis < 3; ++axis) {
            at[axis] = (at[axis] + unfold(axes[axis][vertex])) & mask;
            writer.put(at[axis], layout.position_bits);
        }
    }
}

void append(std::vector<uint32_t>& words, BitWriter& writer) {
    const std::vector<uint32_t> part = writer.finish();
    words.insert(words.end(), part.begin(), part.end());
}

/// Whether the offsets are those of parts without gaps.
bool is_canonical(std::span<const uint32_t> words, const Layout& layout) {
    if (!layout.is_sound() || layout.begin[6] != words.size() || words[MESH_HEADER_WORDS - 1] != 0) return false;
    for (size_t part = 0; part < 6; ++part) {
        if (words[MESH_WORD_CHART_TABLE + part] != layout.begin[part]) return false;
    }
    return true;
}

/// Differences of each chart table entry to the one before, word by word.
std::vector<uint32_t> chart_differences(std::span<const uint32_t> table) {
    std::vector<uint32_t> differences(table.begin(), table.end());
    for (size_t i = differences.size(); i-- > MESH_CHART_WORDS;) differences[i] -= differences[i - MESH_CHART_WORDS];
    return differences;
}

}  // namespace

std::optional<std::vector<std::byte>> pack_mesh(std::span<const uint32_t> words) {
    if (words.size() < MESH_HEADER_WORDS || words[MESH_WORD_MAGIC] != MESH_MAGIC) return std::nullopt;
    const Layout layout(words);
    if (!is_canonical(words, layout)) return std::nullopt;
    std::vector<std::byte> indices, charts;
    if (!put_indices(indices, words, layout)) return std::nullopt;
    put_charts(charts, words, layout);
    std::vector<uint32_t> head = {kMagic};
    head.insert(head.end(), words.begin() + kKeptBegin, words.begin() + kKeptEnd);
    head.insert(head.end(), {static_cast<uint32_t>(indices.size()), static_cast<uint32_t>(charts.size())});
    std::vector<std::byte> out;
    put_words(out, head);
    put_planes(out, chart_differences(words.subspan(layout.begin[0], layout.begin[1] - layout.begin[0])), 4);
    out.insert(out.end(), indices.begin(), indices.end());
    out.insert(out.end(), charts.begin(), charts.end());
    const auto normals = std::as_bytes(words.subspan(layout.begin[3])).first(static_cast<size_t>(2 * layout.vertices));
    out.insert(out.end(), normals.begin(), normals.end());
    const auto texcoords = words.subspan(layout.begin[4], static_cast<size_t>(layout.vertices));
    put_planes(out, {texcoords.begin(), texcoords.end()}, 4);
    put_positions(out, words, layout);
    if (out.size() > most_packed_bytes(words.size())) return std::nullopt;
    return out;
}

bool is_packed_mesh(std::span<const std::byte> bytes) {
    uint32_t magic = 0;
    if (bytes.size() < sizeof(magic)) return false;
    std::memcpy(&magic, bytes.data(), sizeof(magic));
    return magic == kMagic;
}

uint64_t most_packed_bytes(uint64_t words) {
    return 4 * kHeadWords + 8 * words;
}

Result<std::vector<uint32_t>> unpack_mesh(std::span<const std::byte> bytes, uint64_t word_count) {
    if (!is_packed_mesh(bytes) || bytes.size() < 4 * kHeadWords || word_count < MESH_HEADER_WORDS)
        return Error{"packed mesh: no header", 0};
    std::array<uint32_t, kHeadWords> head{};
    std::memcpy(head.data(), bytes.data(), sizeof(head));
    std::vector<uint32_t> header(MESH_HEADER_WORDS);
    header[MESH_WORD_MAGIC] = MESH_MAGIC;
    std::copy(head.begin() + 1, head.end() - 2, header.begin() + kKeptBegin);
    const Layout layout(header);
    if (!layout.is_sound()) return Error{"packed mesh: field widths out of range", 0};
    if (layout.begin[6] != word_count) {
        return Error{
            "packed mesh holds " + std::to_string(layout.begin[6]) + " words, expected " + std::to_string(word_count),
            0};
    }
    const uint64_t index_bytes = head[kHeadWords - 2], chart_bytes = head[kHeadWords - 1];
    if (4 * kHeadWords + layout.fixed_bytes() + index_bytes + chart_bytes != bytes.size())
        return Error{"packed mesh: parts of another size", bytes.size()};
    for (size_t part = 0; part < 6; ++part)
        header[MESH_WORD_CHART_TABLE + part] = static_cast<uint32_t>(layout.begin[part]);
    std::vector<uint32_t> words = std::move(header);
    words.reserve(static_cast<size_t>(word_count));
    ByteReader reader(bytes.subspan(4 * kHeadWords));
    std::vector<uint32_t> table = reader.take_planes(MESH_CHART_WORDS * layout.charts, 4);
    for (size_t i = MESH_CHART_WORDS; i < table.size(); ++i) table[i] += table[i - MESH_CHART_WORDS];
    words.insert(words.end(), table.begin(), table.end());
    BitWriter indices, charts, normals, positions;
    if (Status status = take_indices(reader.take(index_bytes), layout, indices); !status) return status.error();
    append(words, indices);
    if (Status status = take_charts(reader.take(chart_bytes), layout, charts); !status) return status.error();
    append(words, charts);
    const auto packed = reader.take(2 * layout.vertices);
    for (size_t i = 0; i < packed.size(); i += 2)
        normals.put(std::to_integer<uint32_t>(packed[i]) | std::to_integer<uint32_t>(packed[i + 1]) << 8, 16);
    append(words, normals);
    const std::vector<uint32_t> texcoords = reader.take_planes(layout.vertices, 4);
    words.insert(words.end(), texcoords.begin(), texcoords.end());
    take_positions(reader, layout, positions);
    append(words, positions);
    return words;
}

}  // namespace citystream::codec::mesh
