// Decoding that is given up from outside.
#include "codec/stop.h"

#include <gtest/gtest.h>

#include <atomic>

#include "codec/radiance/bicluster.h"
#include "codec/radiance/radiance_layer.h"
#include "tests/codec/radiance/lattice_scene.h"

namespace citystream::codec::radiance {
namespace {

TEST(Stop, ALayerIsDecodedToTheSameWordsOrNotAtAll) {
    const auto steps = encode_radiance_layer(LatticeScene::towers(32, 2, 7).tile(32, 12, 8), 4, 1);
    ASSERT_TRUE(steps.ok());
    const LayerPrefix prefix(*steps, steps->size());
    const std::atomic<bool> running = false, stopped = true;
    for (const MatrixForm form : {MatrixForm::kRows, MatrixForm::kBiclusters}) {
        for (const double error : {0.0, 0.1}) {
            const auto plain = decode_radiance_layer(prefix.steps, prefix.decoded_bytes, {form, error});
            const auto watched = decode_radiance_layer(prefix.steps, prefix.decoded_bytes, {form, error, &running});
            const auto given_up = decode_radiance_layer(prefix.steps, prefix.decoded_bytes, {form, error, &stopped});
            ASSERT_TRUE(plain.ok() && watched.ok());
            EXPECT_EQ(*plain, *watched);
            ASSERT_FALSE(given_up.ok());
            EXPECT_EQ(given_up.error().message, stopped_error().message);
        }
    }
}

TEST(Stop, ASearchThatIsStoppedFindsNoClusters) {
    const Transfer transfer{3, {0, 2, 4}, {0, 1, 0, 1}, {4, 4, 4, 4}};
    const std::atomic<bool> running = false, stopped = true;
    BiclusterOptions options;
    options.stop = &running;
    EXPECT_EQ(find_biclusters(transfer, options), find_biclusters(transfer, {}));
    EXPECT_GT(find_biclusters(transfer, options).count(), 0U);
    options.stop = &stopped;
    EXPECT_EQ(find_biclusters(transfer, options).count(), 0U);
}

}  // namespace
}  // namespace citystream::codec::radiance
