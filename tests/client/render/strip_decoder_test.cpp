// The GPU's strip decoder against the CPU's, corner for corner.
#include "client/render/strip_decoder.h"

#include "tests/client/render/strip_batch.h"

namespace citystream::client::test {
namespace {

using codec::mesh::awkward_topologies;
using codec::mesh::icosphere;
using codec::mesh::quad_grid;
using codec::mesh::with_edges_flipped;

constexpr uint32_t kModes[] = {STRIP_MODE_RESTARTS, STRIP_MODE_DEGENERATES};

/// The awkward meshes in both modes and with both predictions.
std::vector<Words> awkward_streams() {
    std::vector<Words> streams;
    for (const auto& [name, mesh] : awkward_topologies()) {
        for (const uint32_t mode : kModes) {
            for (const uint32_t prediction : {0u, 1u}) streams.push_back(strip_words(mesh, mode, prediction));
        }
    }
    return streams;
}

TEST_F(StripDecoding, EveryAwkwardMeshComesOutAsOnTheCpuAloneAndInABatch) {
    const std::vector<Words> streams = awkward_streams();
    size_t way = 0;
    for (const ScanTuning& tuning : tunings()) {
        StripDecoder decoder = create_strip_decoder(device_, tuning);
        expect_decoded(decoder, streams);
        for (size_t i = way++ % 2; i < streams.size(); i += 2) expect_decoded(decoder, {&streams[i], 1});
        forget_layers();
        destroy_strip_decoder(device_, decoder);
    }
}

TEST_F(StripDecoding, ABatchWithoutTrianglesDecodesToNothing) {
    StripDecoder decoder = create_strip_decoder(device_, choose_scan_tuning(device_));
    expect_decoded(decoder, {});
    expect_decoded(decoder, std::vector<Words>(3, strip_words({{}, 5})));
    destroy_strip_decoder(device_, decoder);
}

TEST_F(StripDecoding, SizesAtTheEdgesOfWordsBlocksAndWorkgroupsComeOutAsOnTheCpu) {
    for (const ScanTuning& tuning : tunings()) {
        StripDecoder decoder = create_strip_decoder(device_, tuning);
        for (const uint32_t edge : {16u, 32u, 256u, 16u * SCAN_LANES, 32u * SCAN_LANES, 65536u}) {
            std::vector<Words> streams;
            for (const uint32_t triangles : {edge - 1, edge, edge + 1}) {
                for (const uint32_t mode : kModes)
                    streams.push_back(random_stream(random_, triangles, mode, edge % 3 % 2));
            }
            expect_decoded(decoder, streams);
            forget_layers();
        }
        destroy_strip_decoder(device_, decoder);
    }
}

TEST_F(StripDecoding, AHundredRepeatsGiveTheSameWords) {
    std::vector<Words> streams;
    for (const uint32_t triangles : {255u, 256u, 257u, 65537u})
        streams.push_back(random_stream(random_, triangles, triangles % 3 % 2, 1));
    for (const ScanPath path : {ScanPath::kPasses, ScanPath::kLookBack}) {
        StripDecoder decoder = create_strip_decoder(device_, {path, subgroups_fit_scans(device_)});
        const Batch batch = upload_batch(streams);
        const std::vector<uint32_t> first = decode(decoder, batch);
        for (int repeat = 1; repeat < 100; ++repeat) ASSERT_EQ(decode(decoder, batch), first) << repeat;
        forget_layers();
        destroy_strip_decoder(device_, decoder);
    }
}

TEST_F(StripDecoding, MoreThanSixteenMillionTrianglesComeOutAsOnTheCpu) {
    const Words stream = random_stream(random_, (1u << 24) + 1, STRIP_MODE_DEGENERATES, 1);
    StripDecoder decoder = create_strip_decoder(device_, {ScanPath::kLookBack, subgroups_fit_scans(device_)});
    expect_decoded(decoder, {&stream, 1});
    destroy_strip_decoder(device_, decoder);
}

TEST_F(StripDecoding, ThousandsOfSmallMeshesAreOneBatch) {
    std::vector<Words> kinds = awkward_streams();
    for (uint32_t triangles = 1; triangles < 60; ++triangles)
        kinds.push_back(random_stream(random_, triangles, triangles % 2, triangles / 2 % 2));
    std::vector<Words> streams;
    for (uint32_t i = 0; i < 10'000; ++i) streams.push_back(kinds[random_.below(static_cast<uint32_t>(kinds.size()))]);
    for (const ScanPath path : {ScanPath::kPasses, ScanPath::kLookBack}) {
        StripDecoder decoder = create_strip_decoder(device_, {path, subgroups_fit_scans(device_)});
        expect_decoded(decoder, streams);
        forget_layers();
        destroy_strip_decoder(device_, decoder);
    }
}

TEST_F(StripDecoding, BlocksThatNeverSpeakAreWorkedOutByThoseBehindThem) {
    std::vector<Words> streams = awkward_streams();
    streams.push_back(random_stream(random_, 100'000, STRIP_MODE_RESTARTS, 0));
    StripDecoder decoder = create_strip_decoder(device_, {ScanPath::kLookBack, subgroups_fit_scans(device_), 0, 3});
    expect_decoded(decoder, streams);
    destroy_strip_decoder(device_, decoder);
}

// What the CPU's check would refuse is given to the GPU with the header of the sound stream: nothing may hang or be
// written elsewhere, no corner is out of range, and the other meshes of the batch do not notice.
TEST_F(StripDecoding, TenThousandDamagedStreamsStayInTheirOwnMemory) {
    std::vector<Words> sound, damaged;
    for (uint32_t i = 0; i < 10'000; ++i) {
        sound.push_back(random_stream(random_, 1 + random_.below(90), i % 2, i / 2 % 2));
        damaged.push_back(sound.back());
        if (i % 4 == 0) continue;
        for (uint32_t change = 0; change <= random_.below(4); ++change) {
            const auto body = static_cast<uint32_t>(damaged[i].size()) - STRIP_HEADER_WORDS;
            uint32_t& word = damaged[i][STRIP_HEADER_WORDS + random_.below(body)];
            word = change % 2 == 0 ? static_cast<uint32_t>(random_.next()) : word ^ 1u << random_.below(32);
        }
    }
    for (const ScanTuning& tuning : tunings()) {
        StripDecoder decoder = create_strip_decoder(device_, tuning);
        const Batch batch = upload_batch(damaged, sound);
        const std::vector<uint32_t> corners = decode(decoder, batch);
        for (size_t i = 0; i < sound.size(); ++i) {
            const codec::mesh::StripHeader& header = batch.streams[i].header;
            const auto own = std::span(corners).subspan(batch.plan.corners_at[i], size_t{3} * header.triangles);
            const bool same = i % 4 != 0 || same_corners(*codec::mesh::decode_strips(sound[i]), own);
            ASSERT_TRUE(same) << i;
            for (const uint32_t corner : own) ASSERT_LT(corner, header.vertices) << i;
        }
        forget_layers();
        destroy_strip_decoder(device_, decoder);
    }
}

TEST_F(StripDecoding, DamageThatTheCpuAcceptsDecodesAlike) {
    const Words sound = strip_words(with_edges_flipped(icosphere(2), 60));
    std::vector<Words> accepted;
    for (uint32_t i = 0; i < 20'000 && accepted.size() < 200; ++i) {
        Words words = sound;
        words[STRIP_HEADER_WORDS + random_.below(static_cast<uint32_t>(words.size()) - STRIP_HEADER_WORDS)] ^=
            1u << random_.below(32);
        if (codec::mesh::check_strip_code(words).ok()) accepted.push_back(words);
    }
    ASSERT_GT(accepted.size(), 20u);
    StripDecoder decoder = create_strip_decoder(device_, choose_scan_tuning(device_));
    expect_decoded(decoder, accepted);
    destroy_strip_decoder(device_, decoder);
}

TEST_F(StripDecoding, TemporaryMemoryIsAtMostAWordAReference) {
    const std::vector<Words> meshes = {
        strip_words(with_edges_flipped(icosphere(6), 20'000)), strip_words(quad_grid(100, 100, true)),
        strip_words(codec::mesh::separate_quads(4000)), strip_words(codec::mesh::welded_boxes(4000))};
    for (const ScanPath path : {ScanPath::kPasses, ScanPath::kLookBack}) {
        StripDecoder decoder = create_strip_decoder(device_, {path, false});
        const auto expect_within = [&](std::span<const Words> streams, double most) {
            const Batch batch = upload_batch(streams);
            EXPECT_LE(static_cast<double>(strip_temporary_words(decoder, batch.plan.sizes)),
                      most * static_cast<double>(batch.plan.sizes.references));
        };
        for (const Words& words : meshes) expect_within({&words, 1}, 0.85);
        expect_within(awkward_streams(), 1);
        // Thirty references a vertex: nearly all are explicit, and the states and ranks come on top.
        const Words soup = strip_words(codec::mesh::random_triangles(20'000, 2000, 4));
        expect_within({&soup, 1}, 1 + 1.0 / 32 + 4.0 / SCAN_LANES);
        forget_layers();
        destroy_strip_decoder(device_, decoder);
    }
}

TEST_F(StripDecoding, BatchesThatDoNotFitOneDispatchAreRefused) {
    StripStream stream;
    stream.header = *codec::mesh::read_strip_header(strip_words(quad_grid(3, 3, false)));
    EXPECT_TRUE(plan_strips({&stream, 1}).ok());
    stream.header.triangles = 0x10000000;
    stream.header.references = stream.header.triangles + 2;
    EXPECT_FALSE(plan_strips({&stream, 1}).ok());
    stream.header = *codec::mesh::read_strip_header(strip_words(quad_grid(3, 3, false)));
    stream.header.explicit_references = stream.header.references + 1;
    EXPECT_FALSE(plan_strips({&stream, 1}).ok());
}

}  // namespace
}  // namespace citystream::client::test
