// A tile with its occluders for tests of what is baked.
#pragma once

#include <gtest/gtest.h>

#include <utility>

#include "tests/tiles/radiance/box_city.h"
#include "tiles/radiance/occluder_scene.h"

namespace citystream::tiles::radiance::test {

/// Around the ground of a tile at the origin, with 16 m to spare.
inline constexpr StartBox kTile = {{-(1 << 14), -(1 << 14), -(1 << 14)},
                                   {144 << kGridBits, 144 << kGridBits, 100 << kGridBits}};

/// Without horizon.
inline OccluderScene scene_of(const Surface& surface) {
    auto scene = OccluderScene::create(surface, nullptr, kTile);
    EXPECT_TRUE(scene);
    return std::move(*scene);
}

}  // namespace citystream::tiles::radiance::test
