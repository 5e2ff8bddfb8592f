// The readers on the real city models of ../shared/data; skipped where those
// are absent.
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>

#include "tests/tiles/city/city_probe.h"

namespace citystream::tiles::city {
namespace {

const std::filesystem::path kShared = CITYSTREAM_SOURCE_DIR "/../shared";

void expect_sound(const ReadCity& city) {
    std::set<std::array<double, 3>> seen;
    for (const CityObject& object : city.objects) {
        seen.clear();
        for (const Vec3& v : object.vertices) {
            ASSERT_TRUE(seen.insert({v.x, v.y, v.z}).second) << object.id << " has a vertex twice";
        }
        for (const Triangle& t : object.triangles) {
            ASSERT_LT(t.material, city.catalog.materials.size());
            for (const uint32_t v : t.vertex) ASSERT_LT(v, object.vertices.size());
        }
    }
}

TEST(RealCities, DelftIsReadWhole) {
    const auto file = kShared / "data/cityjson_samples/delft.json.xz";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
    const ReadCity city = read_files({file.string()});
    ASSERT_TRUE(city.status.ok()) << city.status.error().text();
    expect_sound(city);
    EXPECT_EQ(city.header.epsg, 7415);
    EXPECT_EQ(city.report.features_read, 570u);
    EXPECT_EQ(city.objects.size(), 570u);
    EXPECT_EQ(city.report.buildings_emitted, 160u);
    EXPECT_TRUE(city.report.dropped_features.empty());
    for (const CityObject& object : city.objects) {
        if (object.kind == ObjectKind::kBuilding) {
            EXPECT_GT(count_surfaces(object, SurfaceKind::kRoof), 0u) << object.id;
        }
        for (const Vec3& v : object.vertices) {
            ASSERT_GT(v.x, 84616.0);
            ASSERT_LT(v.x, 85141.0);
            ASSERT_LT(v.z, 17.0);
        }
    }
}

TEST(RealCities, RotterdamKeepsItsPhotographsAndNamesTheAbsentOnes) {
    const auto file = kShared / "data/cityjson_samples/rotterdam/rotterdam_subset.json";
    if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is absent";
    const ReadCity city = read_files({file.string()});
    ASSERT_TRUE(city.status.ok());
    expect_sound(city);
    EXPECT_EQ(city.report.buildings_emitted, 16u);
    ASSERT_EQ(city.catalog.images.size(), 1u);
    EXPECT_TRUE(city.catalog.images[0].path.ends_with("0320_4_15.jpg"));
    EXPECT_TRUE(city.reports("", "image missing: appearances/0320_4_13.jpg"));
    size_t textured = 0;
    for (const CityObject& object : city.objects) {
        for (const Triangle& t : object.triangles) textured += city.catalog.materials[t.material].image >= 0 ? 1 : 0;
    }
    EXPECT_GT(textured, 0u);
}

TEST(RealCities, IngolstadtIsOneTexturedCityOfThirtySixFiles) {
    const auto folder = kShared / "data/ingolstadt_lod3";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
        if (entry.path().string().ends_with(".xml.xz")) files.push_back(entry.path().string());
    }
    std::sort(files.begin(), files.end());
    ASSERT_EQ(files.size(), 36u);
    const ReadCity city = read_files(files);
    ASSERT_TRUE(city.status.ok()) << city.status.error().text();
    expect_sound(city);
    EXPECT_EQ(city.header.epsg, 32632);
    EXPECT_EQ(city.report.buildings_emitted, 36u);
    EXPECT_TRUE(city.report.dropped_features.empty());
    EXPECT_NEAR(static_cast<double>(city.report.triangles_emitted), 93558, 500);
    EXPECT_GT(city.catalog.images.size(), 100u);
    size_t missing = 0, textured = 0, windows = 0, doors = 0;
    for (const Defect& defect : city.report.defects) missing += defect.what.starts_with("image missing") ? 1 : 0;
    EXPECT_EQ(missing, 2u);
    for (const CityObject& object : city.objects) {
        windows += count_surfaces(object, SurfaceKind::kWindow);
        doors += count_surfaces(object, SurfaceKind::kDoor);
        for (const Triangle& t : object.triangles) textured += city.catalog.materials[t.material].image >= 0 ? 1 : 0;
    }
    EXPECT_GT(windows, 30000u);
    EXPECT_GT(doors, 1000u);
    EXPECT_GT(textured, 15000u);
}

TEST(RealCities, ThousandBuildingsOfChiyodaAllArriveFacingOutwards) {
    const auto script = kShared / "tools/footprints_to_cityjsonseq.py",
               ward = kShared / "data/tokyo_buildings/wards/13101_chiyoda.csv.xz";
    if (!std::filesystem::exists(script) || !std::filesystem::exists(ward)) GTEST_SKIP() << ward << " is absent";
    if (std::system("python3 -c pass") != 0) GTEST_SKIP() << "no python3";
    const TestFolder folder;
    const std::string file = folder / "chiyoda.city.jsonl";
    ASSERT_EQ(std::system(
                  ("python3 '" + script.string() + "' '" + ward.string() + "' --first 1000 > '" + file + "'").c_str()),
              0);
    const ReadCity city = read_files({file});
    ASSERT_TRUE(city.status.ok()) << city.status.error().text();
    expect_sound(city);
    EXPECT_EQ(city.header.epsg, 6677);
    EXPECT_EQ(city.report.buildings_emitted, 1000u);
    EXPECT_TRUE(city.report.dropped_features.empty());
    for (const CityObject& object : city.objects) {
        EXPECT_GT(volume_of(object), 0) << object.id;
        EXPECT_GT(count_surfaces(object, SurfaceKind::kRoof), 0u) << object.id;
        EXPECT_GT(count_surfaces(object, SurfaceKind::kGround), 0u) << object.id;
    }
}

}  // namespace
}  // namespace citystream::tiles::city
