// The light passes on the GPU against the CPU's irradiance, word for word, and what they do when.
#include "client/render/radiance_passes.h"

#include <random>

#include "codec/radiance/irradiance.h"
#include "codec/radiance/local_directions.h"
#include "codec/radiance/radiance_resident_layout.h"
#include "tests/client/render/gpu_twin.h"
#include "tests/codec/radiance/lattice_scene.h"

namespace citystream::client::test {
namespace {

using namespace codec::radiance;

using Words = std::vector<uint32_t>;

FrameLight light_of(const std::vector<Rgb>& radiance, uint32_t side, uint64_t number) {
    FrameLight light;
    light.number = number;
    light.texels_across = side;
    light.sky = whole_light(weighted_light(radiance, side));
    return light;
}

FrameLight random_light(uint32_t side, uint64_t number, float greatest = 1) {
    std::mt19937_64 random(number);
    std::vector<Rgb> radiance(texel_count(side));
    for (Rgb& texel : radiance) {
        for (float& v : texel) v = static_cast<float>(random() % 1000) / 1000 * (random() % 100 == 0 ? greatest : 1);
    }
    return light_of(radiance, side, number);
}

/// Words of a small city.
Words city_words(uint32_t side, uint32_t local_side, MatrixForm form, uint64_t seed = 7, size_t steps = 3) {
    const RadianceTile tile = LatticeScene::towers(32, 2, seed).tile(32, 12, side);
    const auto layer = encode_radiance_layer(tile, local_side, 1);
    EXPECT_TRUE(layer.ok());
    const LayerPrefix prefix(*layer, steps);
    auto words = decode_radiance_layer(prefix.steps, prefix.decoded_bytes, form);
    EXPECT_TRUE(words.ok());
    return std::move(*words);
}

/// The words after the passes, by the CPU.
Words lit_by_cpu(Words words, const FrameLight& light) {
    const auto view = RadianceLayerView::create(words);
    const Words irradiance = irradiance_words(*view, light.sky);
    std::copy(irradiance.begin(), irradiance.end(), words.begin() + view->irradiance_word());
    return words;
}

class RadiancePassesTest : public GpuTwin {
  protected:
    Words words_now(LayerId layer) { return read_words(pool_, layer, pool_.layers[layer].words); }

    /// A frame of these layers.
    void light_up(RadiancePasses& passes, const std::vector<LayerId>& layers) {
        ASSERT_TRUE(passes.plan(layers).ok());
        submit_and_wait(device_, [&](VkCommandBuffer commands) { passes.record(commands); });
        passes.finish();
    }
};

TEST_F(RadiancePassesTest, GiveTheWordsOfTheCpu) {
    RadiancePasses passes(device_, pool_);
    const FrameLight light = random_light(8, 1, 1e6F);
    passes.set_light(light);
    EXPECT_EQ(passes.irradiance_unit(), irradiance_unit(light.sky));
    std::vector<LayerId> layers;
    std::vector<Words> expected;
    for (const uint32_t local_side : {1u, 4u, 8u}) {
        for (const MatrixForm form : {MatrixForm::kBiclusters, MatrixForm::kRows}) {
            for (const bool scattered : {false, true}) {
                const Words words = city_words(8, local_side, form, local_side, scattered ? 3 : 1);
                layers.push_back(upload_words(words, scattered));
                expected.push_back(lit_by_cpu(words, light));
            }
        }
    }
    light_up(passes, layers);
    for (size_t i = 0; i < layers.size(); ++i) EXPECT_EQ(words_now(layers[i]), expected[i]) << i;
    EXPECT_EQ(passes.counts().tiles, layers.size());
    EXPECT_EQ(passes.counts().batches, 1u);
    EXPECT_EQ(passes.counts().unlit, 0u);
}

TEST_F(RadiancePassesTest, GiveTheSameWordsInEveryRun) {
    RadiancePasses passes(device_, pool_);
    const Words words = city_words(8, 8, MatrixForm::kBiclusters);
    const LayerId layer = upload_words(words, true);
    Words first;
    for (uint64_t run = 0; run < 100; ++run) {
        FrameLight light = random_light(8, 3);
        light.number = run;
        passes.set_light(light);
        light_up(passes, {layer});
        ASSERT_EQ(passes.counts().tiles, 1u);
        if (run == 0) first = words_now(layer);
        ASSERT_EQ(words_now(layer), first) << run;
    }
}

TEST_F(RadiancePassesTest, RunWhenTheLightOrTheWordsAreNewAndNotOtherwise) {
    RadiancePasses passes(device_, pool_);
    const LayerId a = upload_words(city_words(4, 4, MatrixForm::kBiclusters), false);
    light_up(passes, {a});
    EXPECT_EQ(passes.counts().tiles, 0u) << "there is no light";
    EXPECT_FALSE(passes.has_pipeline());
    EXPECT_EQ(passes.buffer_bytes(), 0u);
    passes.set_light(random_light(4, 1));
    light_up(passes, {});
    EXPECT_FALSE(passes.has_pipeline()) << "there is nothing to be lit";
    EXPECT_EQ(passes.buffer_bytes(), 0u);
    light_up(passes, {a});
    EXPECT_EQ(passes.counts().tiles, 1u);
    EXPECT_GT(passes.counts().receivers, 0u);
    EXPECT_GT(passes.counts().clusters, 0u);
    EXPECT_GT(passes.counts().rows, 0u);
    EXPECT_GT(passes.buffer_bytes(), 0u);
    const uint64_t bytes = passes.buffer_bytes();
    light_up(passes, {a});
    EXPECT_EQ(passes.counts().tiles, 0u) << "only the view changed";
    passes.set_light(random_light(4, 1));
    light_up(passes, {a});
    EXPECT_EQ(passes.counts().tiles, 0u) << "the light has the same number";
    const LayerId b = upload_words(city_words(4, 4, MatrixForm::kRows, 2), true);
    light_up(passes, {a, b});
    EXPECT_EQ(passes.counts().tiles, 1u) << "one tile is new";
    passes.set_light(random_light(4, 2));
    light_up(passes, {a, b});
    EXPECT_EQ(passes.counts().tiles, 2u) << "the light changed";
    EXPECT_LE(passes.buffer_bytes(), 4 * bytes);
}

TEST_F(RadiancePassesTest, LightALayerAnewWhoseWordsWereReplaced) {
    RadiancePasses passes(device_, pool_);
    const FrameLight light = random_light(8, 1);
    passes.set_light(light);
    const LayerId coarse = upload_words(city_words(8, 4, MatrixForm::kBiclusters, 7, 1), false);
    light_up(passes, {coarse});
    passes.forget(coarse);
    destroy_layer(pool_, coarse);
    const Words words = city_words(8, 4, MatrixForm::kBiclusters, 7, 3);
    const LayerId fine = upload_words(words, false);
    EXPECT_EQ(fine, coarse) << "numbers are given again";
    light_up(passes, {fine});
    EXPECT_EQ(words_now(fine), lit_by_cpu(words, light));
    EXPECT_FALSE(passes.plan(std::vector<LayerId>{fine + 100}).ok());
}

TEST_F(RadiancePassesTest, GoInBatchesOfABoundedBufferAndLargeTilesAlone) {
    const FrameLight light = random_light(8, 5);
    std::vector<Words> words;
    for (uint64_t seed = 0; seed < 5; ++seed)
        words.push_back(city_words(8, seed == 3 ? 8 : 2, MatrixForm::kBiclusters, seed));
    const uint64_t sums = [&] {
        RadiancePasses all(device_, pool_);
        all.set_light(light);
        light_up(all, {upload_words(words[0], false)});
        return all.counts().clusters + all.counts().rows;
    }();
    RadiancePasses passes(device_, pool_, sizeof(uint32_t) * RADIANCE_SUM_WORDS * sums * 5 / 2);
    passes.set_light(light);
    std::vector<LayerId> layers;
    for (const Words& some : words) layers.push_back(upload_words(some, true));
    light_up(passes, layers);
    EXPECT_GE(passes.counts().batches, 3u);
    EXPECT_LT(passes.counts().batches, 5u);
    for (size_t i = 0; i < layers.size(); ++i) EXPECT_EQ(words_now(layers[i]), lit_by_cpu(words[i], light)) << i;
}

TEST_F(RadiancePassesTest, LeaveTilesUnlitThatAreNotForTheLight) {
    RadiancePasses passes(device_, pool_);
    const Words small = city_words(4, 4, MatrixForm::kBiclusters), large = city_words(8, 4, MatrixForm::kBiclusters);
    const LayerId a = upload_words(small, false), b = upload_words(large, false);
    passes.set_light(random_light(8, 1));
    light_up(passes, {a, b});
    EXPECT_EQ(passes.counts().unlit, 1u);
    EXPECT_EQ(passes.counts().tiles, 1u);
    EXPECT_EQ(words_now(a), small);
    EXPECT_NE(words_now(b), large);
    passes.set_light(random_light(4, 2));
    light_up(passes, {a});
    EXPECT_EQ(passes.counts().unlit, 0u);
    EXPECT_NE(words_now(a), small);
}

TEST_F(RadiancePassesTest, TouchNothingOutsideLayersWithAnyContent) {
    const Words good = city_words(4, 4, MatrixForm::kBiclusters);
    const auto shape = radiance_layer_shape(good, good.size());
    std::mt19937_64 random(9);
    RadiancePasses passes(device_, pool_);
    passes.set_light(random_light(4, 1));
    uint64_t lit = 0;
    for (int i = 0; i < 40; ++i) {
        Words words = good;
        // Headers with a few wrong bits, or right ones before noise.
        const uint32_t content = shape->matrix_word + RADIANCE_HEADER_WORDS;
        if (i % 2 == 0) {
            words[i % 4 == 0 ? random() % RECEIVER_WORD_CLASSES : shape->matrix_word + random() % 15] ^=
                1u << random() % 32;
        } else {
            for (size_t w = content; w < words.size(); ++w) words[w] = static_cast<uint32_t>(random());
        }
        const LayerId before = upload_words(good, false);
        const LayerId layer = upload_words(words, i % 3 == 0);
        const LayerId after = upload_words(good, false);
        light_up(passes, {layer});
        lit += passes.counts().tiles;
        EXPECT_EQ(words_now(before), good);
        EXPECT_EQ(words_now(after), good);
        const Words now = words_now(layer);
        EXPECT_TRUE(std::equal(now.begin() + shape->matrix_word, now.end(), words.begin() + shape->matrix_word));
        for (const LayerId some : {before, layer, after}) {
            passes.forget(some);
            destroy_layer(pool_, some);
        }
    }
    EXPECT_GE(lit, 20u) << "content is bounded, not checked";
}

TEST_F(RadiancePassesTest, LightNothingInDarknessAndNoTileWithoutReceivers) {
    RadianceTile none;
    none.spacing_log2 = 12;
    none.visibility.side = 4;
    const auto steps = encode_radiance_layer(none, 4, 1);
    const LayerPrefix prefix(*steps, 3);
    const Words empty = *decode_radiance_layer(prefix.steps, prefix.decoded_bytes, MatrixForm::kBiclusters);
    const Words city = city_words(4, 4, MatrixForm::kBiclusters);
    RadiancePasses passes(device_, pool_);
    const FrameLight dark = light_of(std::vector<Rgb>(texel_count(4), {0, 0, 0}), 4, 1);
    passes.set_light(dark);
    const LayerId a = upload_words(empty, false), b = upload_words(city, false);
    light_up(passes, {a, b});
    EXPECT_EQ(words_now(a), empty);
    EXPECT_EQ(words_now(b), lit_by_cpu(city, dark));
}

}  // namespace
}  // namespace citystream::client::test
