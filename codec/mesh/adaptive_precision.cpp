#include "codec/mesh/adaptive_precision.h"

#include <bit>
#include <cassert>

#include "codec/bits/bit_stream.h"

namespace citystream::codec::mesh {
namespace {

constexpr uint32_t kMostVertices = (1u << PRECISION_BIN_LEVEL_SHIFT) - 1;

/// The bin of a vertex: the last one that does not begin behind it.
size_t bin_of(const PrecisionShape& shape, uint32_t vertex) {
    const auto after = std::upper_bound(shape.bins.begin() + 1, shape.bins.end(), vertex,
                                        [](uint32_t v, const PrecisionBin& bin) { return v < bin.first_vertex; });
    return static_cast<size_t>(after - shape.bins.begin()) - 1;
}

uint32_t plane_components(const PrecisionShape& shape, uint32_t plane) {
    uint32_t count = 0;
    for (uint32_t c = 0; c < shape.components; ++c) count += shape.leading[c] <= plane ? 1 : 0;
    return count;
}

/// Reads planes `from`.. one after the other.
class PlaneReader {
  public:
    PlaneReader(const PrecisionShape& shape, std::span<const uint32_t> words, uint32_t from)
        : words_(words), from_(from) {
        uint64_t begin = 0;
        for (uint32_t plane = from; plane < shape.full_bits; ++plane) {
            planes_.push_back({});
            uint64_t bit = 32 * begin;
            for (uint32_t c = 0; c < shape.components; ++c) {
                planes_.back()[c] = bit;
                bit += shape.leading[c] <= plane ? shape.plane_vertices(plane) : 0;
            }
            begin += shape.plane_words(plane);
        }
    }

    uint32_t bit(uint32_t plane, uint32_t component, uint32_t vertex) const {
        const uint64_t at = planes_[plane - from_][component] + vertex;
        return words_[at / 32] >> (at % 32) & 1;
    }

  private:
    std::span<const uint32_t> words_;
    uint32_t from_;
    /// First bit of each component.
    std::vector<std::array<uint64_t, PRECISION_MOST_COMPONENTS>> planes_;
};

bool unused_bits_are_zero(std::span<const uint32_t> words, uint64_t bits) {
    return bits % 32 == 0 || words.back() >> (bits % 32) == 0;
}

PrecisionShape shape_of(std::span<const uint32_t> words) {
    PrecisionShape shape;
    shape.vertices = words[PRECISION_WORD_VERTICES];
    const uint32_t packed = words[PRECISION_WORD_SHAPE];
    shape.components = packed >> 8 & 255;
    shape.full_bits = packed >> 16 & 255;
    for (uint32_t c = 0; c < PRECISION_MOST_COMPONENTS; ++c) {
        shape.leading[c] = words[PRECISION_WORD_LEADING] >> (8 * c) & 255;
    }
    shape.bins.clear();
    for (uint32_t b = 0; b < (packed & 255); ++b) {
        const uint32_t entry = words[PRECISION_WORD_BINS + PRECISION_BIN_WORDS * b];
        shape.bins.push_back({entry & kMostVertices, entry >> PRECISION_BIN_LEVEL_SHIFT});
    }
    return shape;
}

}  // namespace

uint32_t PrecisionShape::record_bits(uint32_t level) const {
    uint32_t bits = 0;
    for (uint32_t c = 0; c < components; ++c) bits += field_bits(c, level);
    return bits;
}

uint32_t PrecisionShape::header_words() const {
    return PRECISION_WORD_BINS + PRECISION_BIN_WORDS * static_cast<uint32_t>(bins.size());
}

uint64_t PrecisionShape::payload_bits(uint32_t level) const {
    uint64_t bits = 0;
    for (size_t b = 0; b < bins.size(); ++b) {
        bits += uint64_t{bin_end(b) - bins[b].first_vertex} * record_bits(bin_level(b, level));
    }
    return bits;
}

uint64_t PrecisionShape::words_at(uint32_t level) const {
    return header_words() + (payload_bits(level) + 31) / 32;
}

uint32_t PrecisionShape::plane_vertices(uint32_t plane) const {
    uint32_t count = 0;
    for (size_t b = 0; b < bins.size() && bins[b].least_level <= plane; ++b) count = bin_end(b);
    return count;
}

uint64_t PrecisionShape::plane_words(uint32_t plane) const {
    return (uint64_t{plane_vertices(plane)} * plane_components(*this, plane) + 31) / 32;
}

uint64_t PrecisionShape::words_between(uint32_t from, uint32_t to) const {
    uint64_t words = 0;
    for (uint32_t plane = from; plane < to; ++plane) words += plane_words(plane);
    return words;
}

Status check_shape(const PrecisionShape& shape) {
    if (shape.vertices > kMostVertices) return Error{"precision buffer: too many vertices"};
    if (shape.components < 1 || shape.components > PRECISION_MOST_COMPONENTS)
        return Error{"precision buffer: number of components"};
    if (shape.full_bits < 1 || shape.full_bits > PRECISION_MOST_BITS) return Error{"precision buffer: full bits"};
    for (uint32_t c = 0; c < PRECISION_MOST_COMPONENTS; ++c) {
        if (shape.leading[c] > (c < shape.components ? shape.full_bits : 0))
            return Error{"precision buffer: leading zeros"};
    }
    if (shape.bins.empty() || shape.bins.size() > PRECISION_MOST_BINS || shape.bins[0].first_vertex != 0)
        return Error{"precision buffer: bins"};
    for (size_t b = 0; b < shape.bins.size(); ++b) {
        const bool rises = b == 0 || (shape.bins[b].least_level > shape.bins[b - 1].least_level &&
                                      shape.bins[b].first_vertex > shape.bins[b - 1].first_vertex);
        const bool has_vertices = shape.bins[b].first_vertex < shape.vertices || (b == 0 && shape.vertices == 0);
        if (!rises || !has_vertices || shape.bins[b].least_level > shape.full_bits)
            return Error{"precision buffer: bins"};
    }
    if (shape.payload_bits(shape.full_bits) > 0xffffffffu) return Error{"precision buffer: too large"};
    return Done{};
}

std::vector<uint32_t> precision_header(const PrecisionShape& shape, uint32_t level) {
    std::vector<uint32_t> header = {
        PRECISION_MAGIC, shape.vertices,
        static_cast<uint32_t>(shape.bins.size()) | shape.components << 8 | shape.full_bits << 16 | level << 24,
        shape.leading[0] | shape.leading[1] << 8 | shape.leading[2] << 16 | shape.leading[3] << 24};
    uint32_t bit = 0;
    for (size_t b = 0; b < shape.bins.size(); ++b) {
        header.push_back(shape.bins[b].first_vertex | shape.bins[b].least_level << PRECISION_BIN_LEVEL_SHIFT);
        header.push_back(bit);
        bit += (shape.bin_end(b) - shape.bins[b].first_vertex) * shape.record_bits(shape.bin_level(b, level));
    }
    return header;
}

std::vector<uint32_t> pack_precision(const PrecisionShape& shape, std::span<const uint32_t> words, uint32_t level) {
    assert(check_shape(shape).ok() && words.size() == size_t{shape.vertices} * shape.components);
    std::vector<uint32_t> buffer = precision_header(shape, level);
    bits::BitWriter payload;
    for (size_t b = 0; b < shape.bins.size(); ++b) {
        const uint32_t own = shape.bin_level(b, level);
        for (size_t v = shape.bins[b].first_vertex; v < shape.bin_end(b); ++v) {
            for (uint32_t c = 0; c < shape.components; ++c) {
                payload.put(words[v * shape.components + c] >> (shape.full_bits - own), shape.field_bits(c, own));
            }
        }
    }
    const std::vector<uint32_t> packed = payload.finish();
    buffer.insert(buffer.end(), packed.begin(), packed.end());
    return buffer;
}

std::vector<uint32_t> precision_plane(const PrecisionShape& shape, std::span<const uint32_t> words, uint32_t plane) {
    bits::BitWriter out;
    const size_t count = shape.plane_vertices(plane);
    const uint32_t shift = shape.full_bits - 1 - plane;
    for (uint32_t c = 0; c < shape.components; ++c) {
        if (shape.leading[c] > plane) continue;
        for (size_t v = 0; v < count; ++v) out.put(words[v * shape.components + c] >> shift & 1, 1);
    }
    return out.finish();
}

Result<PrecisionHeader> read_precision_header(std::span<const uint32_t> words) {
    if (words.size() < PRECISION_WORD_BINS || words[PRECISION_WORD_MAGIC] != PRECISION_MAGIC)
        return Error{"precision buffer: no header", 0};
    const uint32_t bins = words[PRECISION_WORD_SHAPE] & 255;
    if ((words.size() - PRECISION_WORD_BINS) / PRECISION_BIN_WORDS < bins)
        return Error{"precision buffer: truncated bins", 4 * words.size()};
    const PrecisionHeader read{shape_of(words), words[PRECISION_WORD_SHAPE] >> 24};
    if (const Status status = check_shape(read.shape); !status) return status.error();
    if (read.level > read.shape.full_bits) return Error{"precision buffer: level", 4 * PRECISION_WORD_SHAPE};
    const std::vector<uint32_t> header = precision_header(read.shape, read.level);
    if (!std::equal(header.begin(), header.end(), words.begin()))
        return Error{"precision buffer: first bits of bins", 4 * PRECISION_WORD_BINS};
    return read;
}

Result<PrecisionView> PrecisionView::create(std::span<const uint32_t> words) {
    Result<PrecisionHeader> header = read_precision_header(words);
    if (!header) return header.error();
    PrecisionView view;
    view.words_ = words;
    view.shape_ = std::move(header->shape);
    view.level_ = header->level;
    if (words.size() != view.shape_.words_at(view.level_)) return Error{"precision buffer: length", 4 * words.size()};
    if (!unused_bits_are_zero(words, view.shape_.payload_bits(view.level_)))
        return Error{"precision buffer: unused bits", 4 * (words.size() - 1)};
    return view;
}

uint32_t PrecisionView::fetch(uint32_t vertex, std::span<uint32_t> out) const {
    const size_t bin = bin_of(shape_, vertex);
    const uint32_t own = shape_.bin_level(bin, level_);
    uint64_t bit = uint64_t{32} * shape_.header_words() + words_[PRECISION_WORD_BINS + PRECISION_BIN_WORDS * bin + 1] +
                   uint64_t{vertex - shape_.bins[bin].first_vertex} * shape_.record_bits(own);
    for (uint32_t c = 0; c < shape_.components; ++c) {
        const uint32_t bits = shape_.field_bits(c, own);
        out[c] = bits::read_bits(words_, bit, bits) << (shape_.full_bits - own);
        bit += bits;
    }
    return own;
}

Result<std::vector<uint32_t>> change_level(const PrecisionView& buffer, uint32_t to_level,
                                           std::span<const uint32_t> planes) {
    const PrecisionShape& shape = buffer.shape();
    const uint32_t from_level = buffer.level();
    if (to_level > shape.full_bits) return Error{"precision buffer: no such level"};
    if (planes.size() != shape.words_between(from_level, to_level))
        return Error{"precision planes: length", 4 * planes.size()};
    const PlaneReader reader(shape, planes, from_level);
    bits::BitWriter payload;
    std::array<uint32_t, PRECISION_MOST_COMPONENTS> words{};
    for (size_t b = 0; b < shape.bins.size(); ++b) {
        const uint32_t to = shape.bin_level(b, to_level);
        for (uint32_t v = shape.bins[b].first_vertex; v < shape.bin_end(b); ++v) {
            const uint32_t from = buffer.fetch(v, words);
            for (uint32_t c = 0; c < shape.components; ++c) {
                uint32_t word = words[c];
                for (uint32_t plane = std::max(from, shape.leading[c]); plane < to; ++plane) {
                    word |= reader.bit(plane, c, v) << (shape.full_bits - 1 - plane);
                }
                payload.put(word >> (shape.full_bits - to), shape.field_bits(c, to));
            }
        }
    }
    std::vector<uint32_t> result = precision_header(shape, to_level);
    const std::vector<uint32_t> packed = payload.finish();
    result.insert(result.end(), packed.begin(), packed.end());
    return result;
}

}  // namespace citystream::codec::mesh
