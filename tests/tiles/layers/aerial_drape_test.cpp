// Aerial photographs over the ground: place, cutting, blocks, and what is left alone.
#include "tiles/layers/aerial_drape.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>

#include "tiles/layers/build_city.h"

namespace citystream::tiles::layers {
namespace {

using city::CityObject;
using city::Vec3;

/// A folder that goes with the test.
class Folder {
  public:
    Folder() : path_(testing::TempDir() + "/aerial-" + std::to_string(getpid())) {
        std::filesystem::create_directories(path_);
    }
    ~Folder() { std::filesystem::remove_all(path_); }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    std::string operator/(const std::string& name) const { return path_ + "/" + name; }

  private:
    std::string path_;
};

/// Red grows eastwards, green northwards, texel by texel.
void write_picture(const std::string& path, int width, int height) {
    const auto output = OIIO::ImageOutput::create(path);
    ASSERT_TRUE(output);
    ASSERT_TRUE(output->open(path, OIIO::ImageSpec(width, height, 3, OIIO::TypeDesc::UINT8)));
    std::vector<uint8_t> row(size_t{3} * static_cast<size_t>(width));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            row[size_t{3} * x] = static_cast<uint8_t>(x * 255 / width);
            row[size_t{3} * x + 1] = static_cast<uint8_t>((height - 1 - y) * 255 / height);
            row[size_t{3} * x + 2] = 9;
        }
        ASSERT_TRUE(output->write_scanline(y, 0, OIIO::TypeDesc::UINT8, row.data()));
    }
    output->close();
}

void write_text(const std::string& path, const std::string& text) {
    std::ofstream(path) << text;
}

/// A square of two triangles on a slope, x and y from `low` to `high`.
CityObject slope(double low, double high, uint32_t material) {
    CityObject ground;
    ground.kind = city::ObjectKind::kTerrain;
    for (const auto& [x, y] : {std::pair{low, low}, {high, low}, {high, high}, {low, high}})
        ground.vertices.push_back({x, y, 5 + x / 4 - y / 8});
    ground.triangles = {{{0, 1, 2}, {}, material, city::SurfaceKind::kGround},
                        {{0, 2, 3}, {}, material, city::SurfaceKind::kGround}};
    return ground;
}

double area_of(const CityObject& object, const city::CityCatalog& catalog, bool draped) {
    double area = 0;
    for (const city::Triangle& triangle : object.triangles) {
        if ((catalog.materials[triangle.material].image >= 0) != draped) continue;
        const Vec3 &a = object.vertices[triangle.vertex[0]], &b = object.vertices[triangle.vertex[1]],
                   &c = object.vertices[triangle.vertex[2]];
        area += 0.5 * ((b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y));
    }
    return area;
}

TEST(AerialImage, TakesItsPlaceFromNumbersOrFromAWorldFile) {
    const Folder folder;
    write_picture(folder / "a,b.png", 40, 20);
    const auto given = open_aerial((folder / "a,b.png") + ",100,-50,140,-30");
    ASSERT_TRUE(given) << given.error().text();
    EXPECT_EQ(std::vector({given->xmin, given->ymin, given->xmax, given->ymax}),
              std::vector({100.0, -50.0, 140.0, -30.0}));
    for (const char* name : {"a,b.pgw", "a,b.pngw", "a,b.wld"}) {
        write_text(folder / name, "0.5\n0\n0\n-0.25\n1000.25\n499.875\n");
        const auto image = open_aerial(folder / "a,b.png");
        ASSERT_TRUE(image) << name << image.error().text();
        EXPECT_EQ(std::vector({image->xmin, image->ymin, image->xmax, image->ymax}),
                  std::vector({1000.0, 495.0, 1020.0, 500.0}));
        std::filesystem::remove(folder / name);
    }
}

TEST(AerialImage, RefusesWhatHasNoPlaceOrIsNoImageInOneLine) {
    const Folder folder;
    write_picture(folder / "a.png", 8, 8);
    const auto refused = [](const std::string& text) {
        const auto image = open_aerial(text);
        EXPECT_FALSE(image) << text;
        return image ? std::string() : image.error().text();
    };
    EXPECT_NE(refused(folder / "a.png").find("world file"), std::string::npos);
    EXPECT_NE(refused((folder / "a.png") + ",0,0,0,10").find("no area"), std::string::npos);
    EXPECT_NE(refused((folder / "a.png") + ",0,10,10,0").find("mirrored"), std::string::npos);
    write_text(folder / "a.pgw", "0.5\n0.1\n0\n-0.25\n0\n0\n");
    EXPECT_NE(refused(folder / "a.png").find("turned"), std::string::npos);
    write_text(folder / "a.pgw", "0.5\nnonsense\n");
    EXPECT_NE(refused(folder / "a.png").find("world file"), std::string::npos);
    for (const std::string& text : {folder / "missing.png,0,0,1,1", std::string(), std::string(",,,,")})
        EXPECT_EQ(refused(text).find('\n'), std::string::npos);
}

TEST(AerialDrape, CoversWhatLiesUnderThePhotographAndKeepsTheSurface) {
    const Folder folder;
    write_picture(folder / "a.png", 64, 32);
    city::CityCatalog catalog;
    catalog.materials.push_back({});
    AerialDrape drape({*open_aerial((folder / "a.png") + ",10,20,50,70")}, catalog);
    CityObject ground = slope(0, 100, 0);
    drape.drape(ground);
    EXPECT_NEAR(area_of(ground, catalog, true), 40 * 50, 1e-6);
    EXPECT_NEAR(area_of(ground, catalog, false), 100 * 100 - 40 * 50, 1e-6);
    for (const Vec3& at : ground.vertices) EXPECT_NEAR(at.z, 5 + at.x / 4 - at.y / 8, 1e-9);
    for (const city::Triangle& triangle : ground.triangles) {
        if (catalog.materials[triangle.material].image < 0) continue;
        for (size_t k = 0; k < 3; ++k) {
            const Vec3& at = ground.vertices[triangle.vertex[k]];
            EXPECT_NEAR(triangle.texcoord[k].x, (at.x - 10) / 40, 1e-9);
            EXPECT_NEAR(triangle.texcoord[k].y, (at.y - 20) / 50, 1e-9);
        }
    }
    ASSERT_EQ(catalog.images.size(), 1U);
    const auto shown = catalog.images[0].drawn();
    EXPECT_EQ(shown->width, 64U);
    EXPECT_LT(shown->rgb[1], 8) << "the south is at the foot";
    EXPECT_FALSE(catalog.materials.back().repeat);
}

TEST(AerialDrape, LeavesBuildingsAndTexturedGroundAlone) {
    const Folder folder;
    write_picture(folder / "a.png", 8, 8);
    city::CityCatalog catalog;
    catalog.images.push_back({"grass.jpg", {}, {}});
    catalog.materials = {{}, {}};
    catalog.materials[1].image = 0;
    AerialDrape drape({*open_aerial((folder / "a.png") + ",0,0,100,100")}, catalog);
    CityObject textured = slope(0, 100, 1), house = slope(0, 100, 0), away = slope(200, 300, 0);
    house.kind = city::ObjectKind::kBuilding;
    for (CityObject* object : {&textured, &house, &away}) {
        drape.drape(*object);
        EXPECT_EQ(object->triangles.size(), 2U);
        EXPECT_EQ(object->vertices.size(), 4U);
    }
    EXPECT_EQ(drape.triangles_draped(), 0U);
    EXPECT_EQ(catalog.images.size(), 1U);
}

TEST(AerialDrape, CutsAPictureLargerThanAChartIntoBlocksThatMeetTexelByTexel) {
    const Folder folder;
    write_picture(folder / "wide.png", 9000, 12);
    city::CityCatalog catalog;
    catalog.materials.push_back({});
    AerialDrape drape({*open_aerial((folder / "wide.png") + ",0,0,9000,12")}, catalog);
    CityObject ground = slope(-10, 9100, 0);
    drape.drape(ground);
    EXPECT_NEAR(area_of(ground, catalog, true), 9000.0 * 12, 1e-3);
    ASSERT_EQ(catalog.images.size(), 3U);
    uint32_t texels = 0;
    for (const city::ImageSource& image : catalog.images) {
        const auto block = image.drawn();
        EXPECT_LE(block->width, AerialDrape::kBlockTexels + 2 * AerialDrape::kMarginTexels);
        texels += block->width;
    }
    EXPECT_EQ(texels, 9000 + 4 * AerialDrape::kMarginTexels);
    // Where blocks meet, both show the same texel.
    std::map<std::array<double, 2>, std::set<int>> seen;
    for (const city::Triangle& triangle : ground.triangles) {
        const int32_t image = catalog.materials[triangle.material].image;
        if (image < 0) continue;
        const auto block = catalog.images[static_cast<size_t>(image)].drawn();
        for (size_t k = 0; k < 3; ++k) {
            const Vec3& at = ground.vertices[triangle.vertex[k]];
            const auto column = std::min<size_t>(
                block->width - 1, static_cast<size_t>(std::lround(triangle.texcoord[k].x * block->width)));
            seen[{at.x, at.y}].insert(block->rgb[3 * column]);
        }
    }
    for (const auto& [at, reds] : seen) EXPECT_LE(*reds.rbegin() - *reds.begin(), 1) << at[0];
}

TEST(AerialDrape, CoversTheFlatGroundThatABuildMakesUp) {
    const Folder folder;
    write_picture(folder / "a.png", 64, 64);
    const auto decoded_atlas_bytes = [&](std::vector<AerialImage> aerial) {
        BuildOptions options;
        options.output = folder / "city.3tz";
        options.aerial = std::move(aerial);
        city::CityReport report;
        const auto built = build_city(
            options,
            [](city::CityHeader&, city::CityCatalog& catalog, city::CityReport&, const city::CitySink& sink) -> Status {
                CityObject roof = slope(0, 100, catalog.add_material({}));
                roof.kind = city::ObjectKind::kBuilding;
                sink(std::move(roof));
                return Done{};
            },
            report);
        EXPECT_TRUE(built) << built.error().text();
        if (!built) return uint64_t{0};
        EXPECT_NE(built->manifest.build_options.find("ground=made-up"), std::string::npos);
        EXPECT_EQ(built->manifest.build_options.find("aerial=1") != std::string::npos, !options.aerial.empty());
        return built->manifest.decoded_bytes[static_cast<size_t>(tileset::Layer::kAtlas)];
    };
    const auto image = open_aerial((folder / "a.png") + ",10,20,50,70");
    ASSERT_TRUE(image);
    EXPECT_GT(decoded_atlas_bytes({*image}), decoded_atlas_bytes({}) + 64 * 64 / 2);
}

TEST(AerialDrape, TakesARealOrthophoto) {
    const std::string path = CITYSTREAM_SOURCE_DIR "/../shared/data/drone_aerial/ortho.png";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not here";
    const auto image = open_aerial(path + ",576661,5188114,576768.3,5188212");
    ASSERT_TRUE(image) << image.error().text();
    city::CityCatalog catalog;
    catalog.materials.push_back({});
    AerialDrape drape({*image}, catalog);
    CityObject ground = slope(0, 1, 0);
    for (size_t i = 0; i < 4; ++i)
        ground.vertices[i] = {576661 + (i % 3 == 0 ? 0 : 107.3), 5188114 + (i < 2 ? 0 : 98.0), 160};
    drape.drape(ground);
    EXPECT_NEAR(area_of(ground, catalog, true), 107.3 * 98, 1e-3);
    EXPECT_EQ(catalog.images.at(0).drawn()->width, 1073U);
}

}  // namespace
}  // namespace citystream::tiles::layers
