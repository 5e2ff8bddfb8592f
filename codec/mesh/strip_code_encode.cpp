#include <algorithm>
#include <bit>
#include <tuple>

#include "codec/bits/bit_stream.h"
#include "codec/bits/range_coder.h"
#include "codec/bits/simple9.h"
#include "codec/mesh/strip_code.h"
#include "codec/mesh/strip_layout.h"

namespace citystream::codec::mesh {

namespace {

using Corners = std::array<uint32_t, 3>;
using Triangles = std::span<const Corners>;
constexpr uint32_t kNone = ~uint32_t{0};

bool has_equal_corners(const Corners& corners) {
    return corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0];
}

/// A way to restart: references and steps one after the other; the last triangle is the one wanted, the others have two
/// equal corners. In restart mode it is one step with three references.
struct Restart {
    std::array<uint32_t, 5> references;
    std::array<StripStep, 5> steps;
    uint32_t reference_count, step_count;
    uint32_t turned;  ///< corners by which the triangle is rotated further
};

constexpr auto P = StripStep::kPrevious, N = StripStep::kNext, R = StripStep::kRestart;

/// All ways in degenerate mode from triangle (a, b, c) to (d, e, f).
void add_emulations(const Corners& from, const Corners& to, uint32_t turned, std::vector<Restart>& ways) {
    const auto& [a, b, c] = from;
    const auto& [d, e, f] = to;
    // A vertex x that both have, as the first or second corner of the new triangle: after two triangles the edge is
    // (x, x), (x, y), and the third reference closes the triangle.
    const std::pair<uint32_t, std::array<StripStep, 2>> shared[] = {{a, {P, P}}, {b, {N, N}}, {c, {N, P}}};
    for (const auto& [x, steps] : shared) {
        if (x == d) ways.push_back({{x, e, f}, {steps[0], steps[1], P}, 3, 3, turned});
        if (x == e) ways.push_back({{x, d, f}, {steps[0], steps[1], N}, 3, 3, turned});
    }
    // Any triangle: x is one of a, b, c, then d, d, e make the edge (d, e).
    for (const auto& [x, steps] : shared)
        ways.push_back({{x, d, d, e, f}, {steps[0], steps[1], P, N, P}, 5, 5, turned});
}

/// Writes references and steps in one mode. Numbers vertices as they come.
class StripWriter {
  public:
    StripWriter(Triangles triangles, uint32_t vertex_count, uint32_t mode)
        : triangles_(triangles), degenerates_(mode == STRIP_MODE_DEGENERATES), number_(vertex_count, kNone) {}

    void write(std::vector<StripTriangle> order) {
        for (size_t i = 0; i < order.size(); ++i) {
            StripTriangle* next = i + 1 < order.size() ? &order[i + 1] : nullptr;
            if (order[i].step == R) {
                restart(order[i], next != nullptr && next->step != R ? next : nullptr);
            } else {
                refer(strip_corners(triangles_, order[i])[2]);
                stream.push_back(order[i]);
            }
            last_ = strip_corners(triangles_, stream.back());
        }
        for (uint32_t vertex = 0; vertex < number_.size(); ++vertex) {
            if (number_[vertex] == kNone) vertices.push_back(vertex);
        }
    }

    std::vector<StripTriangle> stream;
    std::vector<bool> increments;
    std::vector<uint32_t> explicit_references, vertices;

  private:
    /// `next` follows along an edge, nullptr if there is no such triangle. Its step changes with the rotation.
    void restart(StripTriangle place, StripTriangle* next) {
        const std::vector<Restart> ways = ways_to(place, next);
        const Restart& way = *std::min_element(ways.begin(), ways.end(), [&](const Restart& one, const Restart& other) {
            return cost(one) < cost(other);
        });
        for (size_t i = 0; i < way.reference_count; ++i) refer(way.references[i]);
        for (size_t i = 0; i + 1 < way.step_count; ++i) stream.push_back({kPutIn, 0, way.steps[i]});
        place.rotation = static_cast<uint8_t>((place.rotation + way.turned) % 3);
        place.step = way.steps[way.step_count - 1];
        stream.push_back(place);
        if (next != nullptr && way.turned != 0) next->step = next->step == P ? N : P;
    }

    std::vector<Restart> ways_to(const StripTriangle& place, const StripTriangle* next) const {
        std::vector<Restart> ways;
        for (uint32_t turned = 0; turned < 3; ++turned) {
            // The exit is the second edge or the third: turning by one makes the second of the third, and so on.
            if (next != nullptr && turned == (next->step == P ? 2 : 1)) continue;
            const auto corners = strip_corners(
                triangles_, {place.triangle, static_cast<uint8_t>((place.rotation + turned) % 3), place.step});
            if (!degenerates_ || stream.empty()) {
                const auto& [d, e, f] = corners;
                ways.push_back({{d, e, f}, {degenerates_ ? P : R}, 3, 1, turned});
            } else {
                add_emulations(last_, corners, turned, ways);
            }
        }
        return ways;
    }

    /// In proportion to the bits of the steps, INC and Simple-9 codes; 2520 is divisible by the codes of all words.
    uint32_t cost(const Restart& way) const {
        constexpr uint32_t kWord = 2520, kBit = kWord / 32;
        uint32_t sum = (way.step_count + way.reference_count) * kBit;
        auto next_number = static_cast<uint32_t>(vertices.size());
        uint32_t before = last_explicit_;
        for (size_t i = 0; i < way.reference_count; ++i) {
            uint32_t number = number_[way.references[i]];
            const auto met = std::find(way.references.begin(), way.references.begin() + i, way.references[i]);
            if (number == kNone && met == way.references.begin() + i) {
                ++next_number;
                continue;
            }
            if (number == kNone) number = next_number - 1;  // nothing new comes between a vertex and its repetition
            const uint32_t code = bits::zigzag(static_cast<int32_t>(number - before));
            uint32_t selector = 0;
            while (selector + 1 < bits::kSimple9Selectors && code >> bits::kSimple9Widths[selector] != 0) ++selector;
            sum += kWord / bits::kSimple9Counts[selector];
            before = number;
        }
        return sum;
    }

    void refer(uint32_t vertex) {
        const bool is_new = number_[vertex] == kNone;
        increments.push_back(is_new);
        if (is_new) {
            number_[vertex] = static_cast<uint32_t>(vertices.size());
            vertices.push_back(vertex);
        } else {
            explicit_references.push_back(number_[vertex]);
            last_explicit_ = number_[vertex];
        }
    }

    Triangles triangles_;
    bool degenerates_;
    std::vector<uint32_t> number_;
    Corners last_{};
    uint32_t last_explicit_ = 0;
};

std::vector<uint32_t> differences(std::span<const uint32_t> references, uint32_t prediction) {
    std::vector<uint32_t> codes;
    codes.reserve(references.size());
    uint32_t before = 0;
    for (const uint32_t reference : references) {
        codes.push_back(bits::zigzag(static_cast<int32_t>(reference - before - prediction)));
        before = reference;
    }
    return codes;
}

/// The words of a written stream with one prediction.
std::vector<uint32_t> assemble(const StripWriter& writer, uint32_t mode, uint32_t prediction) {
    // At most 2^27 vertices: no difference has more than 28 bits.
    const auto codes = bits::pack_simple9(differences(writer.explicit_references, prediction)).value();
    std::vector<uint32_t> words = {STRIP_MAGIC,
                                   static_cast<uint32_t>(writer.stream.size()),
                                   static_cast<uint32_t>(writer.increments.size()),
                                   static_cast<uint32_t>(writer.explicit_references.size()),
                                   static_cast<uint32_t>(codes.size()),
                                   mode | prediction << STRIP_PREDICTION_BIT,
                                   static_cast<uint32_t>(writer.vertices.size()),
                                   0};
    const auto append = [&words](const std::vector<uint32_t>& part) {
        words.insert(words.end(), part.begin(), part.end());
    };
    append(codes);
    bits::BitWriter increments, steps;
    for (const bool bit : writer.increments) increments.put(bit ? 1 : 0, 1);
    append(increments.finish());
    for (const StripTriangle& place : writer.stream)
        steps.put(static_cast<uint32_t>(place.step), mode == STRIP_MODE_RESTARTS ? 2 : 1);
    append(steps.finish());
    return words;
}

}  // namespace

Result<StripCode> encode_strips(Triangles triangles, uint32_t vertex_count, const StripCodeOptions& options) {
    if (vertex_count > STRIP_MOST_VERTICES) return Error{"mesh has more than 2^27 vertices"};
    if (triangles.size() > STRIP_MOST_TRIANGLES) return Error{"mesh has more than 2^28 triangles"};
    const bool restarts_only = std::any_of(triangles.begin(), triangles.end(), has_equal_corners);
    StripCode best;
    for (const auto traversal : {StripTraversal::kPivots, StripTraversal::kNewestPivots, StripTraversal::kBelts}) {
        if (options.traversal.value_or(traversal) != traversal) continue;
        const StripOrder order = order_strips(triangles, vertex_count, traversal);
        for (const uint32_t mode : {STRIP_MODE_RESTARTS, STRIP_MODE_DEGENERATES}) {
            if (options.mode ? mode != *options.mode : mode == STRIP_MODE_DEGENERATES && restarts_only) continue;
            StripWriter writer(triangles, vertex_count, mode);
            writer.write(order.triangles);
            if (writer.stream.size() > STRIP_MOST_TRIANGLES) continue;
            for (const uint32_t prediction : {0u, 1u}) {
                if (options.prediction.value_or(prediction) != prediction) continue;
                auto words = assemble(writer, mode, prediction);
                if (!best.words.empty() && words.size() >= best.words.size()) continue;
                best = {std::move(words), writer.stream, writer.vertices};
            }
        }
    }
    if (best.words.empty()) return Error{"strip stream has more than 2^28 triangles"};
    return best;
}

}  // namespace citystream::codec::mesh
