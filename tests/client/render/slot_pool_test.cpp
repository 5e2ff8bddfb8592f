#include "client/render/slot_pool.h"

#include <cstring>

#include "client/render/device_choice.h"
#include "tests/client/render/device_test.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {
namespace {

constexpr uint64_t kSlotWords = kSlotBytes / 4;

// Both ways of writing: mapped chunks, and device memory through a staging buffer.
class SlotPoolTest : public DeviceTest, public testing::WithParamInterface<bool> {
  protected:
    void TearDown() override {
        destroy_slot_pool(pool_);
        DeviceTest::TearDown();
    }

    void make_pool(uint64_t budget) { pool_ = create_slot_pool(device_, budget, GetParam()); }

    // The layer's words as the GPU holds them.
    std::vector<uint32_t> read_back(LayerId id) {
        const SlotLayer& layer = pool_.layers[id];
        Buffer buffer = create_buffer(device_, layer.slots.size() * kSlotBytes, BufferPlace::kReadback);
        submit_and_wait(device_, [&](VkCommandBuffer commands) {
            for (size_t i = 0; i < layer.slots.size(); ++i) {
                const Buffer& chunk = pool_.chunks[layer.slots[i] / kSlotsPerChunk];
                const VkBufferCopy copy{layer.slots[i] % kSlotsPerChunk * kSlotBytes, i * kSlotBytes, kSlotBytes};
                vkCmdCopyBuffer(commands, chunk.handle, buffer.handle, 1, &copy);
            }
        });
        std::vector<uint32_t> words(layer.words);
        std::memcpy(words.data(), buffer.mapped, words.size() * 4);
        destroy_buffer(device_, buffer);
        return words;
    }

    static std::vector<uint32_t> random_words(Random& random, size_t count) {
        std::vector<uint32_t> words(count);
        for (uint32_t& word : words) word = random.next();
        return words;
    }

    SlotPool pool_;
};

TEST_P(SlotPoolTest, AppendsFillTheLastSlotFirstAndKeepEveryWord) {
    make_pool(8 << 20);
    Random random;
    const LayerId layer = create_layer(pool_);
    const LayerId other = create_layer(pool_);
    std::vector<uint32_t> expected;
    for (const size_t count :
         {size_t{1}, size_t{100}, size_t{4000}, size_t{9000}, size_t{3}, size_t{0}, size_t{20000}}) {
        const std::vector<uint32_t> words = random_words(random, count);
        ASSERT_TRUE(append_words(pool_, layer, words).ok());
        ASSERT_TRUE(append_words(pool_, other, random_words(random, 5000)).ok());
        expected.insert(expected.end(), words.begin(), words.end());
        EXPECT_EQ(pool_.layers[layer].slots.size(), (expected.size() + kSlotWords - 1) / kSlotWords);
    }
    EXPECT_EQ(read_back(layer), expected);
    EXPECT_EQ(read_words(pool_, layer, expected.size() + 9), expected);
    expected.resize(9001);
    EXPECT_EQ(read_words(pool_, layer, 9001), expected);
    EXPECT_TRUE(read_words(pool_, layer, 0).empty());
    EXPECT_TRUE(read_words(pool_, kNoLayer, 5).empty());
}

TEST_P(SlotPoolTest, ChunksNeverExceedTheBudgetAndARefusedAppendChangesNothing) {
    const uint64_t budget = kChunkBytes + 5 * kSlotBytes + 100;
    make_pool(budget);
    EXPECT_EQ(pool_.slot_count, kSlotsPerChunk + 5);
    EXPECT_EQ(allocated_bytes(pool_), 0u);
    const std::vector<uint32_t> words(10 * kSlotWords, 7);
    std::vector<LayerId> layers;
    bool full = false;
    while (!full) {
        layers.push_back(create_layer(pool_));
        const uint64_t used = pool_.slots_used;
        full = !append_words(pool_, layers.back(), words).ok();
        EXPECT_LE(allocated_bytes(pool_), budget);
        EXPECT_EQ(pool_.slots_used, full ? used : used + 10);
    }
    EXPECT_EQ(pool_.slots_used, pool_.slot_count / 10 * 10);
    EXPECT_TRUE(append_words(pool_, layers.back(), std::vector<uint32_t>(kSlotWords, 1)).ok());
    EXPECT_EQ(pool_.slots_used, pool_.slot_count);
    EXPECT_FALSE(append_words(pool_, layers.back(), std::vector<uint32_t>(1, 1)).ok());
}

TEST_P(SlotPoolTest, FreedSlotsAreGivenOutAgainBeforeNewChunks) {
    make_pool(64 << 20);
    Random random;
    std::vector<LayerId> layers;
    for (int i = 0; i < 100; ++i) {
        layers.push_back(create_layer(pool_));
        ASSERT_TRUE(append_words(pool_, layers.back(), random_words(random, kSlotWords)).ok());
    }
    const uint64_t allocated = allocated_bytes(pool_);
    for (int round = 0; round < 20; ++round) {
        for (size_t i = round % 2; i < layers.size(); i += 2) {
            destroy_layer(pool_, layers[i]);
            layers[i] = create_layer(pool_);
            ASSERT_TRUE(append_words(pool_, layers[i], random_words(random, kSlotWords)).ok());
        }
    }
    EXPECT_EQ(allocated_bytes(pool_), allocated);
    EXPECT_EQ(pool_.slots_used, 100u);
    // A layer larger than any free run takes what holes there are.
    for (size_t i = 0; i < layers.size(); i += 2) destroy_layer(pool_, layers[i]);
    const LayerId wide = create_layer(pool_);
    const std::vector<uint32_t> words = random_words(random, (pool_.slot_count - pool_.slots_used) * kSlotWords);
    ASSERT_TRUE(append_words(pool_, wide, words).ok());
    EXPECT_FALSE(is_contiguous(pool_, pool_.layers[wide]));
    EXPECT_EQ(read_back(wide), words);
    EXPECT_LE(allocated_bytes(pool_), uint64_t{64} << 20);
}

TEST_P(SlotPoolTest, CallsOnDeadLayersAreRefused) {
    make_pool(1 << 20);
    const LayerId layer = create_layer(pool_);
    destroy_layer(pool_, layer);
    destroy_layer(pool_, layer);
    EXPECT_FALSE(append_words(pool_, layer, std::vector<uint32_t>(1, 1)).ok());
    EXPECT_FALSE(append_words(pool_, 12345, std::vector<uint32_t>(1, 1)).ok());
    EXPECT_EQ(create_layer(pool_), layer);
    EXPECT_NE(create_layer(pool_), layer);
}

INSTANTIATE_TEST_SUITE_P(Ways, SlotPoolTest, testing::Values(true, false),
                         [](const auto& way) { return way.param ? "Mapped" : "Staged"; });

}  // namespace
}  // namespace citystream::client::test
