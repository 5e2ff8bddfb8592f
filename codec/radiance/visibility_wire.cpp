#include "codec/radiance/visibility_wire.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <optional>
#include <utility>

#include "codec/radiance/series_angle.h"
#include "codec/radiance/visibility_code.h"

namespace citystream::codec::radiance {

namespace {

/// Receivers that one may be told by.
constexpr uint32_t kWindow = 256;
/// The first byte of the first message: n - 1, and above it the version of what follows.
constexpr uint32_t kSideBits = 6, kVersion = 2;
/// Levels that are known after each step.
constexpr std::array<uint32_t, kVisibilitySteps> kLevelsOfStep = {2, 3, 4};

/// What a frame hides of a receiver.
struct FrameCells {
    std::vector<uint32_t> above;
    CellStates present;
};

/// Cells of the frames that were asked for last.
class FrameCellsCache {
  public:
    FrameCellsCache(const VisibilityTile& tile, const CellLayout& layout) : tile_(tile), layout_(layout) {}

    const FrameCells& of(uint32_t frame) {
        Slot& slot = slots_[frame % kSlots];
        if (slot.frame == frame) return *slot.cells;
        std::vector<uint32_t> above = samples_above(unpack_frame(tile_.frames[frame]), tile_.side);
        CellStates present(layout_);
        present.set_from_bits(layout_, above, above);
        slot.frame = frame;
        slot.cells.emplace(FrameCells{std::move(above), std::move(present)});
        return *slot.cells;
    }

  private:
    static constexpr uint32_t kSlots = 16, kNone = ~0u;
    struct Slot {
        uint32_t frame = kNone;
        std::optional<FrameCells> cells;
    };
    const VisibilityTile& tile_;
    const CellLayout& layout_;
    std::array<Slot, kSlots> slots_;
};

/// How far back the two receivers are by which one is told; 0: nothing is known.
struct References {
    uint32_t first = 0, second = 0;
};

/// Of two receivers' bits, in every other row of samples where a row is two words: neighbours are alike.
uint32_t difference(std::span<const uint32_t> a, std::span<const uint32_t> b) {
    constexpr size_t kStride = 4;
    uint32_t bits = 0;
    for (size_t w = 0; w + 1 < a.size(); w += kStride)
        bits += static_cast<uint32_t>(std::popcount(uint64_t{a[w] ^ b[w]} << 32 | (a[w + 1] ^ b[w + 1])));
    return bits;
}

/// The two of the window that differ least.
References nearest_receivers(const VisibilityTile& tile, uint32_t receiver) {
    References found;
    uint32_t least = ~0u, next = ~0u;
    for (uint32_t back = 1; back < kWindow && back <= receiver; ++back) {
        const uint32_t bits = difference(tile.of(receiver), tile.of(receiver - back));
        if (bits < least) {
            next = least;
            found.second = found.first;
            least = bits;
            found.first = back;
        } else if (bits < next) {
            next = bits;
            found.second = back;
        }
    }
    return found;
}

/// Codes the receivers, each of whose levels goes to the coder of its step.
template <typename Coder>
class ReceiverCode {
  public:
    ReceiverCode(VisibilityTile& tile, std::span<Coder> coders)
        : tile_(tile),
          coders_(coders),
          layout_(tile.side),
          frames_(tile, layout_),
          unknown_(layout_),
          levels_{{{layout_, 0}, {layout_, 1}, {layout_, 2}, {layout_, 3}}} {}

    void code(uint32_t receiver, References references) {
        const FrameCells& cells = frames_.of(tile_.frame_of[receiver]);
        references.first = back_[0].code(coders_[0], references.first);
        references.second = back_[1].code(coders_[0], references.second);
        CellStates& states = start(receiver, cells);
        const CellStates& first = state_of(receiver, references.first);
        const CellStates& second = state_of(receiver, references.second);
        for (uint32_t step = 0, level = 0; step < coders_.size(); ++step) {
            for (; level < kLevelsOfStep[step]; ++level)
                levels_[level].code(coders_[step], {cells.present, first, second}, states);
        }
    }

    /// The bits of the receiver that was coded last, by the first `steps` steps.
    std::vector<uint32_t> bits(uint32_t receiver, uint32_t steps) {
        std::vector<uint32_t> words(tile_.words_a_receiver(), 0);
        window_[receiver % kWindow].write_bits(layout_, kLevelsOfStep[steps - 1],
                                               frames_.of(tile_.frame_of[receiver]).above, words);
        return words;
    }
    const std::vector<uint32_t>& above(uint32_t receiver) { return frames_.of(tile_.frame_of[receiver]).above; }

  private:
    CellStates& start(uint32_t receiver, const FrameCells& cells) {
        if (window_.size() <= receiver % kWindow) window_.emplace_back(layout_);
        CellStates& states = window_[receiver % kWindow];
        if constexpr (!Coder::kDecodes) states.set_from_bits(layout_, tile_.of(receiver), cells.above);
        return states;
    }
    const CellStates& state_of(uint32_t receiver, uint32_t back) const {
        return back == 0 || back > receiver ? unknown_ : window_[(receiver - back) % kWindow];
    }

    VisibilityTile& tile_;
    std::span<Coder> coders_;
    CellLayout layout_;
    FrameCellsCache frames_;
    CellStates unknown_;
    std::vector<CellStates> window_;
    std::array<VisibilityLevelCode, kCellLevels> levels_;
    bits::BitTree back_[2] = {bits::BitTree(kWindow), bits::BitTree(kWindow)};
};

/// In hemispheres.
float wrong_angle(std::span<const uint32_t> bits, std::span<const uint32_t> exact,
                  const std::vector<double>& solid_angle) {
    double sum = 0;
    for (size_t w = 0; w < bits.size(); ++w) {
        for (uint32_t wrong = bits[w] ^ exact[w]; wrong != 0; wrong &= wrong - 1)
            sum += solid_angle[32 * w + static_cast<size_t>(std::countr_zero(wrong))];
    }
    return static_cast<float>(sum / (2 * kPi));
}

}  // namespace

std::vector<VisibilityStep> encode_visibility(const VisibilityTile& given) {
    VisibilityTile tile = given;
    clear_below_planes(tile);
    std::array<bits::RangeEncoder, kVisibilitySteps> coders;
    std::vector<double> solid_angle(sample_count(tile.side));
    for (uint32_t s = 0; s < solid_angle.size(); ++s) solid_angle[s] = cell_solid_angle(kSamplesAcross * tile.side, s);
    std::vector<VisibilityStep> steps(kVisibilitySteps);
    ReceiverCode<bits::RangeEncoder> code(tile, coders);
    for (uint32_t r = 0; r < tile.receivers(); ++r) {
        code.code(r, nearest_receivers(tile, r));
        for (uint32_t step = 0; step + 1 < kVisibilitySteps; ++step) {
            const std::vector<uint32_t> bits = code.bits(r, step + 1);
            steps[step].error = std::max(steps[step].error, wrong_angle(bits, tile.of(r), solid_angle));
        }
    }
    for (uint32_t step = 0; step < kVisibilitySteps; ++step) steps[step].bytes = coders[step].finish();
    steps[0].bytes.insert(steps[0].bytes.begin(), static_cast<std::byte>(kVersion << kSideBits | (tile.side - 1)));
    return steps;
}

Result<uint32_t> visibility_side(std::span<const std::byte> first_step) {
    if (first_step.empty()) return Error{"visibility without its first byte", 0};
    const auto first = std::to_integer<uint32_t>(first_step[0]);
    if (first >> kSideBits != kVersion) return Error{"visibility of another version of the format: build it anew", 0};
    return first % (1u << kSideBits) + 1;
}

Status visit_visibility(const VisibilityTile& known, std::span<const std::span<const std::byte>> steps,
                        const ReceiverVisit& visit) {
    if (steps.empty() || steps.size() > kVisibilitySteps) return Error{"visibility has 1 to 3 steps"};
    const auto side = visibility_side(steps[0]);
    if (!side) return side.error();
    VisibilityTile tile{*side, known.frames, known.frame_of, {}};
    std::vector<bits::RangeDecoder> coders(steps.begin(), steps.end());
    coders[0] = bits::RangeDecoder(steps[0].subspan(1));
    ReceiverCode<bits::RangeDecoder> code(tile, coders);
    for (uint32_t r = 0; r < tile.receivers(); ++r) {
        code.code(r, {});
        for (const auto& coder : coders) {
            if (!coder.ok()) return coder.finish();
        }
        if (!visit(r, code.bits(r, static_cast<uint32_t>(steps.size())))) return Done{};
    }
    for (const auto& coder : coders) {
        if (Status status = coder.finish(); !status) return status;
    }
    return Done{};
}

Result<VisibilityTile> decode_visibility(VisibilityTile known, std::span<const std::span<const std::byte>> steps,
                                         const RadianceLimits& limits) {
    const auto side = visibility_side(steps.empty() ? std::span<const std::byte>() : steps[0]);
    if (!side) return side.error();
    known.side = *side;
    known.words.clear();
    if (known.receivers() > std::min(limits.receivers, kMostReceivers) ||
        uint64_t{known.receivers()} * known.words_a_receiver() > limits.entries)
        return Error{"visibility of more receivers than there may be", 0};
    const Status status = visit_visibility(known, steps, [&](uint32_t, std::span<const uint32_t> bits) {
        known.words.insert(known.words.end(), bits.begin(), bits.end());
        return true;
    });
    if (!status) return status.error();
    return known;
}

}  // namespace citystream::codec::radiance
