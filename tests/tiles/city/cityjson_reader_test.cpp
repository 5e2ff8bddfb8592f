#include "tiles/city/cityjson_reader.h"

#include <gtest/gtest.h>

#include "tests/tiles/city/city_probe.h"

namespace citystream::tiles::city {
namespace {

/// A cube of 2 m from (10, 20, 30): vertices 0 to 7, floor below, roof above;
/// surfaces floor, roof, then walls, all facing outwards.
constexpr const char* kCube = "[[0,3,2,1]],[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]";
constexpr const char* kInsideOutCube = "[[0,1,2,3]],[[4,7,6,5]],[[0,4,5,1]],[[1,5,6,2]],[[2,6,7,3]],[[3,7,4,0]]";
constexpr const char* kCubeWithTurnedRoof = "[[0,3,2,1]],[[4,7,6,5]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]";
constexpr const char* kVertices = "[[0,0,0],[4,0,0],[4,4,0],[0,4,0],[0,0,4],[4,0,4],[4,4,4],[0,4,4]]";

std::string document(const std::string& objects, const std::string& more = "",
                     const std::string& vertices = kVertices) {
    return R"({"type":"CityJSON","version":"2.0","transform":{"scale":[0.5,0.5,0.5],"translate":[10,20,30]},)" + more +
           R"("CityObjects":{)" + objects + R"(},"vertices":)" + vertices + "}";
}

std::string geometry(const std::string& type, const std::string& boundaries, const std::string& more = R"("lod":"1")") {
    return R"({"type":")" + type + R"(","boundaries":[)" + boundaries + "]," + more + "}";
}

std::string building(const std::string& geometries, const std::string& id = "b", const std::string& more = "") {
    return "\"" + id + R"(":{"type":"Building",)" + more + R"("geometry":[)" + geometries + "]}";
}

TEST(CityJsonReader, SolidBecomesOneWeldedObjectInMetres) {
    const ReadCity city = read_text(document(building(geometry("Solid", std::string("[") + kCube + "]"))));
    ASSERT_TRUE(city.status.ok()) << city.status.error().text();
    ASSERT_EQ(city.objects.size(), 1u);
    const CityObject& cube = city.objects[0];
    EXPECT_EQ(cube.id, "b");
    EXPECT_EQ(cube.kind, ObjectKind::kBuilding);
    EXPECT_EQ(cube.vertices.size(), 8u);
    EXPECT_EQ(cube.triangles.size(), 12u);
    EXPECT_NEAR(volume_of(cube), 8, 1e-9);
    EXPECT_DOUBLE_EQ(cube.vertices[0].x, 10);
    EXPECT_DOUBLE_EQ(cube.vertices[2].y, 22);
    EXPECT_EQ(city.report.features_read, 1u);
    EXPECT_EQ(city.report.buildings_emitted, 1u);
    EXPECT_EQ(city.report.triangles_emitted, 12u);
    EXPECT_EQ(city.report.defect_count, 0u);
}

TEST(CityJsonReader, EveryGeometryTypeOfSurfacesIsDrawn) {
    const std::string surfaces = kCube, shell = "[" + surfaces + "]", solid = "[" + shell + "]";
    const std::array<std::pair<const char*, std::string>, 5> types = {{{"MultiSurface", surfaces},
                                                                       {"CompositeSurface", surfaces},
                                                                       {"Solid", shell},
                                                                       {"MultiSolid", solid},
                                                                       {"CompositeSolid", solid}}};
    for (const auto& [type, boundaries] : types) {
        const ReadCity city = read_text(document(building(geometry(type, boundaries))));
        ASSERT_EQ(city.objects.size(), 1u) << type;
        EXPECT_NEAR(volume_of(city.objects[0]), 8, 1e-9) << type;
    }
}

TEST(CityJsonReader, PointsAndLinesAreReportedAsNotDrawable) {
    const ReadCity city = read_text(
        document(building(geometry("MultiPoint", "0,1")) + "," + building(geometry("MultiLineString", "[0,1]"), "c")));
    EXPECT_TRUE(city.objects.empty());
    EXPECT_TRUE(city.reports("b", "not drawable"));
    EXPECT_TRUE(city.reports("c", "not drawable"));
    EXPECT_TRUE(city.drops("b"));
    EXPECT_TRUE(city.drops("c"));
}

TEST(CityJsonReader, InsideOutSolidIsTurnedAndReported) {
    const ReadCity city = read_text(document(building(geometry("Solid", std::string("[") + kInsideOutCube + "]"))));
    EXPECT_NEAR(volume_of(city.objects.at(0)), 8, 1e-9);
    EXPECT_TRUE(city.reports("b", "inside out"));
}

TEST(CityJsonReader, SolidWithOneSurfaceTheWrongWayIsStraightened) {
    const ReadCity city =
        read_text(document(building(geometry("Solid", std::string("[") + kCubeWithTurnedRoof + "]"))));
    EXPECT_NEAR(volume_of(city.objects.at(0)), 8, 1e-9);
    EXPECT_TRUE(city.reports("b", "straightened"));
}

TEST(CityJsonReader, CavityShellsFaceIntoTheCavity) {
    const std::string vertices =
        "[[0,0,0],[8,0,0],[8,8,0],[0,8,0],[0,0,8],[8,0,8],[8,8,8],[0,8,8],[2,2,2]"
        ",[4,2,2],[4,4,2],[2,4,2],[2,2,4],[4,2,4],[4,4,4],[2,4,4]]";
    // Both shells written facing out of their cube: the inner one is to be
    // turned.
    const std::string inner =
        "[[8,11,10,9]],[[12,13,14,15]],[[8,9,13,12]],[[9,"
        "10,14,13]],[[10,11,15,14]],[[11,8,12,15]]";
    const ReadCity city =
        read_text(document(building(geometry("Solid", std::string("[") + kCube + "],[" + inner + "]")), "", vertices));
    EXPECT_NEAR(volume_of(city.objects.at(0)), 64 - 1, 1e-9);
}

TEST(CityJsonReader, MultiSurfaceKeepsItsOrientation) {
    const ReadCity city = read_text(document(building(geometry("MultiSurface", kInsideOutCube))));
    EXPECT_NEAR(volume_of(city.objects.at(0)), -8, 1e-9);
    EXPECT_EQ(city.report.defect_count, 0u);
}

TEST(CityJsonReader, HighestLodOfEachObjectIsTakenUnlessOneIsAskedFor) {
    const std::string objects = building(geometry("MultiSurface", "[[0,1,2]]", R"("lod":"1.2")") + "," +
                                         geometry("MultiSurface", kCube, R"("lod":"2.2")") + "," +
                                         geometry("MultiSurface", "[[0,1,2,3]]", R"("lod":1)")) +
                                "," + building(geometry("MultiSurface", "[[0,1,2]]", R"("lod":1.0)"), "c");
    const ReadCity best = read_text(document(objects));
    ASSERT_EQ(best.objects.size(), 2u);
    EXPECT_EQ(best.objects[0].triangles.size(), 12u);
    EXPECT_EQ(best.objects[1].triangles.size(), 1u);
    const ReadCity one = read_text(document(objects), with_lod("1"));
    ASSERT_EQ(one.objects.size(), 2u);
    EXPECT_EQ(one.objects[0].triangles.size(), 2u);
    const ReadCity fine = read_text(document(objects), with_lod("2.2"));
    ASSERT_EQ(fine.objects.size(), 1u);
    EXPECT_TRUE(fine.drops("c"));
    EXPECT_TRUE(fine.reports("c", "no geometry of LoD 2.2 (has 1)"));
}

TEST(CityJsonReader, SemanticsReachEverySurfaceAndNullsAreInferred) {
    const std::string semantics =
        R"("surfaces":[{"type":"WallSurface"},{"type":"RoofSurface"},{"type":"Door"}],"values":)";
    const std::string flat = R"("lod":"2","semantics":{)" + semantics + "[null,1,0,0,2,null]}";
    const std::string in_shell = R"("lod":"2","semantics":{)" + semantics + "[[null,1,0,0,2,null]]}";
    const std::string in_solid = R"("lod":"2","semantics":{)" + semantics + "[[[null,1,0,0,2,null]]]}";
    const std::string surfaces = kCube;
    for (const std::string& g :
         {geometry("MultiSurface", surfaces, flat), geometry("Solid", "[" + surfaces + "]", in_shell),
          geometry("MultiSolid", "[[" + surfaces + "]]", in_solid)}) {
        const ReadCity city = read_text(document(building(g)));
        const CityObject& cube = city.objects.at(0);
        EXPECT_EQ(count_surfaces(cube, SurfaceKind::kRoof), 2u);
        EXPECT_EQ(count_surfaces(cube, SurfaceKind::kDoor), 2u);
        EXPECT_EQ(count_surfaces(cube, SurfaceKind::kGround),
                  2u);  // the null floor: down and at the foot
        EXPECT_EQ(count_surfaces(cube, SurfaceKind::kWall),
                  6u);  // two named, one null
    }
}

TEST(CityJsonReader, NullForAWholeShellOfSemanticsIsAccepted) {
    const std::string more = R"("lod":"2","semantics":{"surfaces":[{"type":"RoofSurface"}],"values":[null]})";
    const ReadCity city = read_text(document(building(geometry("Solid", std::string("[") + kCube + "]", more))));
    EXPECT_EQ(count_surfaces(city.objects.at(0), SurfaceKind::kRoof), 2u);
    EXPECT_EQ(city.report.defect_count, 0u);
}

TEST(CityJsonReader, HolesStayOpen) {
    const std::string vertices = "[[0,0,0],[20,0,0],[20,20,0],[0,20,0],[4,4,0],[8,4,0],[8,8,0],[4,8,0]]";
    const ReadCity city =
        read_text(document(building(geometry("MultiSurface", "[[0,1,2,3],[4,7,6,5]]")), "", vertices));
    EXPECT_NEAR(area_of(city.objects.at(0)), 100 - 4, 1e-9);
}

TEST(CityJsonReader, TemplatesArePlacedByMatrixAndAnchor) {
    const std::string more =
        R"("geometry-templates":{"templates":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]]]}],"vertices-templates":[[0,0,0],[1,0,0],[0,1,0]]},)";
    const std::string tree =
        R"("t":{"type":"SolitaryVegetationObject","geometry":[{"type":"GeometryInstance","template":0,"boundaries":[1],"transformationMatrix":[2,0,0,5,0,2,0,0,0,0,2,0,0,0,0,1]}]})";
    const ReadCity city = read_text(document(tree, more));
    ASSERT_EQ(city.objects.size(), 1u);
    EXPECT_EQ(city.objects[0].kind, ObjectKind::kVegetation);
    EXPECT_DOUBLE_EQ(city.objects[0].vertices[0].x, 12 + 5);
    EXPECT_DOUBLE_EQ(city.objects[0].vertices[0].y, 20);
    EXPECT_NEAR(area_of(city.objects[0]), 2, 1e-12);
}

TEST(CityJsonReader, MirroringMatrixKeepsTheFacing) {
    const std::string more =
        R"("geometry-templates":{"templates":[{"type":"MultiSurface","lod":"2","boundaries":[[[0,1,2]]]}],"vertices-templates":[[0,0,0],[1,0,0],[0,1,0]]},)";
    const std::string tree =
        R"("t":{"type":"CityFurniture","geometry":[{"type":"GeometryInstance","template":0,"boundaries":[1],"transformationMatrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}]})";
    const ReadCity city = read_text(document(tree, more));
    EXPECT_GT(triangle_normal(city.objects.at(0), city.objects[0].triangles[0]).z, 0);
}

TEST(CityJsonReader, InstanceOfAnAbsentTemplateDropsTheObjectByName) {
    const ReadCity city = read_text(document(
        R"("t":{"type":"CityFurniture","geometry":[{"type":"GeometryInstance","template":7,"boundaries":[1],"transformationMatrix":[1]}]})"));
    EXPECT_TRUE(city.drops("t"));
    EXPECT_TRUE(city.reports("t", "template index out of range"));
}

TEST(CityJsonReader, BuildingWithPartsCountsOnce) {
    const std::string part =
        R"("type":"BuildingPart","parents":["b"],"geometry":[)" + geometry("MultiSurface", "[[0,1,2]]") + "]";
    const ReadCity city =
        read_text(document(R"("p":{)" + part + R"(},"b":{"type":"Building","children":["p","q"]},"q":{)" + part + "}"));
    EXPECT_EQ(city.objects.size(), 2u);
    EXPECT_EQ(city.report.buildings_emitted, 1u);
    EXPECT_EQ(city.report.features_read, 1u);
    EXPECT_TRUE(city.report.dropped_features.empty());
}

TEST(CityJsonReader, ParentsInACircleDoNotHang) {
    const std::string g = R"("geometry":[)" + geometry("MultiSurface", "[[0,1,2]]") + "]";
    const ReadCity city = read_text(document(R"("p":{"type":"BuildingPart","parents":["q"],)" + g +
                                             R"(},"q":{"type":"BuildingPart","parents":["p"],)" + g + "}"));
    EXPECT_EQ(city.objects.size(), 2u);
}

TEST(CityJsonReader, BuildingWithoutGeometryIsNamed) {
    const ReadCity city = read_text(document(R"("b":{"type":"Building"},"c":{"type":"Building","geometry":[]})"));
    EXPECT_TRUE(city.drops("b"));
    EXPECT_TRUE(city.drops("c"));
    EXPECT_EQ(city.report.buildings_emitted, 0u);
}

TEST(CityJsonReader, IndexOutOfRangeSkipsTheSurfaceOnly) {
    const ReadCity city = read_text(
        document(building(geometry("MultiSurface", "[[0,1,2]],[[0,1,8]],[[0,-1,2]],[[0,1.5,2]],[[0,\"1\",2]]"))));
    EXPECT_EQ(city.objects.at(0).triangles.size(), 1u);
    EXPECT_TRUE(city.reports("b",
                             "4 surface(s) or instance(s) skipped: vertex "
                             "or template index out of range"));
}

TEST(CityJsonReader, BadRingsAreSkippedOrRepairedAndReported) {
    const std::string g =
        geometry("MultiSurface", "[[0,1]],[[0,1,2,3,0]],[[0,0,1,2]],[[0,1,2],[3,3]],[[0,1,0]],[[]],[]");
    const ReadCity city = read_text(document(building(g)));
    EXPECT_EQ(city.objects.at(0).triangles.size(), 2u + 1u + 1u);
    EXPECT_TRUE(city.reports("b", "4 surface(s) skipped: ring of fewer than 3"));
    EXPECT_TRUE(city.reports("b", "1 hole(s) skipped"));
    EXPECT_TRUE(city.reports("b", "repeated point(s) dropped"));
}

TEST(CityJsonReader, WildCoordinatesAreRefusedWithTheFeatureId) {
    const std::string vertices = "[[0,0,0],[1,0,0],[0,1,0],[4e9,0,0],[0,\"x\",0],[0,0]]";
    const ReadCity city = read_text(
        document(building(geometry("MultiSurface", "[[0,1,2]],[[0,1,3]],[[0,1,4]],[[0,1,5]]")), "", vertices));
    EXPECT_EQ(city.objects.at(0).triangles.size(), 1u);
    EXPECT_TRUE(city.reports("b", "3 surface(s) skipped: coordinate"));
}

TEST(CityJsonReader, KindsFollowTheObjectTypeAndExtensionsAreOther) {
    std::string objects;
    const std::array<std::pair<const char*, ObjectKind>, 9> kinds = {{{"Road", ObjectKind::kRoad},
                                                                      {"TINRelief", ObjectKind::kTerrain},
                                                                      {"LandUse", ObjectKind::kLandUse},
                                                                      {"WaterBody", ObjectKind::kWater},
                                                                      {"PlantCover", ObjectKind::kVegetation},
                                                                      {"Bridge", ObjectKind::kBridge},
                                                                      {"CityFurniture", ObjectKind::kFurniture},
                                                                      {"GenericCityObject", ObjectKind::kOther},
                                                                      {"+NoiseBarrier", ObjectKind::kOther}}};
    for (const auto& [type, kind] : kinds) {
        objects += std::string(objects.empty() ? "" : ",") + "\"" + type + R"(":{"type":")" + type +
                   R"(","geometry":[)" + geometry("MultiSurface", "[[0,1,2]]") + "]}";
    }
    const ReadCity city = read_text(document(objects));
    ASSERT_EQ(city.objects.size(), kinds.size());
    for (size_t i = 0; i < kinds.size(); ++i) EXPECT_EQ(city.objects[i].kind, kinds[i].second) << kinds[i].first;
    EXPECT_EQ(city.report.buildings_emitted, 0u);
    EXPECT_NE(city.material(0, 0), city.material(3, 0)) << "roads and water look different";
}

TEST(CityJsonReader, Version10WithoutTransformAndWithNumbersForLodsIsRead) {
    const std::string text = R"({"type":"CityJSON","version":"1.0","CityObjects":{)" +
                             building(geometry("MultiSurface", "[[0,1,2]]", R"("lod":2)")) +
                             R"(},"vertices":[[85000.25,447000.5,1],[85001.25,447000.5,1],[85000.25,447001.5,1]]})";
    const ReadCity city = read_text(text, with_lod("2"));
    ASSERT_EQ(city.objects.size(), 1u);
    EXPECT_DOUBLE_EQ(city.objects[0].vertices[0].x, 85000.25);
}

TEST(CityJsonReader, ReferenceSystemIsUnderstoodInAllSpellings) {
    for (const char* name : {"urn:ogc:def:crs:EPSG::7415", "https://www.opengis.net/def/crs/EPSG/0/7415", "EPSG:7415",
                             "http://www.opengis.net/def/crs/EPSG/9.9/7415"}) {
        const ReadCity city =
            read_text(document("", std::string(R"("metadata":{"title":"A city","referenceSystem":")") + name + "\"},"));
        EXPECT_TRUE(city.status.ok());
        EXPECT_EQ(city.header.epsg, 7415) << name;
        EXPECT_EQ(city.header.title, "A city");
    }
}

const std::string kSequenceHead =
    R"({"type":"CityJSON","version":"2.0","transform":{"scale":[0.5,0.5,0.5],"translate":[10,20,30]},"CityObjects":{},"vertices":[]})";

std::string feature(const std::string& id) {
    return R"({"type":"CityJSONFeature","id":")" + id + R"(","CityObjects":{)" +
           building(geometry("MultiSurface", kCube), id) + R"(},"vertices":)" + kVertices + "}";
}

TEST(CityJsonSequence, FeaturesComeOneByOneWithTheTransformOfTheFirstLine) {
    const ReadCity city = read_text(kSequenceHead + "\n" + feature("a") + "\r\n\n" + feature("b"));
    ASSERT_TRUE(city.status.ok()) << city.status.error().text();
    ASSERT_EQ(city.objects.size(), 2u);
    EXPECT_EQ(city.objects[1].id, "b");
    EXPECT_DOUBLE_EQ(city.objects[1].vertices[0].x, 10);
}

TEST(CityJsonSequence, BrokenLineEndsWithAnErrorThatSaysWhereAfterWhatCameBefore) {
    const ReadCity city =
        read_text(kSequenceHead + "\n" + feature("a") + "\n" + feature("b").substr(0, 80) + "\n" + feature("c"));
    ASSERT_FALSE(city.status.ok());
    EXPECT_EQ(city.objects.size(), 1u);
    EXPECT_NE(city.status.error().message.find("line 3"), std::string::npos);
    EXPECT_EQ(city.status.error().offset, kSequenceHead.size() + 1 + feature("a").size() + 1 + 80);
    EXPECT_TRUE(city.reports("city", "reading stopped"));
}

TEST(CityJsonSequence, LineThatIsNoFeatureIsAnError) {
    const ReadCity city = read_text(kSequenceHead + "\n{\"type\":\"Feature\"}\n");
    ASSERT_FALSE(city.status.ok());
    EXPECT_NE(city.status.error().message.find("no CityJSONFeature"), std::string::npos);
}

TEST(CityJsonSequence, SinkThatSaysStopEndsReadingWithoutError) {
    const TestFolder folder;
    const std::string file = folder.write("a", kSequenceHead + "\n" + feature("a") + "\n" + feature("b"));
    CityHeader header;
    CityCatalog catalog;
    CityReport report;
    int count = 0;
    EXPECT_TRUE(read_city({file}, {}, header, catalog, report, [&](CityObject&&) { return ++count < 1; }).ok());
    EXPECT_EQ(count, 1);
}

TEST(CityJsonReader, EveryTruncationIsAnErrorAndNeverACrash) {
    const std::string text = document(building(geometry("Solid", std::string("[") + kCube + "]")));
    const TestFolder folder;
    for (size_t length = 1; length < text.size(); ++length) {
        const ReadCity city = read_files({folder.write("cut", text.substr(0, length))});
        ASSERT_FALSE(city.status.ok()) << length;
        ASSERT_TRUE(city.objects.empty());
    }
}

TEST(CityJsonReader, SyntaxErrorIsLocated) {
    const ReadCity city = read_text("{\"type\":\"CityJSON\",\n\"version\":\"2.0\",\n\"CityObjects\":{,}}");
    ASSERT_FALSE(city.status.ok());
    EXPECT_NE(city.status.error().message.find("line 3"), std::string::npos);
    EXPECT_EQ(city.status.error().offset, 52u);
}

TEST(CityJsonReader, DeepNestingIsAnError) {
    const ReadCity city = read_text("{\"type\":\"CityJSON\",\"x\":" + std::string(200000, '[') + "\n");
    EXPECT_FALSE(city.status.ok());
}

TEST(CityJsonReader, OtherVersionsAndOtherJsonAreRefused) {
    const ReadCity old = read_text(R"({"type":"CityJSON","version":"0.9","CityObjects":{},"vertices":[]})");
    ASSERT_FALSE(old.status.ok());
    EXPECT_NE(old.status.error().message.find("0.9"), std::string::npos);
    EXPECT_FALSE(read_text(R"({"type":"FeatureCollection","features":[]})").status.ok());
    EXPECT_FALSE(read_text(R"({"type":"CityJSON","version":"2.0","vertices":[]})").status.ok());
}

TEST(CityJsonReader, CityWithoutObjectsIsNoError) {
    const ReadCity city = read_text(document(""));
    EXPECT_TRUE(city.status.ok());
    EXPECT_TRUE(city.objects.empty());
}

}  // namespace
}  // namespace citystream::tiles::city
