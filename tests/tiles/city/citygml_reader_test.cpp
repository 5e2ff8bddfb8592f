#include "tiles/city/citygml_reader.h"

#include <gtest/gtest.h>

#include "tests/tiles/city/city_probe.h"
#include "tests/tiles/city/gml_text.h"

namespace citystream::tiles::city {
namespace {

std::string cube_members() {
    std::string members;
    for (const char* points : {kFloorPoints, kRoofPoints, kSouthPoints, kEastPoints, kNorthPoints, kWestPoints}) {
        members += gml_surface_member(gml_polygon(points));
    }
    return members;
}

const std::string kWindowInWall =
    "<bldg:opening><bldg:Window gml:id=\"W\">" +
    gml_multi_surface("lod3MultiSurface", gml_surface_member(gml_polygon("1 0 1 2 0 1 2 0 2 1 0 2 1 0 1"))) +
    "</bldg:Window></bldg:opening>";
const std::string kHoleForWindow = "<gml:interior>" + gml_ring("1 0 1 1 0 2 2 0 2 2 0 1 1 0 1") + "</gml:interior>";

TEST(CityGmlReader, SolidBecomesOneWeldedObject) {
    const ReadCity city = read_text(gml_model(gml_building(gml_solid(cube_members()))));
    ASSERT_TRUE(city.status.ok()) << city.status.error().text();
    ASSERT_EQ(city.objects.size(), 1u);
    EXPECT_EQ(city.objects[0].id, "B");
    EXPECT_EQ(city.objects[0].vertices.size(), 8u);
    EXPECT_NEAR(volume_of(city.objects[0]), 64, 1e-9);
    EXPECT_EQ(count_surfaces(city.objects[0], SurfaceKind::kRoof), 2u);
    EXPECT_EQ(count_surfaces(city.objects[0], SurfaceKind::kGround), 2u);
    EXPECT_EQ(city.header.epsg, 25832);
    EXPECT_EQ(city.report.buildings_emitted, 1u);
    EXPECT_EQ(city.report.defect_count, 0u);
}

TEST(CityGmlReader, BoundarySurfacesCarryTheirKind) {
    const ReadCity city = read_text(gml_model(gml_building(
        gml_boundary("WallSurface", gml_polygon(kSouthPoints)) + gml_boundary("RoofSurface", gml_polygon(kRoofPoints)) +
        gml_boundary("GroundSurface", gml_polygon(kFloorPoints)) +
        gml_boundary("ClosureSurface", gml_polygon(kEastPoints)) +
        gml_boundary("OuterFloorSurface", gml_polygon(kRoofPoints)) +
        gml_boundary("OuterCeilingSurface", gml_polygon(kRoofPoints)))));
    const CityObject& object = city.objects.at(0);
    EXPECT_EQ(object.triangles.size(), 12u);
    EXPECT_EQ(count_surfaces(object, SurfaceKind::kWall),
              6u);  // wall, closure by its normal, outer ceiling
    EXPECT_EQ(count_surfaces(object, SurfaceKind::kRoof), 4u);
    EXPECT_EQ(count_surfaces(object, SurfaceKind::kGround), 2u);
}

TEST(CityGmlReader, NestedWindowFillsTheHoleOfItsWall) {
    const ReadCity city = read_text(gml_model(
        gml_building(gml_boundary("WallSurface", gml_polygon(kSouthPoints, "", kHoleForWindow), kWindowInWall, "3"))));
    const CityObject& object = city.objects.at(0);
    EXPECT_NEAR(area_of(object), 16, 1e-9);
    EXPECT_EQ(count_surfaces(object, SurfaceKind::kWindow), 2u);
    EXPECT_EQ(count_surfaces(object, SurfaceKind::kWall), 8u);
}

TEST(CityGmlReader, HighestLodIsTakenUnlessOneIsAskedFor) {
    const std::string text = gml_model(
        gml_building(gml_solid(cube_members(), "lod1Solid") + gml_boundary("RoofSurface", gml_polygon(kRoofPoints)) +
                     gml_boundary("WallSurface", gml_polygon(kSouthPoints), kWindowInWall, "3")) +
        gml_building(gml_solid(cube_members(), "lod1Solid"), "C"));
    const ReadCity best = read_text(text);
    ASSERT_EQ(best.objects.size(), 2u);
    EXPECT_EQ(best.objects[0].triangles.size(), 4u);  // wall and window of LoD3
    EXPECT_EQ(best.objects[1].triangles.size(), 12u);
    const ReadCity two = read_text(text, with_lod("2"));
    ASSERT_EQ(two.objects.size(), 1u);
    EXPECT_EQ(two.objects[0].triangles.size(), 2u);  // the window has no LoD2
    EXPECT_TRUE(two.drops("C"));
    EXPECT_TRUE(two.reports("C", "no geometry of LoD 2 (has 1)"));
    const ReadCity one = read_text(text, with_lod("1"));
    EXPECT_EQ(one.objects.size(), 2u);
}

TEST(CityGmlReader, InstallationsOfALowerLodAreKept) {
    const std::string chimney =
        "<bldg:outerBuildingInstallation><bldg:BuildingInstallation><bldg:"
        "lod2Geometry><gml:MultiSurface>" +
        gml_surface_member(gml_polygon(kEastPoints)) +
        "</gml:MultiSurface></bldg:lod2Geometry></bldg:BuildingInstallation></"
        "bldg:outerBuildingInstallation>";
    const ReadCity city =
        read_text(gml_model(gml_building(gml_boundary("WallSurface", gml_polygon(kSouthPoints), "", "3") + chimney)));
    EXPECT_EQ(count_surfaces(city.objects.at(0), SurfaceKind::kInstallation), 2u);
    EXPECT_EQ(count_surfaces(city.objects.at(0), SurfaceKind::kWall), 2u);
}

TEST(CityGmlReader, SurfacesReferredToFromTheSolidAreDrawnOnceForwardsAndBackwards) {
    const std::array<std::pair<const char*, const char*>, 6> sides = {{{"GroundSurface", kFloorPoints},
                                                                       {"RoofSurface", kRoofPoints},
                                                                       {"WallSurface", kSouthPoints},
                                                                       {"WallSurface", kEastPoints},
                                                                       {"WallSurface", kNorthPoints},
                                                                       {"WallSurface", kWestPoints}}};
    std::string boundaries, references;
    for (size_t i = 0; i < sides.size(); ++i) {
        boundaries += gml_boundary(sides[i].first, gml_polygon(sides[i].second, "p" + std::to_string(i)));
        references += gml_reference("p" + std::to_string(i));
    }
    for (const std::string& inside : {gml_solid(references) + boundaries, boundaries + gml_solid(references)}) {
        const ReadCity city = read_text(gml_model(gml_building(inside)));
        EXPECT_EQ(city.objects.at(0).triangles.size(), 12u);
        EXPECT_NEAR(volume_of(city.objects[0]), 64, 1e-9);
        EXPECT_EQ(count_surfaces(city.objects[0], SurfaceKind::kWall), 8u);
        EXPECT_EQ(city.report.defect_count, 0u);
    }
}

TEST(CityGmlReader, BoundarySurfaceThatRefersIntoTheSolidGivesItsPolygonAKind) {
    std::string members = gml_surface_member(gml_polygon(kRoofPoints, "top"));
    for (const char* points : {kFloorPoints, kSouthPoints, kEastPoints, kNorthPoints, kWestPoints})
        members += gml_surface_member(gml_polygon(points));
    const std::string door =
        "<bldg:boundedBy><bldg:WallSurface><bldg:"
        "lod2MultiSurface><gml:MultiSurface>" +
        gml_reference("top") +
        "</gml:MultiSurface></bldg:lod2MultiSurface></"
        "bldg:WallSurface></bldg:boundedBy>";
    const ReadCity city = read_text(gml_model(gml_building(gml_solid(members) + door)));
    // One referred surface is less than half of the solid: the solid is drawn,
    // whole and once.
    EXPECT_EQ(city.objects.at(0).triangles.size(), 12u);
    EXPECT_NEAR(volume_of(city.objects[0]), 64, 1e-9);
}

TEST(CityGmlReader, OrientableSurfaceWithMinusTurnsItsSurface) {
    const std::string turned =
        "<gml:surfaceMember><gml:OrientableSurface "
        "orientation=\"-\"><gml:baseSurface>" +
        gml_polygon(kRoofPoints) + "</gml:baseSurface></gml:OrientableSurface></gml:surfaceMember>";
    const ReadCity inlined = read_text(gml_model(gml_building(gml_multi_surface("lod2MultiSurface", turned))));
    EXPECT_LT(triangle_normal(inlined.objects.at(0), inlined.objects[0].triangles[0]).z, 0);
    const std::string referred =
        "<gml:surfaceMember><gml:OrientableSurface "
        "orientation=\"-\"><gml:baseSurface "
        "xlink:href=\"#top\"/></gml:OrientableSurface></gml:surfaceMember>";
    const std::string elsewhere =
        gml_multi_surface("lod1MultiSurface", gml_surface_member(gml_polygon(kRoofPoints, "top")));
    const ReadCity by_reference =
        read_text(gml_model(gml_building(elsewhere + gml_multi_surface("lod2MultiSurface", referred))));
    EXPECT_EQ(by_reference.objects.at(0).triangles.size(), 2u);
    EXPECT_LT(triangle_normal(by_reference.objects[0], by_reference.objects[0].triangles[0]).z, 0);
}

TEST(CityGmlReader, ReferenceToNothingIsReported) {
    const ReadCity city = read_text(gml_model(gml_building(gml_multi_surface(
        "lod2MultiSurface", gml_reference("nowhere") + gml_surface_member(gml_polygon(kRoofPoints))))));
    EXPECT_EQ(city.objects.at(0).triangles.size(), 2u);
    EXPECT_TRUE(city.reports("B", "1 reference(s)"));
}

TEST(CityGmlReader, ReferencesInACircleDoNotHang) {
    const auto composite = [](const std::string& id, const std::string& members) {
        return "<gml:surfaceMember><gml:CompositeSurface gml:id=\"" + id + "\">" + members +
               "</gml:CompositeSurface></gml:surfaceMember>";
    };
    std::string many;
    for (int i = 0; i < 400; ++i) many += gml_reference(i % 2 == 0 ? "a" : "b");
    const ReadCity city = read_text(gml_model(gml_building(gml_multi_surface(
        "lod2MultiSurface",
        composite("a", many) + composite("b", many + gml_surface_member(gml_polygon(kRoofPoints)))))));
    EXPECT_EQ(city.objects.at(0).triangles.size(), 2u);
}

TEST(CityGmlReader, PartsBecomeObjectsOfTheirOwnAndTheBuildingCountsOnce) {
    const std::string part = "<bldg:consistsOfBuildingPart><bldg:BuildingPart gml:id=\"P1\">" +
                             gml_solid(cube_members()) + "</bldg:BuildingPart></bldg:consistsOfBuildingPart>";
    const ReadCity city = read_text(gml_model(gml_building(part + gml_solid(cube_members(), "lod1Solid"))));
    ASSERT_EQ(city.objects.size(), 2u);
    EXPECT_EQ(city.objects[1].id, "P1");
    EXPECT_EQ(city.report.buildings_emitted, 1u);
    EXPECT_EQ(city.report.features_read, 1u);
}

TEST(CityGmlReader, CityGml3BuildingsAreRead) {
    const auto surface = [](const std::string& type, const std::string& points, const std::string& more = "") {
        return "<core:boundary><con:" + type + "><core:lod3MultiSurface><gml:MultiSurface>" +
               gml_surface_member(gml_polygon(points)) + "</gml:MultiSurface></core:lod3MultiSurface>" + more +
               "</con:" + type + "></core:boundary>";
    };
    const std::string window =
        "<con:fillingSurface><con:WindowSurface><core:lod3MultiSurface><gml:"
        "MultiSurface>" +
        gml_surface_member(gml_polygon("1 0 1 2 0 1 2 0 2 1 0 2 1 0 1")) +
        "</gml:MultiSurface></core:lod3MultiSurface></con:WindowSurface></"
        "con:fillingSurface>";
    const std::string installation = "<bldg:buildingInstallation><bldg:BuildingInstallation>" +
                                     surface("RoofSurface", kRoofPoints) +
                                     "</bldg:BuildingInstallation></bldg:buildingInstallation>";
    const ReadCity city = read_text(gml_model(gml_building(surface("WallSurface", kSouthPoints, window) +
                                                           surface("GroundSurface", kFloorPoints) + installation),
                                              "3.0", "urn:ogc:def:crs,crs:EPSG::25832,crs:EPSG::7837"));
    ASSERT_EQ(city.objects.size(), 1u);
    EXPECT_EQ(city.header.epsg, 25832);
    EXPECT_EQ(count_surfaces(city.objects[0], SurfaceKind::kWall), 2u);
    EXPECT_EQ(count_surfaces(city.objects[0], SurfaceKind::kWindow), 2u);
    EXPECT_EQ(count_surfaces(city.objects[0], SurfaceKind::kGround), 2u);
    EXPECT_EQ(count_surfaces(city.objects[0], SurfaceKind::kRoof), 2u);
}

TEST(CityGmlReader, PositionsComeAsPosOrListAndInTwoDimensions) {
    const std::string pos =
        "<gml:Polygon><gml:exterior><gml:LinearRing><gml:pos>0 0 "
        "1</gml:pos><gml:pos>2 0 1</gml:pos><gml:pos>0 2 "
        "1</gml:pos></gml:LinearRing></gml:exterior></gml:Polygon>";
    const std::string flat =
        "<gml:Polygon srsDimension=\"2\"><gml:exterior>" + gml_ring("5 5 9 5 5 9") + "</gml:exterior></gml:Polygon>";
    const ReadCity city = read_text(gml_model(
        gml_building(gml_multi_surface("lod2MultiSurface", gml_surface_member(pos) + gml_surface_member(flat)))));
    const CityObject& object = city.objects.at(0);
    ASSERT_EQ(object.triangles.size(), 2u);
    EXPECT_DOUBLE_EQ(object.vertices[0].z, 1);
    EXPECT_DOUBLE_EQ(object.vertices[3].z, 0);
    EXPECT_NEAR(area_of(object), 2 + 8, 1e-9);
}

TEST(CityGmlReader, BrokenNumbersSkipTheSurfaceWithTheFeatureId) {
    const ReadCity city = read_text(gml_model(gml_building(gml_multi_surface(
        "lod2MultiSurface",
        gml_surface_member(gml_polygon("0 0 zero 1 0 0 0 1 0")) + gml_surface_member(gml_polygon("0 0 0 1 0 0 0 1")) +
            gml_surface_member(gml_polygon("0 0 0 1 0 0 nan 1 0")) + gml_surface_member(gml_polygon(kRoofPoints))))));
    EXPECT_EQ(city.objects.at(0).triangles.size(), 2u);
    EXPECT_TRUE(city.reports("B", "3 surface(s) skipped: coordinate"));
}

TEST(CityGmlReader, OtherFeaturesAreDrawnAsTheirKind) {
    const std::string road = gml_member(
        "<tran:Road "
        "gml:id=\"R\"><tran:trafficArea><tran:TrafficArea><tran:"
        "lod2MultiSurface><gml:MultiSurface>" +
        gml_surface_member(gml_polygon(kRoofPoints)) +
        "</gml:MultiSurface></tran:lod2MultiSurface></"
        "tran:TrafficArea></tran:trafficArea></tran:Road>");
    const std::string relief = gml_member(
        "<dem:ReliefFeature "
        "gml:id=\"D\"><dem:lod>1</"
        "dem:lod><dem:reliefComponent><dem:TINRelief><dem:lod>1</"
        "dem:lod><dem:tin><gml:TriangulatedSurface><gml:"
        "trianglePatches><gml:Triangle><gml:exterior>" +
        gml_ring("0 0 0 9 0 0 0 9 1 0 0 0") +
        "</gml:exterior></gml:Triangle></gml:trianglePatches></"
        "gml:TriangulatedSurface></dem:tin></dem:TINRelief></"
        "dem:reliefComponent></dem:ReliefFeature>");
    const std::string generic = gml_member(
        "<gen:GenericCityObject "
        "gml:id=\"G\"><gen:lod1Geometry><gml:MultiSurface>" +
        gml_surface_member(gml_polygon(kRoofPoints)) +
        "</gml:MultiSurface></gen:lod1Geometry></gen:GenericCityObject>");
    const ReadCity city = read_text(gml_model(road + relief + generic));
    ASSERT_EQ(city.objects.size(), 3u);
    EXPECT_EQ(city.objects[0].kind, ObjectKind::kRoad);
    EXPECT_EQ(city.objects[1].kind, ObjectKind::kTerrain);
    EXPECT_EQ(city.objects[2].kind, ObjectKind::kOther);
    EXPECT_EQ(city.report.buildings_emitted, 0u);
}

TEST(CityGmlReader, WhatIsNotDrawnIsReportedOncePerTypeWithACount) {
    const std::string tree = gml_member(
        "<veg:SolitaryVegetationObject "
        "gml:id=\"T\"><veg:lod2ImplicitRepresentation><core:ImplicitGeometry/></"
        "veg:lod2ImplicitRepresentation></veg:SolitaryVegetationObject>");
    const std::string room = "<bldg:interiorRoom><bldg:Room>" +
                             gml_multi_surface("lod4MultiSurface", gml_surface_member(gml_polygon(kRoofPoints))) +
                             "</bldg:Room></bldg:interiorRoom>";
    const ReadCity city = read_text(gml_model(tree + tree + gml_building(room + gml_solid(cube_members()))));
    EXPECT_TRUE(city.reports("city", "not supported: ImplicitGeometry (2 times)"));
    EXPECT_TRUE(city.reports("city", "not supported: Room (1 times)"));
    EXPECT_TRUE(city.drops("T"));
    ASSERT_EQ(city.objects.size(), 1u);
    EXPECT_EQ(city.objects[0].triangles.size(), 12u);
}

TEST(CityGmlReader, BuildingWithoutGeometryOrIdIsStillNamed) {
    const ReadCity city = read_text(
        gml_model(gml_building("<bldg:measuredHeight>9</bldg:measuredHeight>") + gml_member("<bldg:Building/>")));
    EXPECT_TRUE(city.drops("B"));
    ASSERT_EQ(city.report.dropped_features.size(), 2u);
    EXPECT_NE(city.report.dropped_features[1].find("Building at line"), std::string::npos);
}

TEST(CityGmlReader, FileCutShortYieldsWhatCameBeforeAndAnError) {
    const std::string text =
        gml_model(gml_building(gml_solid(cube_members()), "A") + gml_building(gml_solid(cube_members()), "B"));
    const ReadCity city = read_text(text.substr(0, text.size() - 200));
    ASSERT_FALSE(city.status.ok());
    EXPECT_NE(city.status.error().message.find("line 2"), std::string::npos);
    ASSERT_EQ(city.objects.size(), 1u);
    EXPECT_EQ(city.objects[0].id, "A");
}

TEST(CityGmlReader, EveryTruncationIsAnErrorAndNeverACrash) {
    const std::string text = gml_model(
        gml_building(gml_boundary("WallSurface", gml_polygon(kSouthPoints, "w", kHoleForWindow), kWindowInWall, "3") +
                     gml_solid(gml_reference("w"))));
    const TestFolder folder;
    for (size_t length = 1; length + 2 < text.size(); ++length) {
        ASSERT_FALSE(read_files({folder.write("cut", text.substr(0, length))}).status.ok()) << length;
    }
}

TEST(CityGmlReader, OtherXmlEntitiesAndDeepNestingAreRefused) {
    const ReadCity other = read_text("<html><body/></html>");
    ASSERT_FALSE(other.status.ok());
    EXPECT_NE(other.status.error().message.find("no CityGML"), std::string::npos);
    const ReadCity entities = read_text("<!DOCTYPE a [<!ENTITY b \"c\">]><CityModel/>");
    ASSERT_FALSE(entities.status.ok());
    EXPECT_NE(entities.status.error().message.find("document type"), std::string::npos);
    std::string deep = "<CityModel>";
    for (int i = 0; i < 5000; ++i) deep += "<a>";
    const ReadCity nested = read_text(deep);
    ASSERT_FALSE(nested.status.ok());
    EXPECT_NE(nested.status.error().message.find("256 levels"), std::string::npos);
}

TEST(CityGmlReader, WfsFeatureCollectionsAreRead) {
    const std::string text =
        "<wfs:FeatureCollection xmlns:wfs=\"w\" xmlns:gml=\"g\" xmlns:bldg=\"b\" "
        "xmlns:xlink=\"x\"><wfs:member><bldg:Building gml:id=\"B\">" +
        gml_solid(cube_members()) + "</bldg:Building></wfs:member></wfs:FeatureCollection>";
    EXPECT_EQ(read_text(text).objects.size(), 1u);
}

}  // namespace
}  // namespace citystream::tiles::city
