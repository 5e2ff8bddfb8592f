// What a city shows of its images: metres a repeat from triangles and facades, and the size that follows.
#include "tiles/layers/image_uses.h"

#include "tests/tiles/layers/image_files.h"
#include "tiles/layers/texture_law.h"

namespace citystream::tiles::layers {
namespace {

using codec::atlas::ChartSize;

class ImageUses : public testing::Test {
  protected:
    void SetUp() override {
        auto spool = quadtree::ObjectSpool::create(folder_.path());
        ASSERT_TRUE(spool.ok());
        spool_ = std::move(spool).value();
        catalog_.images.resize(3);
    }
    uint32_t material(int32_t image, bool repeat = true, float metres_per_repeat = 0) {
        return catalog_.add_material({{1, 2, 3}, image, repeat, metres_per_repeat});
    }
    /// A wall of `width` x `height` metres with texture coordinates from (u, v) on.
    void wall(uint32_t material, double width, double height, double u0, double v0, double u1, double v1) {
        city::CityObject object;
        object.id = "wall";
        object.kind = city::ObjectKind::kBuilding;
        object.vertices = {{0, 0, 0}, {width, 0, 0}, {width, 0, height}, {0, 0, height}};
        city::Triangle triangle;
        triangle.material = material;
        triangle.vertex = {0, 1, 2};
        triangle.texcoord = {{{u0, v0}, {u1, v0}, {u1, v1}}};
        object.triangles.push_back(triangle);
        triangle.vertex = {0, 2, 3};
        triangle.texcoord = {{{u0, v0}, {u1, v1}, {u0, v1}}};
        object.triangles.push_back(triangle);
        ASSERT_TRUE(spool_->add(object, catalog_, report_));
    }
    std::vector<ImageUse> uses(uint32_t jobs = 2) {
        auto found = find_image_uses(*spool_, catalog_, jobs);
        EXPECT_TRUE(found.ok());
        return found ? *std::move(found) : std::vector<ImageUse>(3);
    }

    ImageFolder folder_;
    city::CityCatalog catalog_;
    city::CityReport report_;
    std::unique_ptr<quadtree::ObjectSpool> spool_;
};

TEST_F(ImageUses, TheLargestPatchOfAllWallsCounts) {
    const uint32_t m = material(1);
    wall(m, 8, 6, 0, 0, 4, 2);    // 2 x 3 m
    wall(m, 48, 48, 0, 0, 4, 6);  // 12 x 8 m: the thesis's quad
    const auto found = uses();
    EXPECT_FALSE(found[0].used());
    ASSERT_TRUE(found[1].used());
    EXPECT_NEAR(found[1].coverage.metres_u, 12, 1e-3);
    EXPECT_NEAR(found[1].coverage.metres_v, 8, 1e-3);
    EXPECT_NEAR(found[1].coverage.repeats, 8 + 24, 1e-3);
    EXPECT_FALSE(found[1].clamped);
    EXPECT_EQ(found[1].shown_share(), 1);
}

TEST_F(ImageUses, AShareOfAnImageIsNoMoreThanItsBoxAndItsArea) {
    wall(material(0, false), 10, 10, 0.25, 0, 0.75, 0.5);
    for (int i = 0; i < 3; ++i) wall(material(1, false), 10, 10, 0, 0, 0.5, 0.5);
    wall(material(2, false), 10, 10, -1, 0, 3, 0.5);
    const auto found = uses();
    EXPECT_NEAR(found[0].shown_share(), 0.25, 1e-4);
    EXPECT_NEAR(found[1].shown_share(), 0.25, 1e-4) << "shown three times, but the same part";
    EXPECT_NEAR(found[2].shown_share(), 0.5, 1e-4) << "clamped beyond its edges";
    EXPECT_TRUE(found[0].clamped);
}

TEST_F(ImageUses, MaterialsOfFacadesCountWhereTheirMapShowsThem) {
    codec::facade::FacadeMatrices wall;
    wall.width = wall.height = 4;
    wall.displacement_mm.assign(16, 0);
    wall.material.assign(16, 5);
    const auto grid = codec::facade::make_run_grid(wall);
    ASSERT_TRUE(grid.ok());
    const uint32_t map = catalog_.facade_maps.add(*grid, 0.5);
    city::FacadePalette palette;
    palette.material.fill(material(0, true, 7));
    palette.material[5] = material(2, true, 3);
    catalog_.palettes.push_back(palette);
    city::CityObject object;
    object.id = "house";
    object.kind = city::ObjectKind::kBuilding;
    object.facades.push_back({{0, 0, 0}, {2, 0}, 2, map, 0});
    ASSERT_TRUE(spool_->add(object, catalog_, report_));
    const auto found = uses();
    EXPECT_FALSE(found[0].used()) << "a slot that the map does not use";
    EXPECT_TRUE(found[2].on_facades);
    EXPECT_EQ(found[2].coverage.metres_u, 3);
    EXPECT_EQ(found[2].coverage.metres_v, 3);
    EXPECT_EQ(finest_size({1024, 1024}, found[2], kLeafTexel), (ChartSize{128, 128}))
        << "texels of 3 / 128 m, not of 3 / 256";
}

TEST_F(ImageUses, DoNotDependOnThreads) {
    for (int i = 0; i < 9000; ++i) wall(material(i % 3), 1 + 0.001 * i, 2 + 0.002 * i, 0, 0, 1.0 / (1 + i % 7), 1);
    const auto one = uses(1), many = uses(5);
    for (size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(one[i].coverage.repeats, many[i].coverage.repeats);
        EXPECT_EQ(one[i].coverage.metres_u, many[i].coverage.metres_u);
        EXPECT_EQ(one[i].coverage.polygons, 6000U);
    }
}

TEST_F(ImageUses, AWallThatShowsOnePointOfAnImageUsesIt) {
    wall(material(0), 4, 4, 0.5, 0.5, 0.5, 0.5);
    const auto found = uses();
    EXPECT_TRUE(found[0].used());
    EXPECT_EQ(finest_size({64, 32}, found[0], kLeafTexel), (ChartSize{64, 32})) << "nothing says how large it may be";
}

TEST(FinestSize, HalvesEachAxisWhileItIsFinerThanAnyTileShows) {
    ImageUse use;
    use.coverage = {20, 15, 1, 1, 1, 1, 0};
    // Texels of 20 / 1500 m are the finest that tiles show.
    EXPECT_EQ(finest_size({1500, 1125}, use, kLeafTexel), (ChartSize{1500, 1125}));
    EXPECT_EQ(finest_size({1501, 1126}, use, kLeafTexel), (ChartSize{750, 563}));
    EXPECT_EQ(finest_size({6004, 100}, use, kLeafTexel), (ChartSize{750, 100}));
    EXPECT_EQ(finest_size({1, 1}, use, kLeafTexel), (ChartSize{1, 1}));
    use.coverage.metres_u = 1e6;
    EXPECT_EQ(finest_size({16384, 8193}, use, kLeafTexel), (ChartSize{8192, 1024}));
    use.coverage.metres_u = 1e-9;
    EXPECT_EQ(finest_size({16384, 8193}, use, kLeafTexel), (ChartSize{1, 1024}));
}

TEST(FinestSize, NeverEnlargesAnAxisAndStaysByTheTexelWanted) {
    uint32_t seed = 11;
    const auto random = [&seed](uint32_t most) {
        seed = seed * 1664525U + 1013904223U;
        return 1 + static_cast<uint32_t>(uint64_t{seed} * most >> 32);
    };
    for (int i = 0; i < 10'000; ++i) {
        const ChartSize image{random(1U << random(15)), random(1U << random(15))};
        const double texel = 0.001 * random(5000);
        ImageUse use;
        use.coverage = {0.01 * random(100'000), 0.01 * random(100'000), 1, 1, 1, 1, 0};
        const ChartSize size = finest_size(image, use, texel), view = view_size(image, use.coverage, texel);
        for (const auto& [side, matched, viewed] :
             {std::array{image.width, size.width, view.width}, std::array{image.height, size.height, view.height}}) {
            ASSERT_TRUE(matched >= 1 && matched <= std::min(side, 8192U)) << side;
            ASSERT_LE(matched, kFinestShare * (viewed + 1)) << side << " at " << texel;
            if (viewed < 4096) {
                ASSERT_GE(matched + 1, std::min<double>(side, kFinestShare / 2 * viewed)) << side << " at " << texel;
            }
        }
    }
}

}  // namespace
}  // namespace citystream::tiles::layers
