#include "tiles/city/city_input.h"

#include <gtest/gtest.h>

#include <map>

#include "tests/tiles/city/city_probe.h"
#include "tests/tiles/city/gml_text.h"
#include "tiles/city/crs_name.h"
#include "tiles/city/shell_orientation.h"
#include "tiles/city/surface_colours.h"
#include "tiles/city/vertex_welder.h"

namespace citystream::tiles::city {
namespace {

std::string json_city(const std::string& id, const std::string& epsg = "") {
    const std::string crs =
        epsg.empty() ? "" : R"("metadata":{"referenceSystem":"urn:ogc:def:crs:EPSG::)" + epsg + "\"},";
    return R"({"type":"CityJSON","version":"2.0",)" + crs + R"("CityObjects":{")" + id +
           R"(":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]]]}]}},"vertices":[[0,0,0],[1,0,0],[0,1,0]]})";
}

std::string gml_city(const std::string& id, const std::string& epsg = "25832") {
    return gml_model(gml_building(gml_boundary("RoofSurface", gml_polygon(kRoofPoints)), id), "2.0", "EPSG:" + epsg);
}

TEST(ReadCity, FilesOfAllFormatsMakeOneCityInTheOrderGiven) {
    const TestFolder folder;
    const ReadCity city =
        read_files({folder.write("a.xml", gml_city("A")), folder.write("b.txt", json_city("B", "25832")),
                    folder.write("c", "\xEF\xBB\xBF" + json_city("C"))});
    ASSERT_TRUE(city.status.ok()) << city.status.error().text();
    ASSERT_EQ(city.objects.size(), 3u);
    EXPECT_EQ(city.objects[0].id, "A");
    EXPECT_EQ(city.objects[1].id, "B");
    EXPECT_EQ(city.objects[2].id, "C");
    EXPECT_EQ(city.report.buildings_emitted, 3u);
}

TEST(ReadCity, IdsThatRepeatAcrossFilesAreReportedAndKept) {
    const TestFolder folder;
    const ReadCity city = read_files({folder.write("a", json_city("same")), folder.write("b", json_city("same"))});
    EXPECT_EQ(city.objects.size(), 2u);
    EXPECT_EQ(city.report.buildings_emitted, 2u);
    EXPECT_TRUE(city.reports("same", "was there before"));
}

TEST(ReadCity, FilesThatDisagreeOnTheCrsAreAnErrorAfterTheFirst) {
    const TestFolder folder;
    const ReadCity city =
        read_files({folder.write("a", gml_city("A", "25832")), folder.write("b", gml_city("B", "25833"))});
    ASSERT_FALSE(city.status.ok());
    EXPECT_NE(city.status.error().message.find("25833"), std::string::npos);
    EXPECT_EQ(city.objects.size(), 1u);
    EXPECT_EQ(city.header.epsg, 25832);
}

TEST(ReadCity, CoordinatesInDegreesAreRefused) {
    const ReadCity city = read_text(json_city("B", "4326"));
    ASSERT_FALSE(city.status.ok());
    EXPECT_NE(city.status.error().message.find("degrees"), std::string::npos);
}

TEST(ReadCity, FilesThatAreNoCityModelAreErrorsWithTheirName) {
    const TestFolder folder;
    for (const char* bytes : {"", "   \n ", "solid cube", "\x89PNG\r\n", "[1,2]"}) {
        const ReadCity city = read_files({folder.write("thing.bin", bytes)});
        ASSERT_FALSE(city.status.ok()) << bytes;
        EXPECT_NE(city.status.error().message.find("thing.bin"), std::string::npos);
    }
    EXPECT_FALSE(read_files({folder / "absent.json"}).status.ok());
}

TEST(ReadCity, ProgressNeverFallsAndEndsAtTheTotal) {
    const TestFolder folder;
    const std::vector<std::string> paths = {folder.write("a", gml_city("A")), folder.write("b", json_city("B"))};
    uint64_t last = 0, total = 0;
    InputOptions options;
    options.progress = [&](uint64_t done, uint64_t all) {
        EXPECT_GE(done, last);
        last = done;
        total = all;
    };
    EXPECT_TRUE(read_files(paths, options).status.ok());
    EXPECT_GT(total, 0u);
    EXPECT_EQ(last, total);
}

TEST(ReadCity, SameInputGivesTheSameCity) {
    const TestFolder folder;
    const std::string file = folder.write("a", gml_city("A"));
    const ReadCity one = read_files({file, file}), two = read_files({file, file});
    ASSERT_EQ(one.objects.size(), two.objects.size());
    for (size_t i = 0; i < one.objects.size(); ++i) {
        ASSERT_EQ(one.objects[i].triangles.size(), two.objects[i].triangles.size());
        for (size_t k = 0; k < one.objects[i].triangles.size(); ++k) {
            EXPECT_EQ(one.objects[i].triangles[k].vertex, two.objects[i].triangles[k].vertex);
            EXPECT_EQ(one.objects[i].triangles[k].material, two.objects[i].triangles[k].material);
        }
    }
}

TEST(CrsName, CodesAreFoundInEverySpelling) {
    const std::map<std::string, int32_t> names = {{"EPSG:32632", 32632},
                                                  {"epsg:25833", 25833},
                                                  {"urn:ogc:def:crs:EPSG::7415", 7415},
                                                  {"urn:ogc:def:crs:EPSG:6.12:3068", 3068},
                                                  {"urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::5783", 25832},
                                                  {"urn:ogc:def:crs,crs:EPSG:6.12:3068,crs:EPSG:6.12:5783", 3068},
                                                  {"https://www.opengis.net/def/crs/EPSG/0/6677", 6677},
                                                  {"http://www.opengis.net/gml/srs/epsg.xml#28992", 28992},
                                                  {"urn:adv:crs:ETRS89_UTM32*DE_DHHN2016_NH", 25832},
                                                  {"EPSG:99999999999999", 0},
                                                  {"local", 0},
                                                  {"EPSG", 0},
                                                  {"", 0}};
    for (const auto& [name, code] : names) EXPECT_EQ(epsg_of(name), code) << name;
}

TEST(DefaultColours, TellSurfacesAndObjectsApart) {
    EXPECT_NE(default_colour(ObjectKind::kBuilding, SurfaceKind::kWall),
              default_colour(ObjectKind::kBuilding, SurfaceKind::kRoof));
    EXPECT_NE(default_colour(ObjectKind::kBuilding, SurfaceKind::kWall),
              default_colour(ObjectKind::kBuilding, SurfaceKind::kWindow));
    const auto water = default_colour(ObjectKind::kWater, SurfaceKind::kUnknown),
               plants = default_colour(ObjectKind::kVegetation, SurfaceKind::kUnknown);
    EXPECT_GT(water[2], water[0]);
    EXPECT_GT(plants[1], plants[0]);
}

TEST(VertexWelder, EqualPositionsAreOneVertexAndMinusZeroIsZero) {
    VertexWelder welder;
    for (int round = 0; round < 2; ++round) {
        welder.clear();
        std::vector<Vec3> vertices;
        for (int i = 0; i < 5000; ++i)
            EXPECT_EQ(welder.index_of(vertices, {i * 0.5, -i * 1.0, 7}), static_cast<uint32_t>(i));
        for (int i = 0; i < 5000; ++i)
            EXPECT_EQ(welder.index_of(vertices, {i * 0.5, -i * 1.0, 7}), static_cast<uint32_t>(i));
        EXPECT_EQ(welder.index_of(vertices, {-0.0, 0.0, 7}), 0u);
        EXPECT_EQ(vertices.size(), 5000u);
    }
}

TEST(CityCatalog, EqualMaterialsAreOne) {
    CityCatalog catalog;
    const uint32_t red = catalog.add_material({.rgb = {255, 0, 0}});
    EXPECT_NE(catalog.add_material({.rgb = {255, 0, 0}, .image = 3}), red);
    EXPECT_EQ(catalog.add_material({.rgb = {255, 0, 0}}), red);
    EXPECT_EQ(catalog.materials.size(), 2u);
}

TEST(CityReport, KeepsALimitedNumberOfDefectsButEveryDroppedFeature) {
    CityReport report;
    for (size_t i = 0; i < CityReport::kMaxDefects + 5; ++i)
        report.add({.feature = std::to_string(i), .what = "gone", .where = "", .dropped_feature = true});
    EXPECT_EQ(report.defects.size(), CityReport::kMaxDefects);
    EXPECT_EQ(report.defect_count, CityReport::kMaxDefects + 5);
    EXPECT_EQ(report.dropped_features.size(), CityReport::kMaxDefects + 5);
}

TEST(ShellOrientation, OpenShellIsLeftAsItIs) {
    const std::vector<Vec3> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    std::vector<Triangle> shell(2);
    shell[0].vertex = {0, 1, 2};
    shell[1].vertex = {0, 1, 3};
    const auto before = shell[0].vertex;
    EXPECT_EQ(orient_shell(vertices, shell, false), ShellRepair::kNone);
    EXPECT_EQ(shell[0].vertex, before);
}

}  // namespace
}  // namespace citystream::tiles::city
