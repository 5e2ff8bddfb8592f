#include "client/render/strip_arena.h"

#include <algorithm>
#include <cstring>
#include <limits>

namespace citystream::client {
namespace {

// Words that 32 bits number.
constexpr uint64_t kMostCornerWords = std::numeric_limits<uint32_t>::max();

}  // namespace

StripArena::StripArena(const Device& device, uint64_t budget_bytes, const ScanTuning& tuning)
    : device_(device),
      corner_words_(std::min(budget_bytes / 16 * 3, kMostCornerWords)),
      temporary_words_(budget_bytes / 16),
      decoder_(create_strip_decoder(device, tuning)) {
    clear();
}

StripArena::~StripArena() {
    destroy_strip_decoder(device_, decoder_);
    for (Buffer* buffer : {&corners_, &temporary_, &records_}) destroy_buffer(device_, *buffer);
}

void StripArena::clear() {
    entries_.clear();
    uses_.clear();
    free_ = {{0, corner_words_}};
}

void StripArena::use(Entry& entry, uint32_t round) {
    entry.round = round;
    uses_.splice(uses_.end(), uses_, entry.use);
}

// Joins its memory with what is free before and behind it.
void StripArena::drop(std::map<Key, Entry>::iterator entry) {
    const uint64_t begin = entry->second.begin, words = entry->second.words;
    if (words > 0) {
        auto at = free_.emplace(begin, words).first;
        if (const auto next = std::next(at); next != free_.end() && next->first == begin + words) {
            at->second += next->second;
            free_.erase(next);
        }
        if (at != free_.begin() && std::prev(at)->first + std::prev(at)->second == begin) {
            std::prev(at)->second += at->second;
            free_.erase(at);
        }
    }
    uses_.erase(entry->second.use);
    entries_.erase(entry);
}

void StripArena::forget(LayerId layer) {
    for (auto at = entries_.lower_bound({layer, 0}); at != entries_.end() && at->first.first == layer;) drop(at++);
}

bool StripArena::has_room(uint64_t words, uint64_t& begin) const {
    const auto found = std::find_if(free_.begin(), free_.end(), [&](const auto& gap) { return gap.second >= words; });
    if (found == free_.end()) return false;
    begin = found->first;
    return true;
}

// Drops what the round does not need, least recently drawn first, until there are so many words in one piece.
bool StripArena::make_room(uint64_t words, uint32_t round, uint64_t& begin) {
    for (auto oldest = uses_.begin(); !has_room(words, begin);) {
        while (oldest != uses_.end() && entries_.at(*oldest).round == round) ++oldest;
        if (oldest == uses_.end()) return false;
        drop(entries_.find(*oldest++));
    }
    return true;
}

// False: the round has no room left for it.
Result<bool> StripArena::add(const StripRange& range, uint32_t round, ArenaPlace& place) {
    const Key key(range.layer, range.stream.first_word);
    if (const auto found = entries_.find(key); found != entries_.end()) {
        use(found->second, round);
        place = {round, static_cast<uint32_t>(found->second.begin)};
        return true;
    }
    const uint64_t words = uint64_t{3} * range.stream.header.triangles;
    StripPlan& plan = rounds_[round].plan;
    const StripSizes before = plan.sizes;
    const size_t records = plan.records.size();
    if (const Status appended = append_stream(plan, range.stream); !appended) {
        return records == 0 ? Result<bool>(appended.error()) : Result<bool>(false);
    }
    Entry entry{0, words, round, {}};
    if (strip_temporary_words(decoder_, plan.sizes) > temporary_words_ ||
        (words > 0 && !make_room(words, round, entry.begin))) {
        plan.sizes = before;
        plan.records.resize(records);
        plan.corners_at.pop_back();
        return false;
    }
    if (words > 0) {
        plan.records.back().corners_at = static_cast<uint32_t>(entry.begin);
        const auto gap = free_.find(entry.begin);
        if (gap->second > words) free_.emplace(gap->first + words, gap->second - words);
        free_.erase(gap);
    }
    entry.use = uses_.insert(uses_.end(), key);
    entries_.emplace(key, entry);
    place = {round, static_cast<uint32_t>(entry.begin)};
    ++counts_.decoded_ranges;
    counts_.decoded_triangles += range.stream.header.triangles;
    return true;
}

Status StripArena::add_missing(std::span<const StripRange> ranges, std::span<const size_t> missing,
                               std::vector<ArenaPlace>& places) {
    for (const size_t i : missing) {
        Result<bool> added = add(ranges[i], round_count() - 1, places[i]);
        if (!added) return added.error();
        if (*added) continue;
        rounds_.emplace_back();
        added = add(ranges[i], round_count() - 1, places[i]);
        if (!added) return added.error();
        if (!*added) return Error{"strips of one range do not fit the memory of decoded ones"};
    }
    return Done{};
}

Result<std::vector<ArenaPlace>> StripArena::plan_frame(std::span<const StripRange> ranges) {
    if (is_open_) clear();
    is_open_ = true;
    counts_ = {};
    rounds_.clear();
    std::vector<ArenaPlace> places(ranges.size());
    if (ranges.empty()) return places;
    rounds_.emplace_back();
    for (auto& [key, entry] : entries_) entry.round = kNoRound;
    std::vector<size_t> missing;
    for (size_t i = 0; i < ranges.size(); ++i) {
        const auto found = entries_.find({ranges[i].layer, ranges[i].stream.first_word});
        if (found == entries_.end()) {
            missing.push_back(i);
            continue;
        }
        use(found->second, 0);
        places[i] = {0, static_cast<uint32_t>(found->second.begin)};
    }
    if (const Status added = add_missing(ranges, missing, places); !added) return added.error();
    counts_.rounds = round_count();
    write_records();
    return places;
}

// Memory for the frame's batches, and their records.
void StripArena::write_records() {
    uint64_t bytes = 0, temporary = 0;
    for (Round& round : rounds_) {
        round.records_offset = bytes;
        bytes += round.plan.records.size() * sizeof(StripRecord);
        if (!round.plan.records.empty())
            temporary = std::max(temporary, strip_temporary_words(decoder_, round.plan.sizes));
    }
    if (bytes == 0) return;
    const auto ensure = [&](Buffer& buffer, uint64_t least, uint64_t wanted, BufferPlace place) {
        if (buffer.bytes >= least) return;
        destroy_buffer(device_, buffer);
        buffer = create_buffer(device_, wanted, place);
    };
    ensure(corners_, 4 * corner_words_, 4 * corner_words_, BufferPlace::kDevice);
    ensure(temporary_, 4 * temporary, 4 * std::min(temporary_words_, temporary + temporary / 2), BufferPlace::kDevice);
    ensure(records_, bytes, bytes + bytes / 2, BufferPlace::kUpload);
    for (const Round& round : rounds_) {
        const std::vector<StripRecord>& records = round.plan.records;
        if (records.empty()) continue;
        std::memcpy(static_cast<std::byte*>(records_.mapped) + round.records_offset, records.data(),
                    records.size() * sizeof(StripRecord));
    }
}

void StripArena::record_round(VkCommandBuffer commands, uint32_t round) const {
    const Round& it = rounds_[round];
    if (it.plan.records.empty()) return;
    strip_barrier(commands);
    record_strip_decode(commands, decoder_, it.plan,
                        {{&records_, it.records_offset}, {&temporary_, 0}, {&corners_, 0}});
    strip_barrier(commands);
}

}  // namespace citystream::client
