// Cities whose atlases are in pages, from the builder to the readers.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>

#include "codec/atlas/page_layer.h"
#include "codec/chart_word.h"
#include "codec/mesh/mesh_layer.h"
#include "tests/tiles/layers/city_builds.h"
#include "tiles/layers/inspect_city.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::tiles::layers {
namespace {

using codec::atlas::AtlasForm;
using tileset::Layer;
using tileset::TileAddress;
using tileset::TileRecord;

class BuildPages : public CityBuildTest {
  protected:
    BuildOptions usual_options() const override {
        BuildOptions options = CityBuildTest::usual_options();
        options.leaf_triangles = 300;
        options.atlas_form = AtlasForm::kPages;
        options.shared_charts = false;
        options.rate_distortion = 0;  // faster
        return options;
    }
};

/// Every tile's atlas.
std::map<TileAddress, LayerWords> atlases_of(const OpenCity& city) {
    std::map<TileAddress, LayerWords> atlases;
    for (const auto& [address, record] : city.tiles) {
        if (!record.steps(Layer::kAtlas).empty()) atlases[address] = layer_words(city, record, Layer::kAtlas);
    }
    return atlases;
}

TEST_F(BuildPages, EveryAtlasIsInPagesOfTheMipsAskedForAndTheArchiveSaysSo) {
    for (const uint32_t mips : {0U, 2U}) {
        const auto built =
            build("city.3tz", generated(10), [mips](BuildOptions& options) { options.page_mips = mips; });
        ASSERT_TRUE(built.ok()) << built.error().text();
        EXPECT_TRUE(built->manifest.pages_or_alpha);
        const auto atlases = atlases_of(open_city(path("city.3tz")));
        EXPECT_GT(atlases.size(), 4U);
        for (const auto& [address, atlas] : atlases) {
            const auto view = codec::atlas::PageLayerView::create(atlas.words, atlas.step_words);
            ASSERT_TRUE(view.ok()) << view.error().text();
            EXPECT_EQ(view->mips(), mips);
            EXPECT_EQ(atlas.step_words.size(), view->page_count() == 0 ? 1 : mips + 1);
        }
        const auto damages = verify_city(path("city.3tz"));
        ASSERT_TRUE(damages.ok());
        EXPECT_EQ(*damages, std::vector<std::string>());
        EXPECT_NE(built->manifest.build_options.find("atlas-form=pages page-mips=" + std::to_string(mips)),
                  std::string::npos);
    }
}

TEST_F(BuildPages, BytesDoNotDependOnThreads) {
    ASSERT_TRUE(build("two.3tz", generated(8), [](BuildOptions& options) { options.jobs = 2; }).ok());
    ASSERT_TRUE(build("one.3tz", generated(8), [](BuildOptions& options) { options.jobs = 1; }).ok());
    EXPECT_EQ(bytes_of("one.3tz"), bytes_of("two.3tz"));
}

TEST_F(BuildPages, InfoSaysWhatThePagesHold) {
    const auto built = build("city.3tz", generated(4));
    ASSERT_TRUE(built.ok());
    const auto info = read_city_info(path("city.3tz"));
    ASSERT_TRUE(info.ok());
    const auto& pages = (*info)["atlas_pages"];
    EXPECT_EQ(pages["tiles"], built->manifest.tiles);
    EXPECT_EQ(pages["tiles_of_charts"], 0);
    EXPECT_EQ(pages["mips"], (nlohmann::json{{std::to_string(*BuildOptions().page_mips), built->manifest.tiles}}));
    EXPECT_GE(pages["pages"], 1);
    EXPECT_EQ(pages["flat_charts"], 0) << "meshes name colours themselves";
    EXPECT_GT(pages["border_percent"], 1.0);
    EXPECT_GT(pages["fill_percent"], 80.0);
    EXPECT_LE(pages["fill_percent"], 100.0);
    uint64_t texels = 0;
    for (const auto& [address, atlas] : atlases_of(open_city(path("city.3tz")))) {
        const auto view = codec::atlas::PageLayerView::create(atlas.words, atlas.step_words).value();
        for (uint32_t page = 0; page < view.page_count(); ++page)
            texels += uint64_t{view.width(page)} * view.height(page);
    }
    EXPECT_EQ(pages["texels"], texels);
    ASSERT_TRUE(
        build("charts.3tz", generated(2), [](BuildOptions& options) { options.atlas_form = AtlasForm::kCharts; }).ok());
    EXPECT_FALSE(read_city_info(path("charts.3tz"))->contains("atlas_pages"));
}

TEST_F(BuildPages, EveryTexelOfPagesThatArePowersOfTwoIsAChartsWhateverTheThreads) {
    const auto built = [&](const std::string& name, uint32_t jobs) {
        return build(name, generated(8), [jobs](BuildOptions& options) {
            options.page_shape = codec::atlas::PageShape::kPowerOfTwo;
            options.jobs = jobs;
        });
    };
    const auto two = built("two.3tz", 2);
    ASSERT_TRUE(two.ok()) << two.error().text();
    ASSERT_TRUE(built("one.3tz", 1).ok());
    EXPECT_EQ(bytes_of("one.3tz"), bytes_of("two.3tz"));
    EXPECT_NE(two->manifest.build_options.find(" page-shape=power-of-two"), std::string::npos);
    EXPECT_EQ(*verify_city(path("two.3tz")), std::vector<std::string>());
    const auto pages = (*read_city_info(path("two.3tz")))["atlas_pages"];
    EXPECT_GT(pages["texels"], 100'000);
    EXPECT_EQ(pages["fill_percent"], 100.0);
    ASSERT_TRUE(build("tight.3tz", generated(8)).ok());
    EXPECT_LT((*read_city_info(path("tight.3tz")))["atlas_pages"]["fill_percent"], 100.0) << "the test is too easy";
}

/// A wall of 120 x 3.75 m that shows an image of 4096 x 128 texels once, and one far from it.
CitySource long_walls(const std::string& image) {
    return [image](city::CityHeader&, city::CityCatalog& catalog, city::CityReport& report,
                   const city::CitySink& sink) -> Status {
        catalog.images.push_back({.path = image});
        city::Material material;
        material.image = 0;
        const uint32_t number = catalog.add_material(material);
        for (const double y : {4.0, 120.0}) {
            ++report.buildings_emitted;
            if (!sink(image_wall("wall at " + std::to_string(y), {4, y}, 120, 3.75, number))) break;
        }
        return Done{};
    };
}

TEST_F(BuildPages, InnerTilesStateTheBlurOfChartsThatPagesShrink) {
    const std::string image = folder_.write("long.png", 4096, 128, 3, noise(size_t{3} * 4096 * 128, 5));
    const auto root_errors = [&](AtlasForm form) {
        const auto built = build("city.3tz", long_walls(image), [form](BuildOptions& options) {
            options.atlas_form = form;
            options.leaf_triangles = 1;
        });
        EXPECT_TRUE(built.ok());
        const OpenCity city = open_city(path("city.3tz"));
        const TileRecord& root = city.tiles.at({});
        EXPECT_TRUE(has_children(city, {}));
        return std::array{root.geometric_error, root.steps(Layer::kAtlas).back().error};
    };
    const auto charts = root_errors(AtlasForm::kCharts), pages = root_errors(AtlasForm::kPages);
    EXPECT_LT(charts[1], 0.13F);
    const auto texel = static_cast<float>(120.0 / codec::atlas::longest_page_chart(*BuildOptions().page_mips));
    EXPECT_NEAR(pages[1], texel, 0.001F * texel);
    EXPECT_GE(pages[0], pages[1] * 0.999F) << "what its pictures are blurred by counts as error";
}

TEST_F(BuildPages, TilesWithAlphaStayInCharts) {
    std::vector<uint8_t> rgba = noise(size_t{4} * 64 * 64, 9);
    for (size_t i = 3; i < rgba.size(); i += 4) rgba[i] = i < rgba.size() / 2 ? 0 : 255;
    const auto built = build("city.3tz", long_walls(folder_.write("leaves.png", 64, 64, 4, rgba)),
                             [](BuildOptions& options) { options.leaf_triangles = 1; });
    ASSERT_TRUE(built.ok()) << built.error().text();
    EXPECT_TRUE(built->manifest.pages_or_alpha);
    size_t in_charts = 0;
    for (const auto& [address, atlas] : atlases_of(open_city(path("city.3tz")))) {
        const auto facts = codec::atlas::check_atlas(atlas.words, atlas.step_words);
        ASSERT_TRUE(facts.ok()) << facts.error().text();
        in_charts += facts->form == AtlasForm::kCharts ? 1 : 0;
    }
    EXPECT_GE(in_charts, 2U);
    EXPECT_EQ((*read_city_info(path("city.3tz")))["atlas_pages"]["tiles_of_charts"], in_charts);
    EXPECT_EQ(built->tiles_kept_in_charts, in_charts);
    const auto solid = build("solid.3tz", generated(4));
    ASSERT_TRUE(solid.ok());
    EXPECT_EQ(solid->tiles_kept_in_charts, 0U);
}

TEST_F(BuildPages, MipsThatWouldEnlargeSmallChartsAreLeftOut) {
    const auto built = build("city.3tz", generated(3), [](BuildOptions& options) { options.page_mips = 7; });
    ASSERT_TRUE(built.ok()) << built.error().text();
    const auto info = read_city_info(path("city.3tz"));
    ASSERT_TRUE(info.ok());
    EXPECT_FALSE((*info)["atlas_pages"]["mips"].contains("7")) << "of at least 384 texels a side each";
    ASSERT_TRUE(build("three.3tz", generated(3), [](BuildOptions& options) { options.page_mips = 3; }).ok());
    const auto usual = read_city_info(path("three.3tz"));
    ASSERT_TRUE(usual.ok());
    EXPECT_LT((*info)["atlas_pages"]["texels"], 4 * (*usual)["atlas_pages"]["texels"].get<uint64_t>());
}

TEST_F(BuildPages, EveryPlaceIsOneThatAPackedCoordinateHolds) {
    ASSERT_TRUE(build("city.3tz", generated(10)).ok());
    const OpenCity city = open_city(path("city.3tz"));
    size_t shown = 0;
    for (const auto& [address, record] : city.tiles) {
        const LayerWords atlas = layer_words(city, record, Layer::kAtlas);
        if (atlas.words.empty()) continue;
        const codec::mesh::MeshTile mesh = mesh_of(city, record);
        for (size_t corner = 0; corner < mesh.indices.size(); ++corner) {
            if (codec::names_colour(mesh.triangle_chart[corner / 3])) continue;
            for (const int32_t place : mesh.vertices[mesh.indices[corner]].texcoord) {
                ASSERT_EQ(place % 128, 0) << "1/512 repeat";
                ASSERT_GE(place, 0);
                ASSERT_LT(place, 64 << 16);
            }
            ++shown;
        }
    }
    EXPECT_GT(shown, 1000U);
}

TEST_F(BuildPages, SharingAndTooManyMipsAreRefused) {
    const auto shared = build("city.3tz", generated(5), [](BuildOptions& options) { options.shared_charts = true; });
    ASSERT_FALSE(shared.ok());
    EXPECT_NE(shared.error().text().find("share"), std::string::npos);
    const auto mips = build("city.3tz", generated(5), [](BuildOptions& options) { options.page_mips = 8; });
    ASSERT_FALSE(mips.ok());
    EXPECT_NE(mips.error().text().find("8 mips"), std::string::npos);
    const auto law = build("city.3tz", generated(5), [](BuildOptions& options) {
        options.page_mips.reset();
        options.texture_law = *parse_texture_law("0.02");
    });
    ASSERT_FALSE(law.ok());
    EXPECT_NE(law.error().text().find("without levels"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(path("city.3tz")));
}

}  // namespace
}  // namespace citystream::tiles::layers
