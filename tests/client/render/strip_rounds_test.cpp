// A landscape of many meshes drawn with memory for few of them.
#include "client/render/strip_rounds.h"

#include <cmath>

#include "tests/client/render/strip_batch.h"
#include "tests/client/render/strip_view.h"

namespace citystream::client::test {
namespace {

constexpr uint32_t kPieces = 10, kQuads = 24, kSize = 320;

struct Landscape {
    std::vector<Words> streams;
    std::vector<uint32_t> vertices;  ///< two words each, in the streams' order
    std::vector<uint32_t> first_vertex;
};

/// Hills of kPieces x kPieces pieces, each a mesh of its own.
Landscape landscape() {
    Landscape all;
    const Topology grid = codec::mesh::quad_grid(kQuads, kQuads, false);
    const codec::mesh::StripCode code = *codec::mesh::encode_strips(grid.triangles, grid.vertices);
    for (uint32_t piece = 0; piece < kPieces * kPieces; ++piece) {
        all.streams.push_back(code.words);
        all.first_vertex.push_back(static_cast<uint32_t>(all.vertices.size() / 2));
        for (const uint32_t vertex : code.vertices) {
            const uint32_t x = piece % kPieces * kQuads + vertex % (kQuads + 1);
            const uint32_t y = piece / kPieces * kQuads + vertex / (kQuads + 1);
            const double height = 30 + 15 * std::sin(x * 0.11) + 15 * std::cos(y * 0.07);
            all.vertices.push_back(x | y << 16);
            all.vertices.push_back(static_cast<uint32_t>(height));
        }
    }
    return all;
}

/// From obliquely above: hills hide what is behind them.
StripViewConstants view_of(const Buffer& vertices) {
    constexpr float kAcross = 2.0f / (kPieces * kQuads);
    StripViewConstants constants{
        {{kAcross, 0, 0, -1}, {0, -0.6f * kAcross, -2 * kAcross, 0.9f}, {0, -0.4f * kAcross, 0, 0.9f}, {0, 0, 0, 1}},
        {}};
    std::memcpy(constants.vertices, &vertices.address, 8);
    return constants;
}

class StripRoundsDrawing : public StripDecoding {
  protected:
    void SetUp() override {
        StripDecoding::SetUp();
        view_ = create_strip_view(device_, kSize, kSize);
        scene_ = landscape();
        vertices_ = host_buffer(4 * scene_.vertices.size());
        std::memcpy(vertices_.mapped, scene_.vertices.data(), 4 * scene_.vertices.size());
        batch_ = upload_batch(scene_.streams);
    }

    void TearDown() override {
        destroy_strip_view(device_, view_);
        StripDecoding::TearDown();
    }

    std::vector<StripDraw> draws_of(size_t first, const StripPlan& plan) const {
        std::vector<StripDraw> draws;
        for (size_t i = 0; i < plan.corners_at.size(); ++i) {
            const uint32_t corners = 3 * batch_.streams[first + i].header.triangles;
            draws.push_back({plan.corners_at[i], corners, scene_.first_vertex[first + i]});
        }
        return draws;
    }

    std::vector<uint32_t> pixels() const {
        const auto* first = static_cast<const uint32_t*>(view_.target.readback.mapped);
        return {first, first + kSize * kSize};
    }

    /// From the CPU's corners, all in memory at once.
    std::vector<uint32_t> picture_of_the_whole() {
        const Buffer corners = host_buffer(4 * batch_.plan.sizes.corner_words);
        for (size_t i = 0; i < scene_.streams.size(); ++i) {
            const CornerList decoded = *codec::mesh::decode_strips(scene_.streams[i]);
            std::memcpy(static_cast<uint32_t*>(corners.mapped) + batch_.plan.corners_at[i], decoded.data(),
                        decoded.size() * sizeof decoded[0]);
        }
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            record_strip_view(commands, view_, view_of(vertices_), {&corners, 0}, draws_of(0, batch_.plan), true);
            finish_strip_view(commands, view_);
        });
        return pixels();
    }

    std::vector<uint32_t> picture_in_rounds(const StripDecoder& decoder, const StripRounds& rounds, int frames) {
        const Buffer memory = host_buffer(2 * rounds.half_bytes), records = host_buffer(rounds.records_bytes);
        write_records(rounds, records.mapped);
        const StripViewConstants constants = view_of(vertices_);
        for (int frame = 0; frame < frames; ++frame) {
            submit_and_wait(device_, [&](VkCommandBuffer commands) {
                record_strip_rounds(commands, decoder, rounds, memory, records,
                                    [&](VkCommandBuffer, const StripRound& round, const BufferRange& corners) {
                                        record_strip_view(commands, view_, constants, corners,
                                                          draws_of(round.first, round.plan), round.first == 0);
                                    });
                finish_strip_view(commands, view_);
            });
        }
        return pixels();
    }

    StripView view_;
    Landscape scene_;
    Buffer vertices_;
    Batch batch_;
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
