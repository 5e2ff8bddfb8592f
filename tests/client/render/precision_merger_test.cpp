// The GPU's change of bit levels, and its fetch with the rule that closes cracks, against the CPU's, word for word.
#include "client/render/precision_merger.h"

#include "codec/mesh/binned_buffer.h"
#include "codec/mesh/texcoord_precision.h"
#include "shaders/twin_precision.comp.h"
#include "tests/client/render/gpu_twin.h"
#include "tests/client/render/precision_shapes.h"

namespace citystream::client::test {
namespace {

using namespace codec::mesh;

/// A buffer that is to change, and what the CPU makes of it.
struct Case {
    PrecisionShape shape;
    uint32_t from = 0, to = 0;
    std::vector<uint32_t> source, planes, expected;
};

Case make_case(const PrecisionShape& shape, std::span<const uint32_t> words, uint32_t from, uint32_t to) {
    Case one{shape, from, to, pack_precision(shape, words, from), planes_between(shape, words, from, to), {}};
    const auto view = PrecisionView::create(one.source);
    EXPECT_TRUE(view.ok());
    one.expected = *change_level(*view, to, one.planes);
    return one;
}

class PrecisionMergerTest : public GpuTwin {
  protected:
    /// All cases in one dispatch.
    void expect_same_words(std::span<const Case> cases) {
        const PrecisionMerger merger(device_);
        std::vector<PrecisionChange> changes;
        std::vector<Buffer> targets;
        for (const Case& one : cases) {
            targets.push_back(host_buffer(4 * one.expected.size() + 4));
            std::memset(targets.back().mapped, 0xee, targets.back().bytes);
            changes.push_back({&one.shape, one.from, one.to, reference_of(one.source), reference_of(one.planes),
                               targets.back().address | LAYER_REF_DIRECT});
        }
        const Buffer table = host_buffer(PrecisionMerger::table_bytes(cases.size()));
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            merger.record(commands, changes, table);
            memory_barrier(commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_ACCESS_SHADER_WRITE_BIT,
                           VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
        });
        for (size_t i = 0; i < cases.size(); ++i) {
            const auto* words = static_cast<const uint32_t*>(targets[i].mapped);
            const std::vector<uint32_t> got(words, words + cases[i].expected.size());
            ASSERT_EQ(got, cases[i].expected) << "case " << i << ": " << cases[i].from << " to " << cases[i].to;
            ASSERT_EQ(words[got.size()], 0xeeeeeeeeu) << "a word behind the buffer was written";
        }
    }

    /// In one piece; the address of nothing is 0.
    VkDeviceAddress reference_of(std::span<const uint32_t> words) {
        if (words.empty()) return 0;
        const Buffer buffer = host_buffer(words.size_bytes());
        std::memcpy(buffer.mapped, words.data(), words.size_bytes());
        return buffer.address | LAYER_REF_DIRECT;
    }
};

TEST_F(PrecisionMergerTest, EveryLevelAndEveryNumberOfVerticesModulo32IsTheSameAsOnTheCpu) {
    std::mt19937_64 random(1);
    std::vector<Case> cases;
    for (uint32_t level = 1; level <= 25; ++level) {
        for (uint32_t rest = 0; rest < 32; ++rest) {
            const PrecisionShape shape = make_shape(random, 32 + rest, 25, false);
            const auto words = random_words(random, shape);
            cases.push_back(make_case(shape, words, level, level));
            cases.push_back(make_case(shape, words, level, static_cast<uint32_t>(random() % 26)));
        }
    }
    expect_same_words(cases);
}

TEST_F(PrecisionMergerTest, LevelWalksUpAndDownAreTheSameAsDirectPacking) {
    std::mt19937_64 random(2);
    const PrecisionShape shape = make_shape(random, 1000, 16, false);
    const auto words = random_words(random, shape);
    std::vector<Case> cases;
    for (uint32_t level = 5; level < 12; ++level) {
        cases.push_back(make_case(shape, words, level, level + 1));
        cases.push_back(make_case(shape, words, level + 1, level));
        EXPECT_EQ(cases.back().expected, pack_precision(shape, words, level));
    }
    cases.push_back(make_case(shape, words, 5, 12));
    cases.push_back(make_case(shape, words, 12, 5));
    expect_same_words(cases);
}

TEST_F(PrecisionMergerTest, BinsLeadingZerosAndAnyComponentsAreTheSameAsOnTheCpu) {
    std::mt19937_64 random(3);
    std::vector<Case> cases;
    for (int i = 0; i < 300; ++i) {
        const auto full = static_cast<uint32_t>(1 + random() % 31);
        const PrecisionShape shape = make_shape(random, static_cast<uint32_t>(random() % 200), full, i % 8 != 0);
        ASSERT_TRUE(check_shape(shape).ok()) << check_shape(shape).error().text();
        const auto words = random_words(random, shape);
        cases.push_back(make_case(shape, words, static_cast<uint32_t>(random() % (full + 1)),
                                  static_cast<uint32_t>(random() % (full + 1))));
    }
    expect_same_words(cases);
}

TEST_F(PrecisionMergerTest, ThousandsOfSmallBuffersAndALargeOneAreOneDispatch) {
    std::mt19937_64 random(4);
    std::vector<Case> cases;
    for (int i = 0; i < 500; ++i) {
        const PrecisionShape shape = make_shape(random, static_cast<uint32_t>(4 + random() % 40), 20, i % 2 == 0);
        const auto words = random_words(random, shape);
        cases.push_back(make_case(shape, words, 6, 9));
    }
    const PrecisionShape large = make_shape(random, 70000, 20, false);
    cases.push_back(make_case(large, random_words(random, large), 9, 10));
    expect_same_words(cases);
}

TEST_F(PrecisionMergerTest, FetchAndShownPositionsAreTheSameIntegersAsOnTheCpu) {
    std::mt19937_64 random(5);
    for (const Reconstruction reading : {Reconstruction::kLow, Reconstruction::kMiddle, Reconstruction::kThirds}) {
        std::vector<codec::mesh::GridPoint> points;
        std::vector<uint32_t> most;
        for (int i = 0; i < 3000; ++i) {
            points.push_back({static_cast<int32_t>(random() % 2000000) - 1000000,
                              static_cast<int32_t>(random() % 2000000) - 300, static_cast<int32_t>(random() % 90000)});
            most.push_back(static_cast<uint32_t>(random() % 13));
        }
        const PositionWords packed = reading == Reconstruction::kLow ? adaptive_positions(points, 12, reading)
                                                                     : constrained_positions(points, most, 12, reading);
        for (const uint32_t dropped : {0u, 3u, 7u, 12u}) {
            const auto buffer = pack_precision(packed.shape, packed.words, level_of(packed.grid, dropped));
            const auto view = PrecisionView::create(buffer);
            const DropRule rule{static_cast<uint32_t>(1 + random() % 2000), 12};
            std::array<int32_t, 3> from_camera{};
            for (int32_t& x : from_camera) x = static_cast<int32_t>(random() % 20000000) - 10000000;
            std::vector<uint32_t> input;
            for (const int32_t x : packed.grid.origin) input.push_back(static_cast<uint32_t>(x));
            for (const int32_t x : from_camera) input.push_back(static_cast<uint32_t>(x));
            input.insert(input.end(), {rule.common_dropped, rule.distance_per_unit, static_cast<uint32_t>(reading)});
            ASSERT_EQ(input.size(), size_t{TWIN_PRECISION_INPUT_WORDS});
            TwinConstants constants{};
            constants.count = packed.shape.vertices;
            constants.first = 3;
            const auto gpu =
                run(k_twin_precision_comp, upload_words(buffer, dropped == 3), constants, TWIN_PRECISION_WORDS, input);
            for (uint32_t v = 0; v < packed.shape.vertices; ++v) {
                std::array<uint32_t, 3> words{};
                const uint32_t level = view->fetch(v, words);
                const codec::mesh::GridPoint shown = shown_position(*view, packed.grid, v, rule, from_camera);
                const uint32_t* got = &gpu[size_t{v} * TWIN_PRECISION_WORDS];
                for (size_t c = 0; c < 3; ++c) {
                    ASSERT_EQ(got[c], words[c]) << v;
                    ASSERT_EQ(static_cast<int32_t>(got[4 + c]), shown[c]) << v;
                }
                ASSERT_EQ(got[3], level);
            }
        }
    }
}

TEST_F(PrecisionMergerTest, FieldsOfEveryWidthAtEveryBitAreFetchedAsOnTheCpu) {
    std::mt19937_64 random(7);
    for (uint32_t full = 1; full <= 31; ++full) {
        PrecisionShape shape = make_shape(random, 300, full, full % 3 == 0);
        shape.components = 3;
        shape.leading = {static_cast<uint32_t>(random() % 3) * full / 4, 0, full / 2, 0};
        const auto words = random_words(random, shape);
        const auto level = static_cast<uint32_t>(random() % (full + 1));
        const auto buffer = pack_precision(shape, words, full % 2 == 0 ? level : full);
        const auto view = PrecisionView::create(buffer);
        ASSERT_TRUE(view.ok()) << view.error().text();
        TwinConstants constants{};
        constants.count = shape.vertices;
        constants.first = 3;
        const std::vector<uint32_t> input(TWIN_PRECISION_INPUT_WORDS, 1);
        const auto gpu =
            run(k_twin_precision_comp, upload_words(buffer, full % 5 == 0), constants, TWIN_PRECISION_WORDS, input);
        for (uint32_t v = 0; v < shape.vertices; ++v) {
            std::array<uint32_t, 3> fetched{};
            ASSERT_EQ(view->fetch(v, fetched), gpu[size_t{v} * TWIN_PRECISION_WORDS + 3]);
            for (size_t c = 0; c < 3; ++c) ASSERT_EQ(gpu[size_t{v} * TWIN_PRECISION_WORDS + c], fetched[c]) << full;
        }
    }
}

TEST_F(PrecisionMergerTest, TextureCoordinatesAreTheSameIntegersAsOnTheCpu) {
    std::mt19937_64 random(6);
    for (const auto& [width, height] : {std::pair{512u, 512u}, {1024u, 64u}, {3u, 200u}}) {
        std::vector<std::array<int32_t, 2>> places;
        for (int i = 0; i < 700; ++i) {
            places.push_back({static_cast<int32_t>(random() % 400000) - 90000, static_cast<int32_t>(random() % 70000)});
        }
        const TexcoordWords packed = texcoord_words(places, width, height);
        for (uint32_t level = 0; level <= packed.shape.full_bits; level += 3) {
            const auto buffer = pack_precision(packed.shape, packed.words, level);
            const auto view = PrecisionView::create(buffer);
            const std::vector<uint32_t> input = {static_cast<uint32_t>(packed.base[0]),
                                                 static_cast<uint32_t>(packed.base[1]),
                                                 0,
                                                 packed.shift[0],
                                                 packed.shift[1],
                                                 0};
            TwinConstants constants{};
            constants.count = packed.shape.vertices;
            constants.first = 2;
            const auto gpu =
                run(k_twin_precision_comp, upload_words(buffer, false), constants, TWIN_PRECISION_WORDS, input);
            for (uint32_t v = 0; v < packed.shape.vertices; ++v) {
                std::array<uint32_t, 2> fetched{};
                view->fetch(v, fetched);
                const auto place = packed.coordinate(fetched, level);
                ASSERT_EQ(static_cast<int32_t>(gpu[size_t{v} * TWIN_PRECISION_WORDS]), place[0]);
                ASSERT_EQ(static_cast<int32_t>(gpu[size_t{v} * TWIN_PRECISION_WORDS + 1]), place[1]);
            }
        }
    }
}

}  // namespace
}  // namespace citystream::client::test
