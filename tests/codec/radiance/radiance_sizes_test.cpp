// The table of sizes: dense is most, and on a city bits travel best and biclusters work least.
#include "codec/radiance/radiance_sizes.h"

#include <gtest/gtest.h>

#include "tests/codec/radiance/radiance_scenes.h"

namespace citystream::codec::radiance {
namespace {

TEST(RadianceSizes, RankTheFormsOfACity) {
    const VisibilityTile city = first_receivers(TowerCity().visibility(16, 16), 500);
    const auto sizes = representation_sizes(city, LocalDirections(8), BiclusterGoal::kBytes);
    ASSERT_EQ(sizes.size(), 6u);
    const RepresentationSize &dense = sizes[0], &csr = sizes[1], &rows = sizes[2], &paper = sizes[3], &few = sizes[4],
                             &bits = sizes[5];
    EXPECT_EQ(dense.memory_bytes, 500u * 64 * texel_count(16));
    EXPECT_LT(csr.memory_bytes, dense.memory_bytes / 50);
    EXPECT_LT(rows.memory_bytes, csr.memory_bytes);
    EXPECT_LT(few.memory_bytes, paper.memory_bytes);
    EXPECT_LT(rows.wire_bytes, csr.wire_bytes);
    EXPECT_LT(paper.wire_bytes, csr.wire_bytes);
    EXPECT_LT(2 * bits.wire_bytes, paper.wire_bytes);
    EXPECT_LT(rows.flops, csr.flops);
    EXPECT_LT(few.flops, rows.flops);
    EXPECT_LT(few.flops, paper.flops);
    EXPECT_LT(5 * few.flops, csr.flops);
}

}  // namespace
}  // namespace citystream::codec::radiance
