// Strip code that is decoded when it is drawn: frames look as those of index lists that the CPU decoded, whatever the
// memory holds.
#include "client/render/strip_arena.h"

#include <optional>

#include "tests/client/render/strip_landscape.h"

namespace citystream::client::test {
namespace {

/// The most memory that a batch and its records take besides the budget.
constexpr uint64_t kRecordsBytes = 2 * kPieces * kPieces * sizeof(StripRecord);

class StripArenaDrawing : public StripLandscape {
  protected:
    void SetUp() override {
        StripLandscape::SetUp();
        piece_bytes_ = 4 * batch_.plan.sizes.corner_words / scene_.streams.size();
        for (size_t i = 0; i < scene_.streams.size(); ++i) all_.push_back(i);
    }

    void TearDown() override {
        arena_.reset();
        StripLandscape::TearDown();
    }

    /// With room for the corners of so many pieces.
    void make_arena(uint64_t pieces, const ScanTuning& tuning) {
        budget_ = (pieces * piece_bytes_ + 48) / 3 * 4;
        arena_.emplace(device_, budget_, tuning);
    }
    void make_arena(uint64_t pieces) { make_arena(pieces, choose_scan_tuning(device_)); }

    std::vector<StripRange> ranges_of(std::span<const size_t> pieces) const {
        std::vector<StripRange> ranges;
        for (const size_t i : pieces) ranges.push_back({static_cast<LayerId>(i), batch_.streams[i]});
        return ranges;
    }

    std::vector<uint32_t> draw(std::span<const size_t> pieces) {
        const auto places = arena_->plan_frame(ranges_of(pieces));
        if (!places) {
            ADD_FAILURE() << places.error().text();
            return {};
        }
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            for (uint32_t round = 0; round < arena_->round_count(); ++round) {
                std::vector<StripDraw> draws;
                for (size_t i = 0; i < pieces.size(); ++i) {
                    const ArenaPlace& place = (*places)[i];
                    if (place.round == round) draws.push_back(draw_of(pieces[i], place.first_corner));
                }
                EXPECT_FALSE(draws.empty()) << "a round for nothing";
                arena_->record_round(commands, round);
                record_strip_view(commands, view_, view_of(vertices_), {&arena_->corners(), 0}, draws, round == 0);
            }
            finish_strip_view(commands, view_);
        });
        arena_->finish_frame();
        EXPECT_LE(arena_->bytes_allocated(), budget_ + kRecordsBytes);
        return pixels();
    }

    uint64_t piece_bytes_ = 0, budget_ = 0;
    std::vector<size_t> all_;
    std::optional<StripArena> arena_;
};

TEST_F(StripArenaDrawing, WhatFitsIsDecodedOnceInOneBatchAndDrawnAsIndicesAre) {
    const std::vector<uint32_t> whole = picture_of_the_whole();
    for (const ScanTuning& tuning : tunings()) {
        make_arena(all_.size(), tuning);
        EXPECT_EQ(arena_->bytes_allocated(), 0u) << "memory that nothing has asked for";
        for (int frame = 0; frame < 3; ++frame) {
            EXPECT_EQ(draw(all_), whole);
            EXPECT_EQ(arena_->counts().rounds, 1u);
            EXPECT_EQ(arena_->counts().decoded_ranges, frame == 0 ? all_.size() : 0u);
        }
    }
}

TEST_F(StripArenaDrawing, AFrameOfMoreThanTheMemoryHoldsIsDrawnInRounds) {
    const std::vector<uint32_t> whole = picture_of_the_whole();
    for (const uint64_t pieces : {uint64_t{1}, uint64_t{7}, uint64_t{60}}) {
        make_arena(pieces);
        for (int frame = 0; frame < 3; ++frame) {
            EXPECT_EQ(draw(all_), whole) << pieces;
            EXPECT_GE(arena_->counts().rounds, all_.size() / (pieces + 1));
            const uint64_t kept = frame == 0 ? 0 : pieces;
            EXPECT_EQ(arena_->counts().decoded_ranges, all_.size() - kept) << "what is there is drawn first";
        }
    }
}

TEST_F(StripArenaDrawing, WhatWasDrawnLeastRecentlyGoesFirst) {
    make_arena(50);
    const auto pieces = [&](size_t from, size_t to) { return std::vector(all_.begin() + from, all_.begin() + to); };
    draw(pieces(0, 25));
    draw(pieces(25, 50));
    EXPECT_EQ(arena_->counts().decoded_ranges, 25u);
    draw(pieces(0, 10));
    EXPECT_EQ(arena_->counts().decoded_ranges, 0u);
    draw(pieces(50, 65));  // takes the memory of 10..24
    EXPECT_EQ(arena_->counts().decoded_ranges, 15u);
    draw(pieces(0, 10));
    EXPECT_EQ(arena_->counts().decoded_ranges, 0u);
    draw(pieces(25, 65));
    EXPECT_EQ(arena_->counts().decoded_ranges, 0u);
    draw(pieces(10, 25));
    EXPECT_EQ(arena_->counts().decoded_ranges, 15u);
}

TEST_F(StripArenaDrawing, AnySequenceOfFramesLooksAsIndicesDo) {
    make_arena(40);
    Random random{5};
    for (int frame = 0; frame < 12; ++frame) {
        std::vector<size_t> pieces;
        const uint32_t share = 10 + random.below(70);
        for (const size_t i : all_) {
            if (random.below(100) < share) pieces.push_back(i);
        }
        const size_t missing_at_least = pieces.size() > 40 ? pieces.size() - 40 : 0;
        ASSERT_EQ(draw(pieces), picture_of(pieces)) << "frame " << frame;
        EXPECT_GE(arena_->counts().decoded_ranges, missing_at_least);
        EXPECT_EQ(arena_->counts().decoded_triangles, arena_->counts().decoded_ranges * piece_bytes_ / 12);
    }
    EXPECT_EQ(arena_->plan_frame({})->size(), 0u);
    EXPECT_EQ(arena_->round_count(), 0u);
}

TEST_F(StripArenaDrawing, LayersThatAreDestroyedAndFramesThatNeverRanAreDecodedAnew) {
    make_arena(all_.size());
    draw(all_);
    for (LayerId layer = 0; layer < 30; ++layer) arena_->forget(layer);
    arena_->forget(12345);
    EXPECT_EQ(draw(all_), picture_of_the_whole());
    EXPECT_EQ(arena_->counts().decoded_ranges, 30u);
    arena_->forget(7);
    ASSERT_TRUE(arena_->plan_frame(ranges_of(all_)).ok());  // and no more: as where a frame fails
    EXPECT_EQ(draw(all_), picture_of_the_whole());
    EXPECT_EQ(arena_->counts().decoded_ranges, all_.size());
}

TEST_F(StripArenaDrawing, RangesOfManySizesShareTheMemory) {
    std::vector<Words> streams;
    std::vector<CornerList> decoded;
    for (int i = 0; i < 150; ++i) {
        streams.push_back(random_stream(random_, 1 + random_.below(900), 0, 0));
        decoded.push_back(*codec::mesh::decode_strips(streams.back()));
    }
    const Batch batch = upload_batch(streams);
    const Buffer copy = host_buffer(4 * batch.plan.sizes.corner_words);
    arena_.emplace(device_, 3 * batch.plan.sizes.corner_words, choose_scan_tuning(device_));
    for (int frame = 0; frame < 15; ++frame) {
        std::vector<size_t> shown;
        std::vector<StripRange> ranges;
        for (size_t i = 0; i < streams.size(); ++i) {
            if (random_.below(100) < 30) continue;
            shown.push_back(i);
            ranges.push_back(
                {static_cast<LayerId>(i / 5), batch.streams[i]});  // five in a layer, at words of their own
        }
        const auto places = arena_->plan_frame(ranges);
        ASSERT_TRUE(places.ok()) << places.error().text();
        for (uint32_t round = 0; round < arena_->round_count(); ++round) {
            submit_and_wait(device_, [&](VkCommandBuffer commands) {
                arena_->record_round(commands, round);
                memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                               VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_READ_BIT);
                const VkBufferCopy all{0, 0, std::min(copy.bytes, arena_->corners().bytes)};
                vkCmdCopyBuffer(commands, arena_->corners().handle, copy.handle, 1, &all);
                memory_barrier(commands, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_TRANSFER_WRITE_BIT,
                               VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
            });
            const std::span corners(static_cast<const uint32_t*>(copy.mapped), copy.bytes / 4);
            for (size_t i = 0; i < shown.size(); ++i) {
                if ((*places)[i].round != round) continue;
                ASSERT_TRUE(same_corners(decoded[shown[i]], corners.subspan((*places)[i].first_corner)))
                    << "frame " << frame << ", stream " << shown[i];
            }
        }
        arena_->finish_frame();
        for (int i = 0; i < 4; ++i) arena_->forget(static_cast<LayerId>(random_.below(30)));
    }
}

TEST_F(StripArenaDrawing, RangesThatNeverFitAndCountsThatCannotBeAreErrors) {
    make_arena(1);
    std::vector<StripRange> ranges = ranges_of(all_);
    ranges.resize(3);
    ranges[1].stream.header.triangles *= 2;
    EXPECT_FALSE(arena_->plan_frame(ranges).ok());
    ranges = ranges_of(all_);
    ranges[1].stream.header.explicit_references = ranges[1].stream.header.references + 1;
    EXPECT_FALSE(arena_->plan_frame(ranges).ok());
    // What follows is not harmed.
    EXPECT_EQ(draw(all_), picture_of_the_whole());
}

}  // namespace
}  // namespace citystream::client::test
