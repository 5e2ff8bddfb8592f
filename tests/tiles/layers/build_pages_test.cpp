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
#include "codec/step_wire.h"
#include "tests/tiles/layers/image_files.h"
#include "tiles/archive/archive.h"
#include "tiles/city/generator.h"
#include "tiles/layers/build_city.h"
#include "tiles/layers/inspect_city.h"
#include "tiles/tileset/subtree.h"
#include "tiles/tileset/tileset_json.h"

namespace citystream::tiles::layers {
namespace {

using codec::atlas::AtlasForm;
using tileset::Layer;
using tileset::TileAddress;
using tileset::TileRecord;

class BuildPages : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = (std::filesystem::temp_directory_path() / "citystream-pages-test-XXXXXX").string();
        ASSERT_NE(mkdtemp(pattern.data()), nullptr);
        folder_ = pattern;
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string path(const std::string& name) const { return (folder_ / name).string(); }

    Result<BuildSummary> build(const std::string& name, const CitySource& source,
                               const std::function<void(BuildOptions&)>& change = {}) {
        BuildOptions options;
        options.output = path(name);
        options.jobs = 2;
        options.leaf_triangles = 300;
        options.atlas_form = AtlasForm::kPages;
        options.shared_charts = false;
        options.rate_distortion = 0;  // faster
        if (change) change(options);
        city::CityReport report;
        return build_city(options, source, report);
    }

    std::string bytes_of(const std::string& name) const {
        std::ifstream file(path(name), std::ios::binary);
        return {(std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>()};
    }

    std::filesystem::path folder_;
    ImageFolder images_;
};

CitySource generated(uint32_t buildings) {
    return [buildings](city::CityHeader& header, city::CityCatalog& catalog, city::CityReport& report,
                       const city::CitySink& sink) -> Status {
        city::GeneratorOptions options;
        options.buildings = buildings;
        options.seed = 3;
        city::generate_city(options, header, catalog, report, sink);
        return Done{};
    };
}

struct OpenTile {
    TileRecord record;
    std::vector<uint32_t> words, step_words;  ///< of the atlas; none: it has none
    bool has_children = false;
};

/// Every tile of an archive with its atlas decoded.
std::map<TileAddress, OpenTile> tiles_of(const std::string& path) {
    std::map<TileAddress, OpenTile> tiles;
    const auto reader = archive::ArchiveReader::open(path).value();
    const auto manifest = tileset::parse_tileset_json(reader->find(tileset::kTilesetPath)).value();
    std::deque<TileAddress> open = {TileAddress{}};
    for (; !open.empty(); open.pop_front()) {
        const auto subtree =
            tileset::parse_subtree(reader->find(tileset::subtree_path(open.front())), open.front(), manifest).value();
        for (const TileRecord& record : subtree.tiles) {
            OpenTile& tile = tiles[record.address];
            tile.record = record;
            uint64_t begin = 0;
            const auto bytes = reader->find(tileset::layer_path(Layer::kAtlas, record.address));
            for (const auto& step : record.steps(Layer::kAtlas)) {
                const auto words =
                    codec::decode_step(bytes.subspan(begin, step.end - begin), step.decoded_bytes).value();
                tile.words.insert(tile.words.end(), words.begin(), words.end());
                tile.step_words.push_back(static_cast<uint32_t>(words.size()));
                begin = step.end;
            }
        }
        open.insert(open.end(), subtree.child_subtrees.begin(), subtree.child_subtrees.end());
    }
    for (const auto& [address, tile] : tiles) {
        if (address.level > 0) tiles[address.parent()].has_children = true;
    }
    return tiles;
}

TEST_F(BuildPages, EveryAtlasIsInPagesOfTheMipsAskedForAndTheArchiveSaysVersionFive) {
    for (const uint32_t mips : {0U, 2U}) {
        const auto built =
            build("city.3tz", generated(10), [mips](BuildOptions& options) { options.page_mips = mips; });
        ASSERT_TRUE(built.ok()) << built.error().text();
        EXPECT_TRUE(built->manifest.needs_version_5);
        const auto tiles = tiles_of(path("city.3tz"));
        EXPECT_GT(tiles.size(), 4U);
        for (const auto& [address, tile] : tiles) {
            const auto view = codec::atlas::PageLayerView::create(tile.words, tile.step_words);
            ASSERT_TRUE(view.ok()) << view.error().text();
            EXPECT_EQ(view->mips(), mips);
            EXPECT_EQ(tile.step_words.size(), view->page_count() == 0 ? 1 : mips + 1);
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
    EXPECT_EQ(pages["mips"], (nlohmann::json{{std::to_string(BuildOptions().page_mips), built->manifest.tiles}}));
    EXPECT_GE(pages["pages"], 1);
    EXPECT_GT(pages["flat_charts"], 0);
    EXPECT_GT(pages["border_percent"], 1.0);
    EXPECT_GT(pages["fill_percent"], 80.0);
    EXPECT_LE(pages["fill_percent"], 100.0);
    uint64_t texels = 0;
    for (const auto& [address, tile] : tiles_of(path("city.3tz"))) {
        const auto view = codec::atlas::PageLayerView::create(tile.words, tile.step_words).value();
        for (uint32_t page = 0; page < view.page_count(); ++page)
            texels += uint64_t{view.width(page)} * view.height(page);
    }
    EXPECT_EQ(pages["texels"], texels);
    ASSERT_TRUE(
        build("charts.3tz", generated(2), [](BuildOptions& options) { options.atlas_form = AtlasForm::kCharts; }).ok());
    EXPECT_FALSE(read_city_info(path("charts.3tz"))->contains("atlas_pages"));
}

/// A wall of 120 x 3.75 m that shows an image of 4096 x 128 texels once, and one far from it.
CitySource long_walls(const std::string& image) {
    return [image](city::CityHeader&, city::CityCatalog& catalog, city::CityReport& report,
                   const city::CitySink& sink) -> Status {
        catalog.images.push_back({.path = image});
        city::Material material;
        material.image = 0;
        for (const double y : {4.0, 120.0}) {
            city::CityObject object;
            object.id = "wall at " + std::to_string(y);
            object.kind = city::ObjectKind::kBuilding;
            object.vertices = {{4, y, 0}, {124, y, 0}, {124, y, 3.75}, {4, y, 3.75}};
            city::Triangle triangle;
            triangle.material = catalog.add_material(material);
            triangle.vertex = {0, 1, 2};
            triangle.texcoord = {{{0, 0}, {1, 0}, {1, 1}}};
            object.triangles.push_back(triangle);
            triangle.vertex = {0, 2, 3};
            triangle.texcoord = {{{0, 0}, {1, 1}, {0, 1}}};
            object.triangles.push_back(triangle);
            ++report.buildings_emitted;
            if (!sink(std::move(object))) break;
        }
        return Done{};
    };
}

TEST_F(BuildPages, InnerTilesStateTheBlurOfChartsThatPagesShrink) {
    const std::string image = images_.write("long.png", 4096, 128, 3, noise(size_t{3} * 4096 * 128, 5));
    const auto root_errors = [&](AtlasForm form) {
        const auto built = build("city.3tz", long_walls(image), [form](BuildOptions& options) {
            options.atlas_form = form;
            options.leaf_triangles = 1;
        });
        EXPECT_TRUE(built.ok());
        const OpenTile root = tiles_of(path("city.3tz")).at({});
        EXPECT_TRUE(root.has_children);
        return std::array{root.record.geometric_error, root.record.steps(Layer::kAtlas).back().error};
    };
    const auto charts = root_errors(AtlasForm::kCharts), pages = root_errors(AtlasForm::kPages);
    EXPECT_LT(charts[1], 0.13F);
    const auto texel = static_cast<float>(120.0 / codec::atlas::longest_page_chart(BuildOptions().page_mips));
    EXPECT_NEAR(pages[1], texel, 0.001F * texel);
    EXPECT_GE(pages[0], pages[1] * 0.999F) << "what its pictures are blurred by counts as error";
}

TEST_F(BuildPages, TilesWithAlphaStayInCharts) {
    std::vector<uint8_t> rgba = noise(size_t{4} * 64 * 64, 9);
    for (size_t i = 3; i < rgba.size(); i += 4) rgba[i] = i < rgba.size() / 2 ? 0 : 255;
    const auto built = build("city.3tz", long_walls(images_.write("leaves.png", 64, 64, 4, rgba)),
                             [](BuildOptions& options) { options.leaf_triangles = 1; });
    ASSERT_TRUE(built.ok()) << built.error().text();
    EXPECT_TRUE(built->manifest.needs_version_5);
    size_t in_charts = 0;
    for (const auto& [address, tile] : tiles_of(path("city.3tz"))) {
        const auto facts = codec::atlas::check_atlas(tile.words, tile.step_words);
        ASSERT_TRUE(facts.ok()) << facts.error().text();
        in_charts += facts->form == AtlasForm::kCharts ? 1 : 0;
    }
    EXPECT_GE(in_charts, 2U);
    EXPECT_EQ((*read_city_info(path("city.3tz")))["atlas_pages"]["tiles_of_charts"], in_charts);
}

TEST_F(BuildPages, SharingAndTooManyMipsAreRefused) {
    const auto shared = build("city.3tz", generated(5), [](BuildOptions& options) { options.shared_charts = true; });
    ASSERT_FALSE(shared.ok());
    EXPECT_NE(shared.error().text().find("share"), std::string::npos);
    const auto mips = build("city.3tz", generated(5), [](BuildOptions& options) { options.page_mips = 8; });
    ASSERT_FALSE(mips.ok());
    EXPECT_NE(mips.error().text().find("8 mips"), std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(path("city.3tz")));
}

}  // namespace
}  // namespace citystream::tiles::layers
