#include <algorithm>
#include <limits>

#include "codec/bits/bit_stream.h"
#include "codec/mesh/local_strips.h"
#include "codec/mesh/local_strips_layout.h"

namespace citystream::codec::mesh {

namespace {

constexpr uint32_t kNone = ~uint32_t{0};

/// A reference to a vertex met before; `newest` is the number of the next new vertex.
struct Reference {
    uint32_t vertex, newest;
};

/// How the fields of a group say their vertices.
struct Frame {
    uint32_t low = 0, width = 0;
    int32_t slope = 0;
    bool two = false;
    /// The field of a reference, number k of its group.
    uint32_t field(const Reference& reference, uint32_t k) const {
        const uint32_t offset = (reference.vertex - low - static_cast<uint32_t>(slope) * k) & LOCAL_STRIPS_VERTEX_MASK;
        const uint32_t back = reference.newest - 1 - reference.vertex;
        if (!two) return offset;
        const uint32_t top = 1u << (width - 1);
        return back < top ? back | top : offset;
    }
};

/// The frame from the lowest to the highest of the references that are `least_back` or more behind the newest vertex.
Frame frame_of(const std::vector<Reference>& references, int32_t slope, uint32_t least_back) {
    int64_t low = std::numeric_limits<int64_t>::max(), high = std::numeric_limits<int64_t>::min();
    for (uint32_t k = 0; k < references.size(); ++k) {
        if (references[k].newest - 1 - references[k].vertex < least_back) continue;
        const int64_t offset = int64_t{references[k].vertex} - int64_t{slope} * k;
        low = std::min(low, offset);
        high = std::max(high, offset);
    }
    if (low > high) return {0, 0, slope};
    return {static_cast<uint32_t>(low) & LOCAL_STRIPS_VERTEX_MASK, bits::bits_for(static_cast<uint64_t>(high - low)),
            slope};
}

/// The frame, or the two, with the narrowest fields.
Frame best_frame(const std::vector<Reference>& references) {
    Frame best;
    best.width = kNone;
    for (const int32_t slope : {0, 1, -1}) {
        const Frame one = frame_of(references, slope, 0);
        if (one.width < best.width) best = one;
        for (uint32_t width = 0; width + 1 < best.width; ++width) {
            Frame two = frame_of(references, slope, 1u << width);
            if (two.width > width) continue;
            two.width = width + 1;
            two.two = true;
            best = two;
        }
    }
    return best;
}

class Writer {
  public:
    Writer(std::span<const std::array<uint32_t, 3>> triangles, uint32_t vertex_count)
        : triangles_(triangles), number_(vertex_count, kNone) {}

    LocalStrips write(StripOrder order) {
        stream_ = std::move(order.triangles);
        for (size_t begin = 0; begin < stream_.size(); begin += LOCAL_STRIPS_GROUP_TRIANGLES)
            write_group(begin, std::min<size_t>(begin + LOCAL_STRIPS_GROUP_TRIANGLES, stream_.size()));
        LocalStrips result;
        result.words = assemble();
        for (uint32_t vertex = 0; vertex < number_.size(); ++vertex) {
            if (number_[vertex] == kNone) vertices_.push_back(vertex);
        }
        result.stream = std::move(stream_);
        result.vertices = std::move(vertices_);
        return result;
    }

  private:
    void write_group(size_t begin, size_t end) {
        if (begin / LOCAL_STRIPS_GROUP_TRIANGLES % LOCAL_STRIPS_BLOCK_GROUPS == 0) {
            block_base_ = static_cast<uint32_t>(vertices_.size());
            block_payload_ = static_cast<uint32_t>(payload_.size());
            blocks_.push_back({block_base_, block_payload_});
        }
        const auto base = static_cast<uint32_t>(vertices_.size());
        const auto payload = static_cast<uint32_t>(payload_.size());
        stream_[begin].step = StripStep::kRestart;
        bits::BitWriter steps, restarts, is_new, fields;
        std::vector<Reference> references;
        bool has_restarts = false;
        for (size_t i = begin; i < begin + LOCAL_STRIPS_GROUP_TRIANGLES; ++i) {
            const StripStep step = i < end ? stream_[i].step : StripStep::kPrevious;
            const bool restarts_here = step == StripStep::kRestart && i > begin;
            has_restarts |= restarts_here;
            steps.put(step == StripStep::kNext ? 1 : 0, 1);
            restarts.put(restarts_here ? 1 : 0, 1);
            if (i >= end) continue;
            const auto corners = strip_corners(triangles_, stream_[i]);
            for (size_t c = step == StripStep::kRestart ? 0 : 2; c < 3; ++c) refer(corners[c], is_new, references);
        }
        const Frame frame = best_frame(references);
        for (uint32_t k = 0; k < references.size(); ++k) fields.put(frame.field(references[k], k), frame.width);
        append(steps.finish());
        if (has_restarts) append(restarts.finish());
        append(is_new.finish());
        append(fields.finish());
        const uint32_t slope = frame.slope < 0 ? LOCAL_STRIPS_SLOPE_DOWN : static_cast<uint32_t>(frame.slope);
        heads_.push_back((base - block_base_) | (payload - block_payload_) << LOCAL_STRIPS_PAYLOAD_BIT |
                         frame.width << LOCAL_STRIPS_WIDTH_BIT | slope << LOCAL_STRIPS_SLOPE_BIT |
                         uint32_t{has_restarts} << LOCAL_STRIPS_RESTARTS_BIT);
        heads_.push_back(frame.low | uint32_t{frame.two} << LOCAL_STRIPS_FRAMES_BIT);
    }

    void refer(uint32_t vertex, bits::BitWriter& is_new, std::vector<Reference>& references) {
        const auto newest = static_cast<uint32_t>(vertices_.size());
        is_new.put(number_[vertex] == kNone ? 1 : 0, 1);
        if (number_[vertex] == kNone) {
            number_[vertex] = newest;
            vertices_.push_back(vertex);
        } else {
            references.push_back({number_[vertex], newest});
        }
    }

    void append(const std::vector<uint32_t>& part) { payload_.insert(payload_.end(), part.begin(), part.end()); }

    std::vector<uint32_t> assemble() const {
        const size_t payload_at = LOCAL_STRIPS_HEADER_WORDS + blocks_.size() * LOCAL_STRIPS_BLOCK_WORDS + heads_.size();
        std::vector<uint32_t> words = {LOCAL_STRIPS_MAGIC, static_cast<uint32_t>(stream_.size()),
                                       static_cast<uint32_t>(number_.size()),
                                       static_cast<uint32_t>(payload_at + payload_.size())};
        for (const auto& [base, payload] : blocks_) {
            words.push_back(base);
            words.push_back(static_cast<uint32_t>(payload_at + payload));
        }
        words.insert(words.end(), heads_.begin(), heads_.end());
        words.insert(words.end(), payload_.begin(), payload_.end());
        return words;
    }

    std::span<const std::array<uint32_t, 3>> triangles_;
    std::vector<uint32_t> number_, vertices_;
    std::vector<StripTriangle> stream_;
    std::vector<std::array<uint32_t, 2>> blocks_;
    std::vector<uint32_t> heads_, payload_;
    uint32_t block_base_ = 0, block_payload_ = 0;
};

}  // namespace

Result<LocalStrips> encode_local_strips(std::span<const std::array<uint32_t, 3>> triangles, uint32_t vertex_count) {
    if (vertex_count > LOCAL_STRIPS_MOST_VERTICES) return Error{"mesh has more than 2^27 vertices"};
    if (triangles.size() > LOCAL_STRIPS_MOST_TRIANGLES) return Error{"mesh has more than 2^27 triangles"};
    LocalStrips best;
    for (const auto traversal : {StripTraversal::kPivots, StripTraversal::kNewestPivots, StripTraversal::kBelts}) {
        LocalStrips strips = Writer(triangles, vertex_count).write(order_strips(triangles, vertex_count, traversal));
        if (best.words.empty() || strips.words.size() < best.words.size()) best = std::move(strips);
    }
    return best;
}

}  // namespace citystream::codec::mesh
