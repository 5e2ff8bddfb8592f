// Layers whose precision buffers take more bits on the GPU: the words of every layer, those before the buffer too, are
// those that the CPU makes, whatever waits together, where slots lie and how few are free.
#include "client/render/layer_refiner.h"

#include "client/render/device_choice.h"
#include "tests/client/render/device_test.h"
#include "tests/client/render/precision_shapes.h"
#include "tests/client/render/scenes.h"

namespace citystream::client::test {
namespace {

using namespace codec::mesh;

constexpr uint64_t kSlotWords = kSlotBytes / 4;

/// A layer as the test knows it.
struct Layer {
    LayerId id = kNoLayer;
    std::vector<uint32_t> before;
    PrecisionShape shape;
    std::vector<uint32_t> values;
    uint32_t level = 0;

    std::vector<uint32_t> words() const {
        std::vector<uint32_t> all = before;
        const auto buffer = pack_precision(shape, values, level);
        all.insert(all.end(), buffer.begin(), buffer.end());
        return all;
    }
};

// Mapped chunks, and device memory through a staging buffer.
class LayerRefinerTest : public DeviceTest, public testing::WithParamInterface<bool> {
  protected:
    void TearDown() override {
        refiner_.reset();
        destroy_slot_pool(pool_);
        DeviceTest::TearDown();
    }

    void make_pool(uint64_t budget) {
        pool_ = create_slot_pool(device_, budget, GetParam());
        refiner_.emplace(device_, pool_);
    }

    /// `scattered`: a used slot lies behind every slot.
    Layer make_layer(size_t words_before, const PrecisionShape& shape, uint32_t level, bool scattered) {
        Layer layer{create_layer(pool_), {}, shape, random_words(random_, shape), level};
        for (size_t i = 0; i < words_before; ++i) layer.before.push_back(static_cast<uint32_t>(random_()));
        const std::vector<uint32_t> words = layer.words();
        for (size_t at = 0; at < words.size(); at += kSlotWords) {
            const auto part = std::span(words).subspan(at, std::min<size_t>(kSlotWords, words.size() - at));
            EXPECT_TRUE(append_words(pool_, layer.id, part).ok());
            if (!scattered) continue;
            EXPECT_TRUE(append_words(pool_, create_layer(pool_), part.first(1)).ok());
        }
        return layer;
    }

    Status refine(Layer& layer, uint32_t to_level) {
        const auto planes = planes_between(layer.shape, layer.values, layer.level, to_level);
        const auto refinement = refiner_->plan(layer.id, layer.before.size(), planes.size(), to_level);
        if (!refinement) return refinement.error();
        refiner_->make_room(refinement->slots());
        Status status = refiner_->add(*refinement, planes);
        if (status) layer.level = to_level;
        return status;
    }

    void expect_words(const Layer& layer) {
        refiner_->settle(layer.id);
        ASSERT_EQ(read_words(pool_, layer.id, ~uint64_t{0} / 2), layer.words());
    }

    SlotPool pool_;
    std::optional<LayerRefiner> refiner_;
    std::mt19937_64 random_{11};
};

TEST_P(LayerRefinerTest, AnySequenceOfRefinementsGivesTheWordsThatTheCpuPacks) {
    make_pool(16 << 20);
    std::vector<Layer> layers;
    for (int i = 0; i < 60; ++i) {
        const auto shape = make_shape(random_, static_cast<uint32_t>(random_() % 900), 18, i % 3 != 0);
        layers.push_back(make_layer(random_() % 700, shape, static_cast<uint32_t>(random_() % 10), i % 2 == 0));
    }
    for (int i = 0; i < 200; ++i) {
        Layer& layer = layers[random_() % layers.size()];
        const auto level = static_cast<uint32_t>(layer.level + random_() % 4);
        ASSERT_TRUE(refine(layer, std::min(level, layer.shape.full_bits)).ok());
        if (random_() % 16 == 0) refiner_->run();
    }
    for (const Layer& layer : layers) expect_words(layer);
    EXPECT_FALSE(refiner_->is_waiting());
    EXPECT_EQ(refiner_->held_slots(), 0u);
    uint64_t slots = 0;
    for (const SlotLayer& layer : pool_.layers) slots += layer.slots.size();
    EXPECT_EQ(pool_.slots_used, slots) << "slots were lost or counted twice";
}

TEST_P(LayerRefinerTest, ThousandsOfSmallLayersAreOneDispatch) {
    make_pool(32 << 20);
    std::vector<Layer> layers;
    for (int i = 0; i < 3000; ++i) {
        PrecisionShape shape = make_shape(random_, static_cast<uint32_t>(random_() % 120), 20, false);
        shape.components = 1;
        layers.push_back(make_layer(random_() % 300, shape, 8, false));
    }
    const uint64_t held = pool_.slots_used;
    for (Layer& layer : layers) ASSERT_TRUE(refine(layer, 11).ok());
    EXPECT_EQ(refiner_->held_slots(), held) << "some ran before they had to";
    submit_and_wait(device_, [&](VkCommandBuffer commands) { refiner_->record(commands); });
    refiner_->finish();
    for (const Layer& layer : layers) expect_words(layer);
}

TEST_P(LayerRefinerTest, LayersThatLieInPiecesAreWrittenThroughPageTables) {
    make_pool(1 << 20);
    const PrecisionShape shape = make_shape(random_, 8000, 20, false);
    Layer layer = make_layer(777, shape, 6, true);
    // Every other one of the slots that are left is taken.
    std::vector<LayerId> plugs;
    while (free_slots(pool_) > 0) {
        plugs.push_back(create_layer(pool_));
        ASSERT_TRUE(append_words(pool_, plugs.back(), std::vector<uint32_t>(1, 5)).ok());
    }
    for (size_t i = 0; i < plugs.size(); i += 2) destroy_layer(pool_, plugs[i]);
    ASSERT_TRUE(refine(layer, 9).ok());
    EXPECT_FALSE(is_contiguous(pool_, pool_.layers[layer.id]));
    expect_words(layer);
}

TEST_P(LayerRefinerTest, WhatWaitsIsRunWhenItsSlotsAreNeeded) {
    make_pool(40 * kSlotBytes);
    PrecisionShape shape = make_shape(random_, 700, 24, false);
    std::vector<Layer> layers;
    for (int i = 0; i < 3; ++i) layers.push_back(make_layer(10, shape, 8, false));
    const auto used = [&] { return pool_.slots_used - refiner_->held_slots(); };
    // A layer's slots at its new size are at most 7: with 3 layers there is always room for one once what waits is run.
    for (uint32_t level = 9; level <= 24; ++level) {
        for (Layer& layer : layers) {
            const uint64_t needed = slots_to_append(pool_, create_layer(pool_), layer.words().size());
            ASSERT_LE(used() + needed, pool_.slot_count);
            ASSERT_TRUE(refine(layer, level).ok()) << level;
        }
    }
    for (const Layer& layer : layers) expect_words(layer);
    EXPECT_LE(allocated_bytes(pool_), 40 * kSlotBytes);
}

TEST_P(LayerRefinerTest, AChangeThatHasNoRoomBesideTheOldWordsIsRefusedAndChangesNothing) {
    make_pool(4 * kSlotBytes);
    Layer large = make_layer(0, make_shape(random_, 700, 24, false), 8, false);
    ASSERT_GT(slots_to_append(pool_, create_layer(pool_), large.words().size()), free_slots(pool_));
    EXPECT_FALSE(refine(large, 9).ok());
    expect_words(large);
}

TEST_P(LayerRefinerTest, LayersAreDestroyedAndMadeAnewWhileTheirChangesWait) {
    make_pool(4 << 20);
    const PrecisionShape shape = make_shape(random_, 500, 20, false);
    Layer kept = make_layer(100, shape, 8, false), gone = make_layer(50, shape, 8, false);
    ASSERT_TRUE(refine(gone, 11).ok());
    ASSERT_TRUE(refine(kept, 11).ok());
    refiner_->forget(gone.id);
    destroy_layer(pool_, gone.id);
    Layer anew = make_layer(30, shape, 14, false);
    EXPECT_EQ(anew.id, gone.id);
    expect_words(kept);
    expect_words(anew);
    EXPECT_EQ(pool_.slots_used, pool_.layers[kept.id].slots.size() + pool_.layers[anew.id].slots.size());
}

TEST_P(LayerRefinerTest, RequestsThatDoNotFitTheLayersWordsAreRefused) {
    make_pool(4 << 20);
    PrecisionShape shape = make_shape(random_, 400, 20, false);
    const Layer layer = make_layer(60, shape, 8, false);
    const uint64_t planes = shape.words_between(8, 11);
    EXPECT_TRUE(refiner_->plan(layer.id, 60, planes, 11).ok());
    EXPECT_FALSE(refiner_->plan(layer.id, 59, planes, 11).ok()) << "no buffer begins there";
    EXPECT_FALSE(refiner_->plan(layer.id, ~uint64_t{0}, planes, 11).ok());
    EXPECT_FALSE(refiner_->plan(layer.id, 60, planes - 1, 11).ok());
    EXPECT_FALSE(refiner_->plan(layer.id, 60, planes + 1, 11).ok());
    EXPECT_FALSE(refiner_->plan(layer.id, 60, 0, 7).ok()) << "a lower level";
    EXPECT_FALSE(refiner_->plan(layer.id, 60, shape.words_between(8, 20), 21).ok()) << "no such level";
    EXPECT_FALSE(refiner_->plan(layer.id + 1, 60, planes, 11).ok());
    EXPECT_FALSE(refiner_->plan(kNoLayer, 60, planes, 11).ok());
    ASSERT_TRUE(append_words(pool_, layer.id, std::vector<uint32_t>(1, 0)).ok());
    EXPECT_FALSE(refiner_->plan(layer.id, 60, planes, 11).ok()) << "the buffer is not the rest of the layer";
    // Headers of random bits.
    for (int i = 0; i < 2000; ++i) {
        std::vector<uint32_t> words = layer.words();
        words[60 + random_() % 6] ^= 1u << random_() % 32;
        const LayerId damaged = create_layer(pool_);
        ASSERT_TRUE(append_words(pool_, damaged, words).ok());
        const auto refinement = refiner_->plan(damaged, 60, planes, 11);
        if (refinement) {
            ASSERT_TRUE(refiner_->add(*refinement, planes_between(shape, layer.values, 8, 11)).ok());
            refiner_->run();
        }
        destroy_layer(pool_, damaged);
    }
}

INSTANTIATE_TEST_SUITE_P(Ways, LayerRefinerTest, testing::Values(true, false),
                         [](const auto& way) { return way.param ? "Mapped" : "Staged"; });

/// A layer that is drawn, with a precision buffer behind what is read: its words move with every change.
TEST(VulkanRendererAsStore, DrawsLayersThatAreRefinedBetweenFrames) {
    RendererOptions options = small_options();
    options.gpu_budget_bytes = 256 << 10;
    const auto renderer = make_renderer(options);
    ASSERT_NE(renderer, nullptr);
    std::mt19937_64 random(3);
    const PrecisionShape shape = make_shape(random, 1500, 20, false);
    const auto values = random_words(random, shape);
    const std::vector<codec::atlas::ChartImage> charts = {test_chart(64, 64)};
    const uint64_t begin = joined(codec::atlas::encode_atlas(charts)).size();
    std::vector<TileDraw> tiles;
    for (int i = 0; i < 6; ++i) {
        tiles.push_back(upload_tile(*renderer, cube_tile({5 * i, 0, 0}, {5 * i + 4, 4, 4}), charts));
        ASSERT_TRUE(renderer->append(tiles.back().atlas, pack_precision(shape, values, 5)).ok());
    }
    const Camera camera = make_camera({12, -20, 9}, 0, -20);
    const FrameImage before = draw_or_fail(*renderer, camera, tiles);
    for (uint32_t level = 5; level < 17; level += 3) {
        for (const TileDraw& tile : tiles) {
            const auto planes = planes_between(shape, values, level, level + 3);
            const auto bytes = renderer->refine(tile.atlas, begin, planes, level + 3);
            ASSERT_TRUE(bytes.ok()) << bytes.error().text();
            EXPECT_EQ(*bytes, 4 * (begin + shape.words_at(level + 3)));
        }
        EXPECT_EQ(draw_or_fail(*renderer, camera, tiles).rgba, before.rgba) << level;
    }
    const uint64_t used = renderer->slots_used();
    // More levels than the renderer has slots for beside the old words.
    for (uint32_t level = 17; level < 20; ++level)
        ASSERT_TRUE(
            renderer->refine(tiles[0].atlas, begin, planes_between(shape, values, level, level + 1), level + 1));
    std::vector<LayerId> plugs;
    while (renderer->slots_used() < renderer->slot_count()) {
        plugs.push_back(renderer->create());
        ASSERT_TRUE(renderer->append(plugs.back(), std::vector<uint32_t>(1, 1)).ok());
    }
    EXPECT_FALSE(renderer->refine(tiles[1].atlas, begin, planes_between(shape, values, 17, 18), 18).ok());
    EXPECT_EQ(draw_or_fail(*renderer, camera, tiles).rgba, before.rgba);
    for (const LayerId plug : plugs) renderer->destroy(plug);
    EXPECT_GE(renderer->slots_used(), used);
    EXPECT_LE(renderer->gpu_bytes_allocated(), options.gpu_budget_bytes);
    EXPECT_EQ(renderer->validation_messages(), 0u);
}

}  // namespace
}  // namespace citystream::client::test
