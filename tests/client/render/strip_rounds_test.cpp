// A landscape of many meshes drawn with memory for few of them.
#include "client/render/strip_rounds.h"

#include "tests/client/render/strip_landscape.h"

namespace citystream::client::test {
namespace {

class StripRoundsDrawing : public StripLandscape {
  protected:
    std::vector<StripDraw> draws_of(const StripRound& round) const {
        std::vector<StripDraw> draws;
        for (size_t i = 0; i < round.count; ++i) draws.push_back(draw_of(round.first + i, round.plan.corners_at[i]));
        return draws;
    }

    std::vector<uint32_t> picture_in_rounds(const StripDecoder& decoder, const StripRounds& rounds, int frames) {
        const Buffer memory = host_buffer(2 * rounds.half_bytes), records = host_buffer(rounds.records_bytes);
        write_records(rounds, records.mapped);
        const StripViewConstants constants = view_of(vertices_);
        for (int frame = 0; frame < frames; ++frame) {
            submit_and_wait(device_, [&](VkCommandBuffer commands) {
                record_strip_rounds(commands, decoder, rounds, memory, records,
                                    [&](VkCommandBuffer, const StripRound& round, const BufferRange& corners) {
                                        record_strip_view(commands, view_, constants, corners, draws_of(round),
                                                          round.first == 0);
                                    });
                finish_strip_view(commands, view_);
            });
        }
        return pixels();
    }
};

TEST_F(StripRoundsDrawing, AModelLargerThanItsMemoryIsDrawnAsAWhole) {
    const std::vector<uint32_t> whole = picture_of_the_whole();
    const auto drawn = std::count_if(whole.begin(), whole.end(), [](uint32_t pixel) { return pixel != 0xff000000; });
    EXPECT_GT(drawn, kSize * kSize / 2);
    for (const ScanPath path : {ScanPath::kPasses, ScanPath::kLookBack}) {
        StripDecoder decoder = create_strip_decoder(device_, {path, subgroups_fit_scans(device_)});
        const uint64_t memory = 4 * batch_.plan.sizes.corner_words / 8;
        const Result<StripRounds> rounds = plan_strip_rounds(decoder, batch_.streams, memory);
        ASSERT_TRUE(rounds.ok()) << rounds.error().text();
        EXPECT_GE(rounds->rounds.size(), 16u);
        EXPECT_LE(2 * rounds->half_bytes, memory);
        EXPECT_EQ(picture_in_rounds(decoder, *rounds, 3), whole);
        destroy_strip_decoder(device_, decoder);
    }
}

TEST_F(StripRoundsDrawing, RoundsHoldEveryStreamOnceAndFitTheirMemory) {
    StripDecoder decoder = create_strip_decoder(device_, choose_scan_tuning(device_));
    for (const uint64_t memory : {uint64_t{40'000}, uint64_t{333'333}, uint64_t{1} << 30}) {
        const Result<StripRounds> rounds = plan_strip_rounds(decoder, batch_.streams, memory);
        ASSERT_TRUE(rounds.ok());
        size_t next = 0;
        for (const StripRound& round : rounds->rounds) {
            EXPECT_EQ(round.first, next);
            EXPECT_EQ(round.plan.corners_at.size(), round.count);
            EXPECT_LE(4 * (round.plan.sizes.corner_words + strip_temporary_words(decoder, round.plan.sizes)),
                      rounds->half_bytes);
            next += round.count;
        }
        EXPECT_EQ(next, batch_.streams.size());
        EXPECT_EQ(rounds->rounds.size() == 1, memory > 4 * batch_.plan.sizes.corner_words * 2);
    }
    EXPECT_FALSE(plan_strip_rounds(decoder, batch_.streams, 10'000).ok()) << "no mesh fits";
    EXPECT_TRUE(plan_strip_rounds(decoder, {}, 10'000)->rounds.empty());
    destroy_strip_decoder(device_, decoder);
}

}  // namespace
}  // namespace citystream::client::test
