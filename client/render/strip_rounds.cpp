#include "client/render/strip_rounds.h"

#include <algorithm>

namespace citystream::client {
namespace {

uint64_t rounded_up(uint64_t bytes) {
    return (bytes + 7) / 8 * 8;
}

// Corners first, then the temporary memory.
uint64_t round_bytes(const StripDecoder& decoder, const StripSizes& sizes) {
    return rounded_up(4 * sizes.corner_words) + rounded_up(4 * strip_temporary_words(decoder, sizes));
}

// As many streams from `first` on as fit.
Result<StripRound> next_round(const StripDecoder& decoder, std::span<const StripStream> streams, size_t first,
                              uint64_t bytes) {
    StripRound round;
    round.first = first;
    for (; first + round.count < streams.size(); ++round.count) {
        StripPlan& plan = round.plan;
        const StripSizes before = plan.sizes;
        const size_t records = plan.records.size();
        const Status status = append_stream(plan, streams[first + round.count]);
        if (status.ok() && round_bytes(decoder, plan.sizes) <= bytes) continue;
        if (round.count == 0)
            return status.ok() ? Error{"a mesh alone does not fit the memory of a round"} : status.error();
        plan.sizes = before;
        plan.records.resize(records);
        plan.corners_at.resize(round.count);
        break;
    }
    return round;
}

}  // namespace

Result<StripRounds> plan_strip_rounds(const StripDecoder& decoder, std::span<const StripStream> streams,
                                      uint64_t memory_bytes) {
    StripRounds all;
    all.half_bytes = memory_bytes / 2 / 8 * 8;
    for (size_t first = 0; first < streams.size();) {
        Result<StripRound> round = next_round(decoder, streams, first, all.half_bytes);
        if (!round) return round.error();
        round->records_offset = all.records_bytes;
        all.records_bytes += round->plan.records.size() * sizeof(StripRecord);
        first += round->count;
        all.rounds.push_back(std::move(*round));
    }
    return all;
}

void write_records(const StripRounds& rounds, void* to) {
    for (const StripRound& round : rounds.rounds) {
        const std::vector<StripRecord>& records = round.plan.records;
        std::copy(records.begin(), records.end(),
                  reinterpret_cast<StripRecord*>(static_cast<std::byte*>(to) + round.records_offset));
    }
}

void record_strip_rounds(VkCommandBuffer commands, const StripDecoder& decoder, const StripRounds& rounds,
                         const Buffer& memory, const Buffer& records, const DrawStripRound& draw) {
    const auto places_of = [&](size_t r) {
        const StripRound& round = rounds.rounds[r];
        const uint64_t corners = r % 2 * rounds.half_bytes;
        const uint64_t temporary = corners + rounded_up(4 * round.plan.sizes.corner_words);
        return StripPlaces{{&records, round.records_offset}, {&memory, temporary}, {&memory, corners}};
    };
    const auto decode = [&](size_t r) {
        if (r < rounds.rounds.size()) record_strip_decode(commands, decoder, rounds.rounds[r].plan, places_of(r));
    };
    decode(0);
    for (size_t r = 0; r < rounds.rounds.size(); ++r) {
        strip_barrier(commands);
        // Nothing lies between these two: they use different halves.
        decode(r + 1);
        draw(commands, rounds.rounds[r], places_of(r).corners);
    }
}

}  // namespace citystream::client
