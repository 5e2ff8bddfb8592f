#include "codec/mesh/local_strips.h"

#include <algorithm>
#include <bit>

#include "codec/bits/bit_stream.h"
#include "codec/mesh/local_strips_layout.h"

namespace citystream::codec::mesh {

namespace {

using Words = std::span<const uint32_t>;

/// Bits 0..place.
uint64_t up_to(uint32_t place) {
    return ~uint64_t{0} >> (63 - place);
}
uint32_t count(uint64_t bits) {
    return static_cast<uint32_t>(std::popcount(bits));
}
uint32_t highest(uint64_t bits) {
    return 63 - static_cast<uint32_t>(std::countl_zero(bits));
}

uint32_t groups_of(uint32_t triangles) {
    return (triangles + LOCAL_STRIPS_GROUP_TRIANGLES - 1) >> LOCAL_STRIPS_GROUP_SHIFT;
}
uint32_t blocks_of(uint32_t groups) {
    return (groups + LOCAL_STRIPS_BLOCK_GROUPS - 1) >> LOCAL_STRIPS_BLOCK_SHIFT;
}

/// One group, unpacked as far as all its triangles share it.
struct Group {
    Words words;
    uint32_t base, low, width, slope;
    bool has_two_frames, has_restarts;
    bool is_valid;  ///< the head
    uint64_t payload;
    uint64_t steps, restarts;       ///< restarts with the first triangle
    uint64_t new_bits, fields_bit;  ///< where the bits of references and the fields begin, in bits

    uint32_t references(uint32_t triangles) const { return triangles + 2 * count(restarts & up_to(triangles - 1)); }
    bool is_new(uint32_t j) const { return bits::read_bits(words, new_bits + j, 1) != 0; }
    uint32_t new_before(uint32_t j) const {
        uint32_t sum = 0;
        for (uint32_t begin = 0; begin < j; begin += 32)
            sum += count(bits::read_bits(words, new_bits + begin, std::min(32u, j - begin)));
        return sum;
    }
    uint32_t vertex(uint32_t j) const {
        const uint32_t before = new_before(j);
        if (is_new(j)) return base + before;
        const uint32_t k = j - before, field = bits::read_bits(words, fields_bit + uint64_t{k} * width, width);
        const uint32_t top = has_two_frames ? 1u << (width - 1) : 0;
        if ((field & top) != 0) return (base + before - 1 - (field ^ top)) & LOCAL_STRIPS_VERTEX_MASK;
        return (low + slope * k + field) & LOCAL_STRIPS_VERTEX_MASK;
    }
};

/// The head of a group. Nothing of its payload is looked at.
Group read_head(Words words, uint32_t index, uint32_t groups) {
    const uint64_t block_at =
        LOCAL_STRIPS_HEADER_WORDS + uint64_t{index >> LOCAL_STRIPS_BLOCK_SHIFT} * LOCAL_STRIPS_BLOCK_WORDS;
    const uint64_t at = LOCAL_STRIPS_HEADER_WORDS + uint64_t{blocks_of(groups)} * LOCAL_STRIPS_BLOCK_WORDS +
                        uint64_t{index} * LOCAL_STRIPS_GROUP_WORDS;
    const uint32_t head = words[at];
    Group group{};
    group.words = words;
    group.base = words[block_at + LOCAL_STRIPS_BLOCK_BASE] + (head & LOCAL_STRIPS_SINCE_MASK);
    group.payload = uint64_t{words[block_at + LOCAL_STRIPS_BLOCK_PAYLOAD]} +
                    (head >> LOCAL_STRIPS_PAYLOAD_BIT & LOCAL_STRIPS_SINCE_MASK);
    group.width = head >> LOCAL_STRIPS_WIDTH_BIT & LOCAL_STRIPS_WIDTH_MASK;
    const uint32_t slope = head >> LOCAL_STRIPS_SLOPE_BIT & LOCAL_STRIPS_SLOPE_MASK;
    group.slope = slope == LOCAL_STRIPS_SLOPE_DOWN ? 0 - 1u : slope;
    group.has_restarts = head >> LOCAL_STRIPS_RESTARTS_BIT != 0;
    group.low = words[at + 1] & LOCAL_STRIPS_VERTEX_MASK;
    group.has_two_frames = (words[at + 1] >> LOCAL_STRIPS_FRAMES_BIT & 1) != 0;
    group.is_valid = slope <= LOCAL_STRIPS_SLOPE_DOWN && group.width <= LOCAL_STRIPS_MOST_WIDTH &&
                     words[at + 1] >> LOCAL_STRIPS_FRAMES_BIT <= (group.width > 0 ? 1u : 0u);
    return group;
}

/// Steps and restarts; `triangles` is how many the group has.
void read_masks(Group& group, uint32_t triangles) {
    const Words at = group.words.subspan(group.payload);
    group.steps = at[0] | uint64_t{at[1]} << 32;
    group.restarts = 1 | (group.has_restarts ? at[2] | uint64_t{at[3]} << 32 : 0);
    group.new_bits = 32 * (group.payload + (group.has_restarts ? 4 : 2));
    group.fields_bit = group.new_bits + 32 * bits::words_for(group.references(triangles), 1);
}

uint32_t triangles_in(uint32_t index, uint32_t triangles) {
    return std::min<uint32_t>(LOCAL_STRIPS_GROUP_TRIANGLES, triangles - (index << LOCAL_STRIPS_GROUP_SHIFT));
}

/// References of triangle t of a group, as numbers within the group.
std::array<uint32_t, 3> references_of(const Group& group, uint32_t t) {
    const uint32_t last = t + 2 * count(group.restarts & up_to(t));
    const uint32_t restart = highest(group.restarts & up_to(t));
    if (restart == t) return {last - 2, last - 1, last};
    // The strip turned where a step differs from the one before, or at its second triangle.
    const uint64_t turns = ((group.steps ^ group.steps << 1) & ~up_to(restart + 1)) | uint64_t{1} << (restart + 1);
    const uint32_t turn = highest(turns & up_to(t));
    const bool is_next = (group.steps >> t & 1) != 0;
    const uint32_t kept = last - (t - turn) - (turn == restart + 1 && !is_next ? 3 : 2);
    return is_next ? std::array{last - 1, kept, last} : std::array{kept, last - 1, last};
}

Error wrong(const char* what, uint64_t word) {
    return Error{what, 4 * word};
}

/// Counts what the groups have as it checks them one after the other.
class Checker {
  public:
    Checker(Words words) : words_(words) {}

    Status check() {
        if (words_.size() < LOCAL_STRIPS_HEADER_WORDS || words_[LOCAL_STRIPS_WORD_MAGIC] != LOCAL_STRIPS_MAGIC)
            return wrong("not local strips", 0);
        triangles_ = words_[LOCAL_STRIPS_WORD_TRIANGLES];
        vertices_ = words_[LOCAL_STRIPS_WORD_VERTICES];
        if (triangles_ > LOCAL_STRIPS_MOST_TRIANGLES || vertices_ > LOCAL_STRIPS_MOST_VERTICES ||
            words_[LOCAL_STRIPS_WORD_WORDS] != words_.size())
            return wrong("local strips have counts that cannot be", LOCAL_STRIPS_WORD_TRIANGLES);
        groups_ = groups_of(triangles_);
        end_ = LOCAL_STRIPS_HEADER_WORDS + uint64_t{blocks_of(groups_)} * LOCAL_STRIPS_BLOCK_WORDS +
               uint64_t{groups_} * LOCAL_STRIPS_GROUP_WORDS;
        if (end_ > words_.size()) return wrong("local strips end within their heads", words_.size());
        for (uint32_t g = 0; g < groups_; ++g) {
            if (g % LOCAL_STRIPS_BLOCK_GROUPS == 0 && !block_is_right(g / LOCAL_STRIPS_BLOCK_GROUPS))
                return wrong("block of local strips begins elsewhere", end_);
            Status group = check_group(g);
            if (!group) return group;
        }
        if (end_ != words_.size()) return wrong("words after local strips", end_);
        return Done{};
    }

  private:
    bool block_is_right(uint32_t block) const {
        const Words at = words_.subspan(LOCAL_STRIPS_HEADER_WORDS + size_t{block} * LOCAL_STRIPS_BLOCK_WORDS);
        return at[LOCAL_STRIPS_BLOCK_BASE] == met_ && at[LOCAL_STRIPS_BLOCK_PAYLOAD] == end_;
    }

    Status check_group(uint32_t index) {
        Group group = read_head(words_, index, groups_);
        if (group.base != met_ || group.payload != end_) return wrong("group of local strips begins elsewhere", end_);
        if (!group.is_valid) return wrong("head of local strips cannot be", end_);
        const uint32_t triangles = triangles_in(index, triangles_);
        if (end_ + (group.has_restarts ? 4 : 2) > words_.size()) return wrong("local strips end within a group", end_);
        read_masks(group, triangles);
        const uint64_t restarts = group.restarts ^ 1;
        if (group.has_restarts != (restarts != 0) || (group.steps & group.restarts) != 0 ||
            ((group.steps | restarts) & ~up_to(triangles - 1)) != 0)
            return wrong("steps of local strips cannot be", end_);
        return check_references(group, group.references(triangles));
    }

    Status check_references(const Group& group, uint32_t references) {
        if (group.fields_bit > 32 * uint64_t{words_.size()}) return wrong("local strips end within a group", end_);
        const uint64_t new_end = group.fields_bit - group.new_bits;
        const uint32_t added = group.new_before(references);
        for (uint64_t bit = references; bit < new_end; ++bit) {
            if (group.is_new(static_cast<uint32_t>(bit))) return wrong("local strips have bits to spare", end_);
        }
        const uint64_t fields = uint64_t{references - added} * group.width, field_words = (fields + 31) / 32;
        end_ = group.fields_bit / 32 + field_words;
        if (end_ > words_.size()) return wrong("local strips end within a group", end_);
        if (fields % 32 != 0 && words_[end_ - 1] >> fields % 32 != 0)
            return wrong("local strips have bits to spare", end_);
        if (uint64_t{met_} + added > vertices_) return wrong("local strips have too many vertices", end_);
        for (uint32_t j = 0; j < references; ++j) {
            if (group.vertex(j) >= vertices_) return wrong("vertex of local strips out of range", end_);
        }
        met_ += added;
        return Done{};
    }

    Words words_;
    uint32_t triangles_ = 0, vertices_ = 0, groups_ = 0;
    uint32_t met_ = 0;
    uint64_t end_ = 0;  ///< of the payloads so far, in words
};

}  // namespace

Status check_local_strips(Words words) {
    return Checker(words).check();
}

std::array<uint32_t, 3> local_triangle(Words words, uint32_t index) {
    const uint32_t triangles = words[LOCAL_STRIPS_WORD_TRIANGLES], g = index >> LOCAL_STRIPS_GROUP_SHIFT;
    Group group = read_head(words, g, groups_of(triangles));
    read_masks(group, triangles_in(g, triangles));
    const auto [a, b, c] = references_of(group, index & (LOCAL_STRIPS_GROUP_TRIANGLES - 1));
    return {group.vertex(a), group.vertex(b), group.vertex(c)};
}

Result<std::vector<std::array<uint32_t, 3>>> decode_local_strips(Words words) {
    const Status status = check_local_strips(words);
    if (!status) return status.error();
    std::vector<std::array<uint32_t, 3>> triangles(words[LOCAL_STRIPS_WORD_TRIANGLES]);
    for (uint32_t i = 0; i < triangles.size(); ++i) triangles[i] = local_triangle(words, i);
    return triangles;
}

}  // namespace citystream::codec::mesh
