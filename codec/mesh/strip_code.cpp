#include "codec/mesh/strip_code.h"

#include <algorithm>
#include <bit>

#include "codec/bits/bit_stream.h"
#include "codec/bits/range_coder.h"
#include "codec/bits/simple9.h"
#include "codec/mesh/strip_layout.h"

namespace citystream::codec::mesh {

static_assert(bits::kSimple9Selectors == SIMPLE9_SELECTORS);

namespace {

using Words = std::span<const uint32_t>;
using Corners = std::array<uint32_t, 3>;

uint32_t step_bits(const StripHeader& header) {
    return header.mode == STRIP_MODE_RESTARTS ? 2 : 1;
}

/// The step of triangle i, as in mode 0 apart from the first of mode 1, which is P.
uint32_t step_of(Words words, const StripHeader& header, uint64_t i) {
    return bits::read_bits(words.subspan(header.steps_at), i * step_bits(header), step_bits(header));
}

uint32_t increment_of(Words words, const StripHeader& header, uint64_t j) {
    return bits::read_bits(words.subspan(header.increments_at), j, 1);
}

bool counts_are_possible(const StripHeader& header) {
    const uint64_t triangles = header.triangles, references = header.references;
    if (triangles > STRIP_MOST_TRIANGLES || header.vertices > STRIP_MOST_VERTICES) return false;
    if (triangles == 0) return references == 0 && header.explicit_references == 0 && header.code_words == 0;
    if (header.explicit_references > references) return false;
    return header.mode == STRIP_MODE_RESTARTS ? references >= triangles + 2 && references <= 3 * triangles
                                              : references == triangles + 2;
}

/// Bits from `used` on of the last word of a part are 0.
bool padding_is_zero(Words part, uint64_t used) {
    return used % 32 == 0 || part[used / 32] >> used % 32 == 0;
}

/// Reads references and triangles one after the other from words whose header and Simple-9 words have been checked.
class StripReader {
  public:
    StripReader(Words words, const StripHeader& header) : words_(words), header_(header) {}

    /// Calls visit(corners) for each triangle; an error as soon as something cannot be.
    template <typename Visit>
    Status read(Visit visit) {
        Corners now{};
        for (uint32_t i = 0; i < header_.triangles; ++i) {
            const uint32_t step = step_of(words_, header_, i);
            if (step > STRIP_STEP_RESTART) return Error{"strip step does not exist"};
            if (i == 0 && step != (header_.mode == STRIP_MODE_RESTARTS ? STRIP_STEP_RESTART : STRIP_STEP_PREVIOUS))
                return Error{"strip does not begin with a restart"};
            if (i == 0 || step == STRIP_STEP_RESTART) {
                now = {next_reference(), next_reference(), next_reference()};
            } else {
                const uint32_t old = step == STRIP_STEP_PREVIOUS ? now[0] : now[1];
                now = step == STRIP_STEP_PREVIOUS ? Corners{old, now[2], 0} : Corners{now[2], old, 0};
                now[2] = next_reference();
            }
            if (failed_) return Error{"strip reference out of range"};
            visit(now);
        }
        if (position_ != header_.references || explicit_ != header_.explicit_references)
            return Error{"strip references are not all used"};
        return Done{};
    }

  private:
    uint32_t next_reference() {
        if (position_ >= header_.references) return fail();
        uint32_t vertex = 0;
        if (increment_of(words_, header_, position_++) != 0) {
            vertex = met_++;
        } else if (explicit_ < header_.explicit_references) {
            ++explicit_;
            vertex = next_explicit();
        } else {
            return fail();
        }
        return vertex < header_.vertices ? vertex : fail();
    }

    uint32_t next_explicit() {
        if (place_ == bits::simple9_count(words_[word_])) {
            ++word_;
            place_ = 0;
        }
        last_explicit_ += static_cast<uint32_t>(bits::unzigzag(bits::simple9_code(words_[word_], place_++)));
        return last_explicit_ += header_.prediction;
    }

    uint32_t fail() {
        failed_ = true;
        return 0;
    }

    Words words_;
    const StripHeader& header_;
    uint32_t position_ = 0, met_ = 0, explicit_ = 0, last_explicit_ = 0;
    size_t word_ = STRIP_HEADER_WORDS;
    uint32_t place_ = 0;
    bool failed_ = false;
};

/// Everything that can be checked without following the references.
Result<StripHeader> check_parts(Words words) {
    auto header = read_strip_header(words);
    if (!header) return header;
    const Status codes =
        bits::check_simple9(words.subspan(header->codes_at, header->code_words), header->explicit_references);
    if (!codes) return codes.error();
    if (!padding_is_zero(words.subspan(header->increments_at), header->references) ||
        !padding_is_zero(words.subspan(header->steps_at), uint64_t{header->triangles} * step_bits(*header)))
        return Error{"strip padding is not zero"};
    return header;
}

/// The scans of the GPU decoder: element i becomes the sum (or maximum) of all before it, with or without itself.
void scan_exclusive_sum(std::vector<uint32_t>& values) {
    uint32_t sum = 0;
    for (uint32_t& value : values) sum += std::exchange(value, sum);
}
void scan_inclusive_sum(std::vector<uint32_t>& values) {
    uint32_t sum = 0;
    for (uint32_t& value : values) value = sum += value;
}
void scan_inclusive_maximum(std::vector<uint32_t>& values) {
    uint32_t most = 0;
    for (uint32_t& value : values) value = most = std::max(most, value);
}

/// S_Scan, D_Scatter and U_Scan: the explicit references.
std::vector<uint32_t> explicit_references(Words words, const StripHeader& header) {
    const Words codes = words.subspan(header.codes_at, header.code_words);
    std::vector<uint32_t> begin(codes.size());
    std::transform(codes.begin(), codes.end(), begin.begin(), bits::simple9_count);
    scan_exclusive_sum(begin);
    std::vector<uint32_t> references(header.explicit_references);
    for (size_t l = 0; l < codes.size(); ++l) {
        for (uint32_t place = 0; place < bits::simple9_count(codes[l]); ++place) {
            if (begin[l] + place >= references.size()) continue;
            const int32_t difference = bits::unzigzag(bits::simple9_code(codes[l], place));
            references[begin[l] + place] = static_cast<uint32_t>(difference) + header.prediction;
        }
    }
    scan_inclusive_sum(references);
    return references;
}

/// INC_Scan and V_Kernel: the vertex of every reference.
std::vector<uint32_t> referenced_vertices(Words words, const StripHeader& header) {
    const std::vector<uint32_t> old = explicit_references(words, header);
    std::vector<uint32_t> met(header.references), vertices(header.references);
    for (uint32_t j = 0; j < met.size(); ++j) met[j] = increment_of(words, header, j);
    scan_exclusive_sum(met);
    for (uint32_t j = 0; j < vertices.size(); ++j)
        vertices[j] = increment_of(words, header, j) != 0 ? met[j] : old[j - met[j]];
    return vertices;
}

/// M_Scan: the last reference of every triangle.
std::vector<uint32_t> last_references(Words words, const StripHeader& header) {
    std::vector<uint32_t> last(header.triangles);
    for (uint32_t i = 0; i < last.size(); ++i)
        last[i] = i == 0 ? 2 : step_of(words, header, i) == STRIP_STEP_RESTART ? 3 : 1;
    scan_inclusive_sum(last);
    return last;
}

/// Q_Scan: the reference that a triangle keeps from further back than the one before its last.
std::vector<uint32_t> kept_references(Words words, const StripHeader& header, const std::vector<uint32_t>& last) {
    std::vector<uint32_t> kept(header.triangles, 0);
    for (uint32_t i = 1; i < kept.size(); ++i) {
        const uint32_t step = step_of(words, header, i), before = step_of(words, header, i - 1);
        if (before == STRIP_STEP_RESTART && step == STRIP_STEP_PREVIOUS) {
            kept[i] = last[i] - 3;
        } else {
            kept[i] = step == before ? 0 : last[i] - 2;
        }
    }
    scan_inclusive_maximum(kept);
    return kept;
}

}  // namespace

Result<StripHeader> read_strip_header(Words words) {
    if (words.size() < STRIP_HEADER_WORDS) return Error{"strip code is shorter than its header", 4 * words.size()};
    if (words[STRIP_WORD_MAGIC] != STRIP_MAGIC) return Error{"not a strip code", 0};
    StripHeader header;
    header.triangles = words[STRIP_WORD_TRIANGLES];
    header.references = words[STRIP_WORD_REFERENCES];
    header.explicit_references = words[STRIP_WORD_EXPLICIT];
    header.code_words = words[STRIP_WORD_CODE_WORDS];
    header.mode = words[STRIP_WORD_MODE] & STRIP_MODE_MASK;
    header.prediction = words[STRIP_WORD_MODE] >> STRIP_PREDICTION_BIT;
    header.vertices = words[STRIP_WORD_VERTICES];
    if (header.mode > STRIP_MODE_DEGENERATES || header.prediction > 1 || words[STRIP_WORD_ZERO] != 0)
        return Error{"strip code of an unknown mode", 4 * STRIP_WORD_MODE};
    if (!counts_are_possible(header)) return Error{"strip counts cannot be", 4 * STRIP_WORD_TRIANGLES};
    const uint64_t increments_at = STRIP_HEADER_WORDS + uint64_t{header.code_words};
    const uint64_t steps_at = increments_at + bits::words_for(header.references, 1);
    const uint64_t end = steps_at + bits::words_for(header.triangles, step_bits(header));
    if (end != words.size()) return Error{"strip code has another length than its counts say", 4 * words.size()};
    header.codes_at = STRIP_HEADER_WORDS;
    header.increments_at = static_cast<size_t>(increments_at);
    header.steps_at = static_cast<size_t>(steps_at);
    header.words = words.size();
    return header;
}

Status check_strip_code(Words words) {
    const auto header = check_parts(words);
    if (!header) return header.error();
    return StripReader(words, *header).read([](const Corners&) {});
}

Result<CornerList> decode_strips(Words words) {
    const auto header = check_parts(words);
    if (!header) return header.error();
    CornerList triangles;
    triangles.reserve(header->triangles);
    const Status read = StripReader(words, *header).read([&](const Corners& corners) { triangles.push_back(corners); });
    if (!read) return read.error();
    return triangles;
}

Result<CornerList> decode_strips_staged(Words words) {
    const Status status = check_strip_code(words);
    if (!status) return status.error();
    const StripHeader header = *read_strip_header(words);
    const std::vector<uint32_t> vertex = referenced_vertices(words, header);
    const std::vector<uint32_t> last = last_references(words, header);
    const std::vector<uint32_t> kept = kept_references(words, header, last);
    CornerList triangles(header.triangles);
    for (uint32_t i = 0; i < triangles.size(); ++i) {
        const uint32_t step = step_of(words, header, i), m = last[i], q = kept[i];
        if (step == STRIP_STEP_RESTART) {
            triangles[i] = {vertex[m - 2], vertex[m - 1], vertex[m]};
        } else if (step == STRIP_STEP_NEXT) {
            triangles[i] = {vertex[m - 1], vertex[q], vertex[m]};
        } else {
            triangles[i] = {vertex[q], vertex[m - 1], vertex[m]};
        }
    }
    return triangles;
}

}  // namespace citystream::codec::mesh
