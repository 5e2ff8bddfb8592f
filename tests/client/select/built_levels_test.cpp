// Which level of the tree a view is drawn from and how fine its texels are, of cities as the builder writes them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "client/select/selection.h"
#include "codec/atlas/page_layer.h"
#include "codec/chart_word.h"
#include "codec/mesh/mesh_layer.h"
#include "tests/tiles/layers/city_builds.h"

namespace citystream::client {
namespace {

using codec::atlas::AtlasForm;
using tiles::layers::BuildOptions;
using tiles::layers::OpenCity;
using tiles::tileset::Layer;
using tiles::tileset::TileAddress;
using tiles::tileset::TileRecord;
namespace city = tiles::city;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kTexelOfLeaves = 0.05;                // metres
constexpr uint32_t kLeafLevel = 2, kLeafTexels = 256;  // of a wall, across
constexpr double kWallWidth = kLeafTexels * kTexelOfLeaves;
constexpr double kGroundSide = 256;  // metres
constexpr uint32_t kGroundTexels = 512, kCoarsestGround = 32;

/// A built archive as a client knows it once all of the directory has come.
struct BuiltCity {
    explicit BuiltCity(const std::string& path)
        : city(tiles::layers::open_city(path)), directory(city.manifest, nullptr) {
        for (const auto& [address, record] : city.tiles) {
            if (address.level % city.manifest.subtree_levels != 0) continue;
            const auto bytes = city.reader->find(subtree_path(address));
            if (!bytes.empty()) {
                EXPECT_TRUE(directory.add_subtree(bytes, address));
            }
        }
        knowledge.tiles.resize(directory.nodes().size());
    }

    /// The tile that shows what lies in a leaf, and how much of it; null where none is drawn.
    const SelectedTile* drawn_for(const Selection& selection, TileAddress leaf) const {
        for (const SelectedTile& tile : selection.tiles) {
            TileAddress at = leaf;
            const TileAddress shown = directory.node(tile.node).record->address;
            while (at.level > shown.level) at = at.parent();
            if (at == shown) return &tile;
        }
        return nullptr;
    }
    const TileRecord& record(const SelectedTile& tile) const { return *directory.node(tile.node).record; }
    /// Metres: the longest texel of what is drawn of a tile.
    double texel_of(const SelectedTile& tile) const {
        return record(tile).steps(Layer::kAtlas)[tile.steps_of(Layer::kAtlas) - 1u].error;
    }

    OpenCity city;
    DirectoryCache directory;
    CityKnowledge knowledge;
};

/// Views of 1,440 pixels and 60 degrees along one axis, as in the paper: across, and upright.
struct View {
    uint32_t width, height;
    double fov_y;  ///< degrees
};
const View kViews[] = {{1440, 900, 2 * std::atan(std::tan(30 * kDegree) * 900 / 1440) / kDegree}, {900, 1440, 60}};

class BuiltLevels : public tiles::layers::CityBuildTest {
  protected:
    BuildOptions usual_options() const override {
        BuildOptions options = CityBuildTest::usual_options();
        options.leaf_triangles = 1;
        options.shared_charts = false;
        options.rate_distortion = 0;
        return options;
    }

    /// Walls whose texels are 5 cm long, each in a leaf of its own, 64 m wide; the root is 256 m wide.
    /// `plain`: the last of them is of one colour instead.
    BuiltCity thesis_city(AtlasForm form, bool plain = false) {
        const auto walls = [plain](city::CityHeader&, city::CityCatalog& catalog, city::CityReport& report,
                                   const city::CitySink& sink) -> Status {
            catalog.images.push_back({.make = [] {
                return city::Image{kLeafTexels, kLeafTexels / 2,
                                   tiles::layers::noise(size_t{3} * kLeafTexels * kLeafTexels / 2)};
            }});
            city::Material material;
            material.image = 0;
            const uint32_t number = catalog.add_material(material), colour = catalog.add_material({});
            for (const city::Vec2& foot : {city::Vec2{30, 30}, {100, 30}, {30, 100}, {140, 140}, {220, 220}}) {
                ++report.buildings_emitted;
                const std::string id = std::to_string(report.buildings_emitted);
                const bool shows_image = !plain || foot.x < 220;
                if (!sink(
                        tiles::layers::image_wall(id, foot, kWallWidth, kWallWidth / 2, shows_image ? number : colour)))
                    break;
            }
            return Done{};
        };
        const auto built = build("city.3tz", walls, [form](BuildOptions& options) {
            options.auto_ground = false;
            options.atlas_form = form;
            options.page_mips.reset();
            options.texture_law = *tiles::layers::parse_texture_law("thesis");
        });
        EXPECT_TRUE(built.ok()) << built.error().text();
        return BuiltCity(path("city.3tz"));
    }

    /// Ground of one colour beneath an aerial photograph of half-metre texels, and a wall without texture on it.
    BuiltCity aerial_city() {
        constexpr int size = kGroundTexels;
        const std::string image = folder_.write("ground.png", size, size, 3, tiles::layers::noise(3U * size * size));
        auto aerial = tiles::layers::open_aerial(image + ",0,0,256,256");
        EXPECT_TRUE(aerial.ok());
        const auto wall = [](city::CityHeader&, city::CityCatalog& catalog, city::CityReport& report,
                             const city::CitySink& sink) -> Status {
            const uint32_t plain = catalog.add_material({});
            for (const double at : {1.0, 240.0}) {
                ++report.buildings_emitted;
                if (!sink(tiles::layers::image_wall("wall", {at, at}, 14, 3, plain))) break;
            }
            return Done{};
        };
        const auto built = build("aerial.3tz", wall, [&](BuildOptions& options) { options.aerial = {*aerial}; });
        EXPECT_TRUE(built.ok()) << built.error().text();
        return BuiltCity(path("aerial.3tz"));
    }
};

/// South of a tile's box, so far from it, looking north.
Camera camera_south_of(const BuiltCity& city, TileAddress tile, double distance, const View& view) {
    const auto& box = city.city.tiles.at(tile).bounds;
    const auto [x, y] = city.directory.origin();
    CameraSample sample;
    sample.x = x + (box.min[0] + box.max[0]) / 2;
    sample.y = y + box.min[1] - distance;
    sample.z = (box.min[2] + box.max[2]) / 2;
    sample.fov = view.fov_y;
    return Camera::from_sample(sample, view.width, view.height);
}

class BuiltLevelsOfForm : public BuiltLevels, public testing::WithParamInterface<AtlasForm> {};

TEST_P(BuiltLevelsOfForm, TexelsOfTheThesissLevelsAreThoseOfTableTwo) {
    const BuiltCity city = thesis_city(GetParam());
    ASSERT_EQ(city.city.manifest.levels, kLeafLevel + 1);
    const double texels[] = {0.05, 0.4, 3.2};
    const uint32_t mips[] = {2, 2, 0}, borders[] = {2, 2, 1};  // one where the paper has none: pitfall 5
    for (const auto& [address, record] : city.city.tiles) {
        const uint32_t height = kLeafLevel - address.level;
        EXPECT_NEAR(record.steps(Layer::kAtlas).back().error, texels[height], 1e-3 * texels[height]);
        if (GetParam() == AtlasForm::kCharts) continue;
        const auto atlas = layer_words(city.city, record, Layer::kAtlas);
        const auto pages = codec::atlas::PageLayerView::create(atlas.words, atlas.step_words);
        ASSERT_TRUE(pages.ok()) << pages.error().text();
        EXPECT_EQ(pages->mips(), mips[height]);
        EXPECT_EQ(pages->border(), borders[height]);
    }
}

TEST_P(BuiltLevelsOfForm, LevelsSwitchAtThePapersDistancesWhicheverAxisTheViewIsGivenAlong) {
    const BuiltCity city = thesis_city(GetParam());
    const TileAddress leaf = {kLeafLevel, 0, 0};
    Selector selector(city.directory, city.knowledge);
    for (const View& view : kViews) {
        const auto level_at = [&](double distance) {
            const Selection selection = selector.select(camera_south_of(city, leaf, distance, view), 1, 4096);
            const SelectedTile* tile = city.drawn_for(selection, leaf);
            EXPECT_NE(tile, nullptr) << "at " << distance << " m";
            return tile == nullptr ? 0 : city.record(*tile).address.level;
        };
        /// The distance from which on `coarser` is drawn.
        const auto switch_to = [&](uint32_t coarser) {
            double near = 1, far = 1e5;
            while (far - near > 1e-3) {
                const double middle = (near + far) / 2;
                (level_at(middle) <= coarser ? far : near) = middle;
            }
            return far;
        };
        EXPECT_NEAR(switch_to(1), 498.8, 0.001 * 498.8) << view.width;
        EXPECT_NEAR(switch_to(0), 3990.6, 0.001 * 3990.6) << view.width;
    }
}

TEST_P(BuiltLevelsOfForm, FromWithinItsBoxALeafIsDrawnInAllItsTexels) {
    const BuiltCity city = thesis_city(GetParam());
    const TileAddress leaf = {kLeafLevel, 0, 0};
    Selector selector(city.directory, city.knowledge);
    Camera camera = camera_south_of(city, leaf, 0, kViews[0]);
    camera.forward = {1, 0, 0};  // along the wall
    camera.right = {0, -1, 0};
    ASSERT_EQ(camera.distance_to(city.city.tiles.at(leaf).bounds, city.directory.origin()), 0);
    const Selection selection = selector.select(camera, 1, 4096);
    const SelectedTile* tile = city.drawn_for(selection, leaf);
    ASSERT_NE(tile, nullptr);
    EXPECT_EQ(city.record(*tile).address, leaf);
    EXPECT_EQ(tile->steps_of(Layer::kAtlas), city.record(*tile).steps(Layer::kAtlas).size());
}

/// What a tile's atlas has.
struct AtlasContent {
    uint64_t texels = 0, charts = 0;
};

AtlasContent content_of(const BuiltCity& city, const TileRecord& record) {
    const auto atlas = layer_words(city.city, record, Layer::kAtlas);
    AtlasContent content;
    if (codec::atlas::is_page_layer(atlas.words)) {
        const auto pages = codec::atlas::PageLayerView::create(atlas.words, atlas.step_words).value();
        for (uint32_t page = 0; page < pages.page_count(); ++page)
            content.texels += uint64_t{pages.width(page)} * pages.height(page);
        content.charts = pages.chart_count();
        return content;
    }
    const auto charts = codec::atlas::AtlasLayerView::create(atlas.words, atlas.step_words).value();
    content.charts = charts.chart_count();
    for (uint32_t chart = 0; chart < charts.chart_count(); ++chart)
        content.texels += uint64_t{charts.width(chart)} * charts.height(chart);
    return content;
}

TEST_P(BuiltLevelsOfForm, AnUntexturedBuildingLoadsNoAtlas) {
    const TileAddress textured = {kLeafLevel, 0, 0}, plain = {kLeafLevel, 3, 3};
    const BuiltCity city = thesis_city(GetParam(), true);
    const AtlasContent walls = content_of(city, city.city.tiles.at(textured));
    EXPECT_GE(walls.texels, uint64_t{kLeafTexels} * kLeafTexels / 2);
    EXPECT_TRUE(city.city.tiles.at(plain).steps(Layer::kAtlas).empty());
    const codec::mesh::MeshTile mesh = mesh_of(city.city, city.city.tiles.at(plain));
    ASSERT_FALSE(mesh.triangle_chart.empty());
    EXPECT_TRUE(codec::names_colour(mesh.triangle_chart[0])) << "its mesh names its colour";
    // Of the tile above them all, what the textured walls show is there, and nothing beside it.
    const BuiltCity without = thesis_city(GetParam(), false);
    const AtlasContent root = content_of(city, city.city.tiles.at({})),
                       bare = content_of(without, without.city.tiles.at({}));
    EXPECT_EQ(root.texels, bare.texels);
    EXPECT_EQ(root.charts, bare.charts);
}

INSTANTIATE_TEST_SUITE_P(Forms, BuiltLevelsOfForm, testing::Values(AtlasForm::kCharts, AtlasForm::kPages),
                         [](const auto& form) { return form.param == AtlasForm::kPages ? "Pages" : "Charts"; });

/// The paper's ground is of images of 512 x 512 texels, halved down to 32 x 32. Here what is coarser comes with the
/// first step.
TEST_F(BuiltLevels, TexelsOfAnAerialPhotographAreHalvingsOfItsOwnAndNeverFinerFurtherAway) {
    const BuiltCity city = aerial_city();
    const TileAddress leaf = {city.city.manifest.levels - 1, 0, 0};
    ASSERT_TRUE(city.city.tiles.contains(leaf)) << "levels: " << city.city.manifest.levels;
    Selector selector(city.directory, city.knowledge);
    for (const double pitch : {-89.0, -30.0}) {
        std::set<uint32_t> seen;
        double before = 0;
        for (double distance = 5; distance < 40000; distance *= 1.02) {
            CameraSample sample;
            sample.x = 32;
            sample.y = 32 - distance * std::cos(pitch * kDegree);
            sample.z = -distance * std::sin(pitch * kDegree);
            sample.pitch = pitch;
            sample.fov = kViews[0].fov_y;
            const Camera camera = Camera::from_sample(sample, kViews[0].width, kViews[0].height);
            const Selection selection = selector.select(camera, 1, 4096);
            const SelectedTile* tile = city.drawn_for(selection, leaf);
            ASSERT_NE(tile, nullptr) << distance;
            const double texel = city.texel_of(*tile);
            ASSERT_GE(texel, before * 0.999) << "from " << distance << " m";
            before = texel;
            const double resolution = kGroundSide / texel, halvings = std::log2(kGroundTexels / resolution);
            EXPECT_NEAR(halvings, std::round(halvings), 0.01) << resolution << " texels";
            seen.insert(1u << std::lround(std::log2(resolution)));
        }
        EXPECT_EQ(*seen.rbegin(), kGroundTexels) << "near by";
        EXPECT_GE(*seen.begin(), kCoarsestGround);
        EXPECT_LE(*seen.begin(), kGroundTexels / 8) << "far away";
    }
}

}  // namespace
}  // namespace citystream::client
