#include "codec/facade/facade_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>

#include "codec/bits/bit_stream.h"
#include "codec/facade/facade_layout.h"

namespace citystream::codec::facade {

namespace {

using bits::bits_for;
using bits::BitWriter;
using bits::read_bits;
using bits::words_for;

constexpr uint32_t kMaxSide = 8192;
constexpr uint32_t kMaxLabels = 65535;
constexpr uint32_t kLabelBits = 20;  ///< 16 of displacement, 4 of material

uint32_t label_of(const FacadeImage& image, size_t texel) {
    return static_cast<uint16_t>(image.displacement_mm[texel]) | uint32_t{image.material[texel]} << 16;
}

int32_t depth_of(uint32_t label) {
    return static_cast<int16_t>(label & 0xffffu);
}

Status check_image(const FacadeImage& image) {
    if (image.width == 0 || image.height == 0 || image.width > kMaxSide || image.height > kMaxSide) {
        return Error{"facade of " + std::to_string(image.width) + " x " + std::to_string(image.height) +
                     " texels, allowed are 1.." + std::to_string(kMaxSide)};
    }
    const size_t texels = size_t{image.width} * image.height;
    if (image.displacement_mm.size() != texels || image.material.size() != texels) {
        return Error{"facade matrices do not have width x height entries"};
    }
    const auto wrong = std::find_if(image.material.begin(), image.material.end(),
                                    [](uint8_t slot) { return slot >= FACADE_PALETTE_SLOTS; });
    if (wrong != image.material.end()) {
        return Error{"material slot " + std::to_string(*wrong) + " at texel " +
                     std::to_string(wrong - image.material.begin()) + ", allowed are 0..15"};
    }
    return Done{};
}

/// Where adjacent columns differ: 0, the cuts, width.
std::vector<uint32_t> column_breaks(const FacadeImage& image) {
    std::vector<uint8_t> cut(image.width, 0);
    for (size_t row = 0; row < image.height; ++row) {
        const int16_t* depth = &image.displacement_mm[row * image.width];
        const uint8_t* material = &image.material[row * image.width];
        for (size_t x = 1; x < image.width; ++x) {
            cut[x] |= static_cast<uint8_t>((depth[x] != depth[x - 1]) | (material[x] != material[x - 1]));
        }
    }
    std::vector<uint32_t> breaks = {0};
    for (uint32_t x = 1; x < image.width; ++x) {
        if (cut[x] != 0) breaks.push_back(x);
    }
    breaks.push_back(image.width);
    return breaks;
}

/// Where adjacent rows differ: 0, the cuts, height.
std::vector<uint32_t> row_breaks(const FacadeImage& image) {
    std::vector<uint32_t> breaks = {0};
    for (uint32_t y = 1; y < image.height; ++y) {
        const size_t here = size_t{y} * image.width;
        const size_t below = here - image.width;
        const bool equal =
            std::equal(&image.displacement_mm[here], &image.displacement_mm[here] + image.width,
                       &image.displacement_mm[below]) &&
            std::equal(&image.material[here], &image.material[here] + image.width, &image.material[below]);
        if (!equal) breaks.push_back(y);
    }
    breaks.push_back(image.height);
    return breaks;
}

/// The distinct labels of a map, sorted, and the rank of each: a bit set over all possible labels with running counts.
class LabelSet {
  public:
    void add(uint32_t label) { present_[label / 64] |= uint64_t{1} << (label % 64); }

    /// Call once, when all labels are in.
    std::vector<uint32_t> sorted() {
        std::vector<uint32_t> labels;
        for (uint32_t word = 0; word < present_.size(); ++word) {
            before_[word] = static_cast<uint32_t>(labels.size());
            for (uint64_t rest = present_[word]; rest != 0; rest &= rest - 1) {
                labels.push_back(word * 64 + static_cast<uint32_t>(std::countr_zero(rest)));
            }
        }
        return labels;
    }

    uint32_t rank(uint32_t label) const {
        const uint64_t below = present_[label / 64] & ((uint64_t{1} << (label % 64)) - 1);
        return before_[label / 64] + static_cast<uint32_t>(std::popcount(below));
    }

  private:
    std::vector<uint64_t> present_ = std::vector<uint64_t>((1u << kLabelBits) / 64, 0);
    std::vector<uint32_t> before_ = std::vector<uint32_t>((1u << kLabelBits) / 64, 0);
};

template <typename Visit>
void for_each_cell(const FacadeImage& image, const std::vector<uint32_t>& x_breaks,
                   const std::vector<uint32_t>& y_breaks, Visit visit) {
    for (size_t row = 0; row + 1 < y_breaks.size(); ++row) {
        const size_t first = size_t{y_breaks[row]} * image.width;
        for (size_t column = 0; column + 1 < x_breaks.size(); ++column)
            visit(label_of(image, first + x_breaks[column]));
    }
}

void append_halves(std::vector<uint32_t>& words, const std::vector<uint32_t>& values) {
    BitWriter writer;
    for (const uint32_t value : values) writer.put(value, 16);
    const std::vector<uint32_t> part = writer.finish();
    words.insert(words.end(), part.begin(), part.end());
}

}  // namespace

Result<std::vector<uint32_t>> encode_facade_map(const FacadeImage& image) {
    if (const Status status = check_image(image); !status) return status.error();
    const std::vector<uint32_t> x_breaks = column_breaks(image);
    const std::vector<uint32_t> y_breaks = row_breaks(image);
    LabelSet set;
    for_each_cell(image, x_breaks, y_breaks, [&set](uint32_t label) { set.add(label); });
    const std::vector<uint32_t> labels = set.sorted();
    if (labels.size() > kMaxLabels) {
        return Error{"facade with " + std::to_string(labels.size()) +
                     " distinct pairs of displacement and material, allowed are " + std::to_string(kMaxLabels)};
    }
    const auto [least, greatest] = std::minmax_element(
        labels.begin(), labels.end(), [](uint32_t a, uint32_t b) { return depth_of(a) < depth_of(b); });
    const uint32_t cell_bits = bits_for(labels.size() - 1);

    std::vector<uint32_t> words(FACADE_MAP_HEADER_WORDS, 0);
    words[FACADE_MAP_WORD_MAGIC] = FACADE_MAP_MAGIC;
    words[FACADE_MAP_WORD_CELLS] = static_cast<uint32_t>((x_breaks.size() - 1) | (y_breaks.size() - 1) << 16);
    words[FACADE_MAP_WORD_SIZE] = image.width | image.height << 16;
    words[FACADE_MAP_WORD_DEPTHS] = (*least & 0xffffu) | *greatest << 16;
    words[FACADE_MAP_WORD_LABELS] = static_cast<uint32_t>(labels.size()) | cell_bits << 16;
    append_halves(words, x_breaks);
    const auto y_offset = static_cast<uint32_t>(words.size());
    append_halves(words, y_breaks);
    words[FACADE_MAP_WORD_OFFSETS] = y_offset | static_cast<uint32_t>(words.size()) << 16;
    words.insert(words.end(), labels.begin(), labels.end());
    words[FACADE_MAP_WORD_CELL_DATA] = static_cast<uint32_t>(words.size());
    BitWriter cells;
    for_each_cell(image, x_breaks, y_breaks, [&](uint32_t label) { cells.put(set.rank(label), cell_bits); });
    const std::vector<uint32_t> packed = cells.finish();
    words.insert(words.end(), packed.begin(), packed.end());
    return words;
}

namespace {

Error error_at(std::string message, uint64_t word) {
    return Error{"facade map: " + std::move(message), word * 4};
}

uint32_t half(std::span<const uint32_t> words, uint64_t offset, uint32_t i) {
    return words[offset + i / 2] >> (16 * (i & 1u)) & 0xffffu;
}
uint32_t low_half(uint32_t word) {
    return word & 0xffffu;
}
uint32_t high_half(uint32_t word) {
    return word >> 16;
}

/// `cells` + 1 rising numbers from 0 to `size`, between the header and the end.
Status check_breaks(std::span<const uint32_t> words, uint64_t offset, uint32_t cells, uint32_t size) {
    if (size == 0 || size > kMaxSide) return error_at("size out of range", FACADE_MAP_WORD_SIZE);
    if (cells == 0 || cells > size) return error_at("number of cells out of range", FACADE_MAP_WORD_CELLS);
    if (offset < FACADE_MAP_HEADER_WORDS || offset + words_for(uint64_t{cells} + 1, 16) > words.size()) {
        return error_at("breaks reach outside the map", FACADE_MAP_WORD_OFFSETS);
    }
    if (half(words, offset, 0) != 0 || half(words, offset, cells) != size) {
        return error_at("breaks do not span the facade", offset);
    }
    for (uint32_t i = 0; i < cells; ++i) {
        if (half(words, offset, i) >= half(words, offset, i + 1)) return error_at("breaks do not rise", offset + i / 2);
    }
    return Done{};
}

/// Distinct sorted labels whose displacements span exactly what the header says: the ray caster's volume holds every
/// surface.
Status check_labels(std::span<const uint32_t> words) {
    const uint64_t offset = high_half(words[FACADE_MAP_WORD_OFFSETS]);
    const uint32_t count = low_half(words[FACADE_MAP_WORD_LABELS]);
    if (count == 0 || offset < FACADE_MAP_HEADER_WORDS || offset + count > words.size()) {
        return error_at("labels reach outside the map", FACADE_MAP_WORD_LABELS);
    }
    int32_t least = depth_of(words[offset]);
    int32_t greatest = least;
    for (uint64_t i = offset; i < offset + count; ++i) {
        if (words[i] >> kLabelBits != 0) return error_at("material slot out of range", i);
        if (i > offset && words[i] <= words[i - 1]) return error_at("labels do not rise", i);
        least = std::min(least, depth_of(words[i]));
        greatest = std::max(greatest, depth_of(words[i]));
    }
    const uint32_t depths = words[FACADE_MAP_WORD_DEPTHS];
    if (depth_of(depths) != least || depth_of(high_half(depths)) != greatest) {
        return error_at("range of displacements is not that of the labels", FACADE_MAP_WORD_DEPTHS);
    }
    return Done{};
}

Status check_cells(std::span<const uint32_t> words) {
    const uint32_t labels = low_half(words[FACADE_MAP_WORD_LABELS]);
    const uint32_t cell_bits = high_half(words[FACADE_MAP_WORD_LABELS]);
    if (cell_bits != bits_for(labels - 1))
        return error_at("cell width does not fit the labels", FACADE_MAP_WORD_LABELS);
    const uint64_t cells = uint64_t{low_half(words[FACADE_MAP_WORD_CELLS])} * high_half(words[FACADE_MAP_WORD_CELLS]);
    const uint64_t offset = words[FACADE_MAP_WORD_CELL_DATA];
    if (offset < FACADE_MAP_HEADER_WORDS || offset > words.size() ||
        words_for(cells, cell_bits) > words.size() - offset) {
        return error_at("cells reach outside the map", FACADE_MAP_WORD_CELL_DATA);
    }
    if (cell_bits == 0) return Done{};
    uint64_t bit = offset * 32;
    for (uint64_t i = 0; i < cells; ++i, bit += cell_bits) {
        if (read_bits(words, bit, cell_bits) >= labels) return error_at("cell without a label", bit / 32);
    }
    return Done{};
}

}  // namespace

Result<FacadeMapView> FacadeMapView::create(std::span<const uint32_t> words) {
    if (words.size() < FACADE_MAP_HEADER_WORDS) return error_at("shorter than its header", words.size());
    // Bit addresses in the shader are 32-bit; the largest legal map (8192 x 8192 cells of 16 bits) stays far below.
    if (words.size() >= 1u << 27) return error_at("too large", 0);
    if (words[FACADE_MAP_WORD_MAGIC] != FACADE_MAP_MAGIC) return error_at("wrong magic", FACADE_MAP_WORD_MAGIC);
    const uint32_t cells = words[FACADE_MAP_WORD_CELLS];
    const uint32_t size = words[FACADE_MAP_WORD_SIZE];
    if (const Status status = check_breaks(words, FACADE_MAP_HEADER_WORDS, low_half(cells), low_half(size)); !status)
        return status.error();
    if (const Status status =
            check_breaks(words, low_half(words[FACADE_MAP_WORD_OFFSETS]), high_half(cells), high_half(size));
        !status) {
        return status.error();
    }
    if (const Status status = check_labels(words); !status) return status.error();
    if (const Status status = check_cells(words); !status) return status.error();
    FacadeMapView view;
    view.words_ = words;
    return view;
}

uint32_t FacadeMapView::width() const {
    return low_half(words_[FACADE_MAP_WORD_SIZE]);
}
uint32_t FacadeMapView::height() const {
    return high_half(words_[FACADE_MAP_WORD_SIZE]);
}
uint32_t FacadeMapView::columns() const {
    return low_half(words_[FACADE_MAP_WORD_CELLS]);
}
uint32_t FacadeMapView::rows() const {
    return high_half(words_[FACADE_MAP_WORD_CELLS]);
}
int32_t FacadeMapView::depth_min_mm() const {
    return depth_of(words_[FACADE_MAP_WORD_DEPTHS]);
}
int32_t FacadeMapView::depth_max_mm() const {
    return depth_of(high_half(words_[FACADE_MAP_WORD_DEPTHS]));
}
uint32_t FacadeMapView::x_break(uint32_t i) const {
    return half(words_, FACADE_MAP_HEADER_WORDS, i);
}
uint32_t FacadeMapView::y_break(uint32_t i) const {
    return half(words_, low_half(words_[FACADE_MAP_WORD_OFFSETS]), i);
}

uint32_t FacadeMapView::label(uint32_t column, uint32_t row) const {
    const uint32_t cell_bits = high_half(words_[FACADE_MAP_WORD_LABELS]);
    const uint64_t cell = uint64_t{row} * columns() + column;
    const uint32_t rank =
        read_bits(words_, uint64_t{words_[FACADE_MAP_WORD_CELL_DATA]} * 32 + cell * cell_bits, cell_bits);
    return words_[high_half(words_[FACADE_MAP_WORD_OFFSETS]) + rank];
}

Result<FacadeImage> decode_facade_map(std::span<const uint32_t> words) {
    const Result<FacadeMapView> created = FacadeMapView::create(words);
    if (!created) return created.error();
    const FacadeMapView& map = *created;
    FacadeImage image;
    image.width = map.width();
    image.height = map.height();
    const size_t texels = size_t{image.width} * image.height;
    image.displacement_mm.resize(texels);
    image.material.resize(texels);
    for (uint32_t row = 0; row < map.rows(); ++row) {
        const size_t first = size_t{map.y_break(row)} * image.width;
        for (uint32_t column = 0; column < map.columns(); ++column) {
            const uint32_t label = map.label(column, row);
            const size_t run = map.x_break(column + 1) - map.x_break(column);
            std::fill_n(&image.displacement_mm[first + map.x_break(column)], run,
                        static_cast<int16_t>(depth_of(label)));
            std::fill_n(&image.material[first + map.x_break(column)], run, static_cast<uint8_t>(label >> 16));
        }
        for (uint32_t y = map.y_break(row) + 1; y < map.y_break(row + 1); ++y) {
            const size_t here = size_t{y} * image.width;
            std::copy_n(&image.displacement_mm[first], image.width, &image.displacement_mm[here]);
            std::copy_n(&image.material[first], image.width, &image.material[here]);
        }
    }
    return image;
}

}  // namespace citystream::codec::facade
