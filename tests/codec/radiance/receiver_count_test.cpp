// How many receivers a layer's first step tells of, without decoding what they see.
#include <gtest/gtest.h>

#include <algorithm>

#include "codec/radiance/radiance_layer.h"
#include "tests/codec/radiance/lattice_scene.h"

namespace citystream::codec::radiance {
namespace {

RadianceLayerStep first_step(const RadianceTile& tile) {
    auto steps = encode_radiance_layer(tile, 4, 7);
    EXPECT_TRUE(steps.ok()) << steps.error().text();
    return std::move(steps->front());
}

TEST(ReceiverCount, IsThatOfTheTile) {
    const RadianceTile city = LatticeScene::towers(32, 2, 7).tile(32, 12, 4), field = LatticeScene({}).tile(8, 12, 4);
    RadianceTile none;
    none.spacing_log2 = 12;
    none.visibility.side = 4;
    for (const RadianceTile& tile : {city, field, none}) {
        const RadianceLayerStep step = first_step(tile);
        const auto count = read_receiver_count(step.wire, step.decoded_bytes);
        ASSERT_TRUE(count.ok()) << count.error().text();
        EXPECT_EQ(*count, tile.places.size());
    }
    EXPECT_GT(city.places.size(), field.places.size());
}

TEST(ReceiverCount, OfOtherBytesIsAnErrorOrNoMoreThanHaveRoom) {
    const RadianceLayerStep step = first_step(LatticeScene({}).tile(8, 12, 4));
    EXPECT_FALSE(read_receiver_count({}, step.decoded_bytes));
    EXPECT_FALSE(read_receiver_count(std::span(step.wire).first(13), step.decoded_bytes)) << "shorter than its head";
    EXPECT_FALSE(read_receiver_count(step.wire, 0)) << "no room for the receivers";
    for (size_t at = 0; at < step.wire.size(); ++at) {
        std::vector<std::byte> wire = step.wire;
        wire[at] ^= std::byte{0x55};
        const auto count = read_receiver_count(wire, step.decoded_bytes);
        EXPECT_TRUE(!count.ok() || *count <= step.decoded_bytes / sizeof(uint32_t)) << at;
    }
}

}  // namespace
}  // namespace citystream::codec::radiance
