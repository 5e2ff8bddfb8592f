#include "codec/radiance/radiance_resident.h"

#include <algorithm>
#include <numeric>

#include "codec/bits/bit_stream.h"

namespace citystream::codec::radiance {

namespace {

constexpr uint32_t kGroup = RADIANCE_START_GROUP;
constexpr int kLeastByte = -128;
constexpr uint64_t kMostRows = uint64_t{1} << 24;
constexpr uint64_t kMostBits = uint64_t{1} << 32;

uint64_t start_groups(uint64_t count) {
    return (count + kGroup) / kGroup;  // of count + 1 starts
}

/// Bits that the greatest start needs beyond its group's.
uint32_t start_bits(const std::vector<uint32_t>& starts) {
    uint32_t most = 0;
    for (size_t i = 0; i < starts.size(); ++i) most = std::max(most, starts[i] - starts[i / kGroup * kGroup]);
    return bits::bits_for(most);
}

class WordWriter {
  public:
    std::vector<uint32_t> words = std::vector<uint32_t>(RADIANCE_HEADER_WORDS, 0);

    void begin_part(uint32_t offset_word) { words[offset_word] = static_cast<uint32_t>(words.size()); }

    void add_starts(uint32_t offset_word, const std::vector<uint32_t>& starts, uint32_t field_bits) {
        begin_part(offset_word);
        for (size_t i = 0; i < starts.size(); i += kGroup) words.push_back(starts[i]);
        bits::BitWriter fields;
        for (size_t i = 0; i < starts.size(); ++i) fields.put(starts[i] - starts[i / kGroup * kGroup], field_bits);
        add(fields);
    }
    void add_fields(uint32_t offset_word, std::span<const uint32_t> values, uint32_t field_bits) {
        begin_part(offset_word);
        bits::BitWriter fields;
        for (const uint32_t value : values) fields.put(value, field_bits);
        add(fields);
    }

  private:
    void add(bits::BitWriter& fields) {
        const std::vector<uint32_t> more = fields.finish();
        words.insert(words.end(), more.begin(), more.end());
    }
};

/// Clusters of each row, rising.
struct Links {
    std::vector<uint32_t> begin, cluster;
};

Links links_of(const Biclusters& clusters) {
    Links links{std::vector<uint32_t>(size_t{clusters.rows} + 1, 0), std::vector<uint32_t>(clusters.row.size())};
    for (const uint32_t row : clusters.row) ++links.begin[row + 1];
    std::partial_sum(links.begin.begin(), links.begin.end(), links.begin.begin());
    std::vector<uint32_t> place(links.begin.begin(), links.begin.end() - 1);
    for (uint32_t i = 0; i < clusters.count(); ++i) {
        for (const uint32_t row : clusters.rows_of(i)) links.cluster[place[row]++] = i;
    }
    return links;
}

/// Bits for numbers below `count`.
uint32_t index_bits(uint32_t count) {
    return bits::bits_for(count == 0 ? 0 : count - 1);
}

/// Whether numbers begin..end - 1 rise and stay below `limit`: so there are no more of them than the limit, however few
/// bits they take.
template <typename NumberAt>
bool check_rising(uint32_t begin, uint32_t end, uint32_t limit, NumberAt number_at) {
    for (uint32_t m = begin; m < end; ++m) {
        if (number_at(m) >= limit || (m > begin && number_at(m) <= number_at(m - 1))) return false;
    }
    return true;
}

}  // namespace

std::vector<uint32_t> make_resident_radiance(const Biclusters& clusters, std::span<const uint32_t> row_of,
                                             uint32_t local_count) {
    if (32 * std::max({uint64_t{clusters.row.size()}, uint64_t{clusters.column.size()}, uint64_t{row_of.size()}}) >=
        kMostBits)
        return {};
    const Links links = links_of(clusters);
    const int least = clusters.value.empty() ? 0 : *std::min_element(clusters.value.begin(), clusters.value.end());
    const int most = clusters.value.empty() ? 0 : *std::max_element(clusters.value.begin(), clusters.value.end());
    const uint32_t column_bits = index_bits(clusters.columns),
                   quarter_bits = bits::bits_for(static_cast<uint64_t>(most - least));
    const uint32_t link_bits = index_bits(clusters.count()), row_bits = index_bits(clusters.rows);
    const uint32_t term_start_bits = start_bits(clusters.column_begin), link_start_bits = start_bits(links.begin);
    std::vector<uint32_t> terms;
    for (size_t i = 0; i < clusters.column.size(); ++i)
        terms.push_back(clusters.column[i] | static_cast<uint32_t>(clusters.value[i] - least) << column_bits);

    WordWriter writer;
    writer.words[RADIANCE_WORD_MAGIC] = RADIANCE_MAGIC;
    writer.words[RADIANCE_WORD_RECEIVERS] = static_cast<uint32_t>(row_of.size()) / local_count;
    writer.words[RADIANCE_WORD_LOCALS] = local_count;
    writer.words[RADIANCE_WORD_COLUMNS] = clusters.columns;
    writer.words[RADIANCE_WORD_ROWS] = clusters.rows;
    writer.words[RADIANCE_WORD_CLUSTERS] = clusters.count();
    writer.words[RADIANCE_WORD_TERMS] = static_cast<uint32_t>(clusters.column.size());
    writer.words[RADIANCE_WORD_LINKS] = static_cast<uint32_t>(clusters.row.size());
    writer.words[RADIANCE_WORD_BITS] = column_bits | quarter_bits << 8 | link_bits << 16 | row_bits << 24;
    writer.words[RADIANCE_WORD_START_BITS] =
        term_start_bits | link_start_bits << 8 | static_cast<uint32_t>(least - kLeastByte) << 16;
    writer.add_starts(RADIANCE_WORD_TERM_STARTS, clusters.column_begin, term_start_bits);
    writer.add_starts(RADIANCE_WORD_LINK_STARTS, links.begin, link_start_bits);
    writer.add_fields(RADIANCE_WORD_TERM_FIELDS, terms, column_bits + quarter_bits);
    writer.add_fields(RADIANCE_WORD_LINK_FIELDS, links.cluster, link_bits);
    writer.add_fields(RADIANCE_WORD_ROW_FIELDS, row_of, row_bits);
    return std::move(writer.words);
}

uint32_t ResidentRadianceView::field(uint32_t offset_word, uint32_t i, uint32_t field_bits) const {
    return bits::read_bits(words_, uint64_t{words_[offset_word]} * 32 + uint64_t{i} * field_bits, field_bits);
}

uint32_t ResidentRadianceView::start(uint32_t offset_word, uint32_t i, uint32_t count, uint32_t field_bits) const {
    const uint32_t base = words_[offset_word];
    const uint64_t fields = base + start_groups(count);
    return words_[base + i / kGroup] + bits::read_bits(words_, fields * 32 + uint64_t{i} * field_bits, field_bits);
}

uint32_t ResidentRadianceView::term_start(uint32_t cluster) const {
    return start(RADIANCE_WORD_TERM_STARTS, cluster, clusters(), bits(RADIANCE_WORD_START_BITS, 0));
}

uint32_t ResidentRadianceView::link_start(uint32_t row) const {
    return start(RADIANCE_WORD_LINK_STARTS, row, rows(), bits(RADIANCE_WORD_START_BITS, 8));
}

ResidentRadianceView::Term ResidentRadianceView::term(uint32_t i) const {
    const uint32_t column_bits = bits(RADIANCE_WORD_BITS, 0), quarter_bits = bits(RADIANCE_WORD_BITS, 8);
    const uint32_t value = field(RADIANCE_WORD_TERM_FIELDS, i, column_bits + quarter_bits);
    const int32_t least = static_cast<int32_t>(bits(RADIANCE_WORD_START_BITS, 16)) + kLeastByte;
    return {value & ((1u << column_bits) - 1), least + static_cast<int32_t>(value >> column_bits)};
}

uint32_t ResidentRadianceView::link(uint32_t i) const {
    return field(RADIANCE_WORD_LINK_FIELDS, i, bits(RADIANCE_WORD_BITS, 16));
}

uint32_t ResidentRadianceView::row_of(uint32_t receiver, uint32_t local) const {
    return field(RADIANCE_WORD_ROW_FIELDS, receiver * locals() + local, bits(RADIANCE_WORD_BITS, 24));
}

Status check_resident_header(std::span<const uint32_t> header, uint64_t words) {
    if (header.size() < RADIANCE_HEADER_WORDS || words < RADIANCE_HEADER_WORDS)
        return Error{"radiance words shorter than their header", 0};
    if (header[RADIANCE_WORD_MAGIC] != RADIANCE_MAGIC) return Error{"not radiance words", 0};
    const auto bits = [&](uint32_t word, uint32_t shift) { return header[word] >> shift & 0xff; };
    const uint32_t clusters = header[RADIANCE_WORD_CLUSTERS], rows = header[RADIANCE_WORD_ROWS];
    const uint32_t column_bits = bits(RADIANCE_WORD_BITS, 0), quarter_bits = bits(RADIANCE_WORD_BITS, 8);
    const uint32_t link_bits = bits(RADIANCE_WORD_BITS, 16), row_bits = bits(RADIANCE_WORD_BITS, 24);
    const uint32_t term_start_bits = bits(RADIANCE_WORD_START_BITS, 0),
                   link_start_bits = bits(RADIANCE_WORD_START_BITS, 8);
    if (column_bits > 16 || quarter_bits > 8 || std::max({link_bits, row_bits, term_start_bits, link_start_bits}) > 32)
        return Error{"radiance fields wider than they can be", RADIANCE_WORD_BITS * 4};
    struct Part {
        uint64_t words, fields;
        uint32_t field_bits, offset_word;
    };
    const uint64_t numbers = uint64_t{header[RADIANCE_WORD_RECEIVERS]} * header[RADIANCE_WORD_LOCALS];
    if (header[RADIANCE_WORD_RECEIVERS] > kMostReceivers || numbers > kMostRows)
        return Error{"radiance of more receivers than there may be", RADIANCE_WORD_RECEIVERS * 4};
    const Part parts[] = {{start_groups(clusters), uint64_t{clusters} + 1, term_start_bits, RADIANCE_WORD_TERM_STARTS},
                          {start_groups(rows), uint64_t{rows} + 1, link_start_bits, RADIANCE_WORD_LINK_STARTS},
                          {0, header[RADIANCE_WORD_TERMS], column_bits + quarter_bits, RADIANCE_WORD_TERM_FIELDS},
                          {0, header[RADIANCE_WORD_LINKS], link_bits, RADIANCE_WORD_LINK_FIELDS},
                          {0, numbers, row_bits, RADIANCE_WORD_ROW_FIELDS}};
    uint64_t at = RADIANCE_HEADER_WORDS;
    for (const Part& part : parts) {
        if (header[part.offset_word] != at)
            return Error{"a part of radiance words is not in its place", part.offset_word * 4};
        if (part.fields > kMostBits / 32) return Error{"more radiance fields than there may be", part.offset_word * 4};
        at += part.words + bits::words_for(part.fields, part.field_bits);
    }
    if (at != words) return Error{"radiance words do not end where their parts do", at * 4};
    return Done{};
}

Status ResidentRadianceView::check_content() const {
    const auto check_starts = [](uint32_t count, uint32_t total, const auto& start_of) {
        uint32_t last = start_of(0);
        if (last != 0) return false;
        for (uint32_t i = 1; i <= count; ++i) {
            const uint32_t next = start_of(i);
            if (next < last) return false;
            last = next;
        }
        return last == total;
    };
    if (!check_starts(clusters(), words_[RADIANCE_WORD_TERMS], [this](uint32_t i) { return term_start(i); }))
        return Error{"terms of clusters that do not follow each other",
                     words_[RADIANCE_WORD_TERM_STARTS] * uint64_t{4}};
    if (!check_starts(rows(), words_[RADIANCE_WORD_LINKS], [this](uint32_t j) { return link_start(j); }))
        return Error{"links of rows that do not follow each other", words_[RADIANCE_WORD_LINK_STARTS] * uint64_t{4}};
    for (uint32_t i = 0; i < clusters(); ++i) {
        if (!check_rising(term_start(i), term_start(i + 1), columns(), [this](uint32_t m) { return term(m).column; }))
            return Error{"a cluster whose columns are not there or do not rise",
                         words_[RADIANCE_WORD_TERM_FIELDS] * uint64_t{4}};
    }
    for (uint32_t j = 0; j < rows(); ++j) {
        if (!check_rising(link_start(j), link_start(j + 1), clusters(), [this](uint32_t m) { return link(m); }))
            return Error{"a row whose clusters are not there or do not rise",
                         words_[RADIANCE_WORD_LINK_FIELDS] * uint64_t{4}};
    }
    for (uint32_t r = 0; r < receivers(); ++r) {
        for (uint32_t j = 0; j < locals(); ++j) {
            if (row_of(r, j) >= rows())
                return Error{"a receiver with a row that is not there", words_[RADIANCE_WORD_ROW_FIELDS] * uint64_t{4}};
        }
    }
    return Done{};
}

Result<ResidentRadianceView> ResidentRadianceView::create(std::span<const uint32_t> words) {
    ResidentRadianceView view;
    view.words_ = words;
    if (const Status header = check_resident_header(words, words.size()); !header) return header.error();
    if (const Status content = view.check_content(); !content) return content.error();
    return view;
}

}  // namespace citystream::codec::radiance
