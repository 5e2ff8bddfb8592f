// Decoded corners of the ranges of strip code that frames draw (codec/mesh/RESIDENT.md), in memory of a fixed size: a
// range is decoded when it is first drawn and stays until its memory is needed; what was drawn least recently goes
// first. All ranges that a frame misses are decoded in one batch before its render pass.
//
// A frame that draws more than the memory holds is drawn in *rounds* (Meyer 2012, section 5.7; the notes' T11): decode,
// draw, reuse the memory. Its first round draws all that is there already, so that no frame decodes what it need not;
// strip_rounds.h decodes everything anew, but one round while the one before is drawn.
//
// Errors: of plans: Result; Vulkan's: VulkanError. Not thread safe.
#pragma once

#include <list>
#include <map>
#include <utility>
#include <vector>

#include "client/cache/layer_store.h"
#include "client/render/strip_decoder.h"

namespace citystream::client {

/// A range of strip code that a frame draws.
struct StripRange {
    LayerId layer = kNoLayer;  ///< names it, with stream.first_word, from frame to frame
    StripStream stream;        ///< where its words lie in this frame
};

/// Where and when a range's corners are there.
struct ArenaPlace {
    uint32_t round = 0;
    uint32_t first_corner = 0;  ///< words of StripArena::corners
};

/// What the last frame took.
struct StripArenaCounts {
    uint32_t rounds = 0, decoded_ranges = 0;
    uint64_t decoded_triangles = 0;
};

class StripArena {
  public:
    /// Memory is taken when the first range is drawn: three quarters of the budget for corners, up to a quarter for
    /// what decoding needs besides. Records of a batch (64 bytes a range) come on top. The device outlives it.
    StripArena(const Device& device, uint64_t budget_bytes, const ScanTuning& tuning);
    ~StripArena();
    StripArena(const StripArena&) = delete;
    StripArena& operator=(const StripArena&) = delete;

    /// Finds room for all corners of a frame. Returns the place of each range, rounds ascending from 0 without a gap. A
    /// frame that was planned and not finished is forgotten, with all that is decoded. Fails where a range alone does
    /// not fit or has counts that cannot be. Nothing may be in flight. O(n log n) unless memory is in many pieces.
    Result<std::vector<ArenaPlace>> plan_frame(std::span<const StripRange> ranges);
    /// Of the frame that is planned.
    uint32_t round_count() const { return static_cast<uint32_t>(rounds_.size()); }
    /// Outside of render passes, round by round: decodes what the round misses. Behind it the round's ranges may be
    /// drawn, from corners(), and all that earlier rounds drew must have been recorded. Layers must be visible to
    /// compute shaders.
    void record_round(VkCommandBuffer commands, uint32_t round) const;
    /// The frame's commands have run.
    void finish_frame() { is_open_ = false; }

    /// Three 32-bit indices a triangle; not there before the first range.
    const Buffer& corners() const { return corners_; }
    /// Before a layer is destroyed.
    void forget(LayerId layer);
    const StripArenaCounts& counts() const { return counts_; }
    uint64_t bytes_allocated() const { return corners_.bytes + temporary_.bytes + records_.bytes; }

  private:
    using Key = std::pair<LayerId, uint32_t>;
    struct Entry {
        uint64_t begin = 0, words = 0;  ///< of corners_
        uint32_t round = 0;             ///< that needs it, in the frame that is planned
        std::list<Key>::iterator use;
    };
    struct Round {
        StripPlan plan;
        uint64_t records_offset = 0;  ///< bytes of records_
    };
    static constexpr uint32_t kNoRound = ~uint32_t{0};

    void clear();
    void use(Entry& entry, uint32_t round);
    void drop(std::map<Key, Entry>::iterator entry);
    bool has_room(uint64_t words, uint64_t& begin) const;
    bool make_room(uint64_t words, uint32_t round, uint64_t& begin);
    Result<bool> add(const StripRange& range, uint32_t round, ArenaPlace& place);
    Status add_missing(std::span<const StripRange> ranges, std::span<const size_t> missing,
                       std::vector<ArenaPlace>& places);
    void write_records();

    const Device& device_;
    uint64_t corner_words_, temporary_words_;  ///< most
    StripDecoder decoder_;
    std::map<Key, Entry> entries_;
    std::list<Key> uses_;                ///< least recent first
    std::map<uint64_t, uint64_t> free_;  ///< words from where on
    std::vector<Round> rounds_;
    bool is_open_ = false;
    StripArenaCounts counts_;
    Buffer corners_, temporary_, records_;
};

}  // namespace citystream::client
