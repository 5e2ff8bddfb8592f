#include "tiles/city/citygml_appearance.h"

#include <gtest/gtest.h>

#include "tests/tiles/city/city_probe.h"
#include "tests/tiles/city/gml_text.h"

namespace citystream::tiles::city {
namespace {

using Colour = std::array<uint8_t, 3>;

std::string material(const std::string& target, const std::string& colour, const std::string& more = "") {
    return "<app:surfaceDataMember><app:X3DMaterial>" + more + "<app:diffuseColor>" + colour +
           "</app:diffuseColor><app:target>#" + target + "</app:target></app:X3DMaterial></app:surfaceDataMember>";
}

std::string texture(const std::string& image, const std::string& target, const std::string& rings,
                    const std::string& more = "<app:wrapMode>wrap</app:wrapMode>") {
    return "<app:surfaceDataMember><app:ParameterizedTexture><app:imageURI>" + image + "</app:imageURI>" + more +
           "<app:target uri=\"#" + target + "\"><app:TexCoordList>" + rings +
           "</app:TexCoordList></app:target></app:ParameterizedTexture></"
           "app:surfaceDataMember>";
}

std::string coordinates(const std::string& ring, const std::string& numbers) {
    return "<app:textureCoordinates ring=\"#" + ring + "\">" + numbers + "</app:textureCoordinates>";
}

std::string of_model(const std::string& data) {
    return "<app:appearanceMember><app:Appearance><app:theme>rgb</app:theme>" + data +
           "</app:Appearance></app:appearanceMember>";
}
std::string of_building(const std::string& data) {
    return "<app:appearance><app:Appearance>" + data + "</app:Appearance></app:appearance>";
}

const std::string kRoof = gml_boundary("RoofSurface", gml_polygon(kRoofPoints, "roof"));
const std::string kRoofCoordinates = coordinates("roof_r", "0 0 2 0 2 3 0 3 0 0");

class GmlAppearanceTest : public testing::Test {
  protected:
    GmlAppearanceTest() { folder.write("textures/roof tiles.jpg", "x"); }
    ReadCity read(const std::string& text) const { return read_files({folder.write("city.gml", text)}); }

    static void expect_coordinates(const ReadCity& city) {
        ASSERT_EQ(city.objects.size(), 1u);
        ASSERT_GE(city.material(0, 0).image, 0);
        for (const Triangle& t : city.objects[0].triangles) {
            for (size_t k = 0; k < 3; ++k) {
                const Vec3& p = city.objects[0].vertices[t.vertex[k]];
                EXPECT_DOUBLE_EQ(t.texcoord[k].x, p.x / 4 * 2);
                EXPECT_DOUBLE_EQ(t.texcoord[k].y, p.y / 4 * 3);
            }
        }
    }
    TestFolder folder;
};

TEST_F(GmlAppearanceTest, ColourOfTheModelBeforeOrAfterTheMembersAndOfTheBuildingAreFound) {
    const std::string red = material("roof", "1 0 0");
    for (const std::string& text :
         {gml_model(of_model(red) + gml_building(kRoof)), gml_model(gml_building(kRoof) + of_model(red)),
          gml_model(gml_building(of_building(red) + kRoof)), gml_model(gml_building(kRoof + of_building(red)))}) {
        EXPECT_EQ(read(text).material(0, 0).rgb, (Colour{255, 0, 0}));
    }
}

TEST_F(GmlAppearanceTest, AppearanceOfOneBuildingDoesNotReachTheNext) {
    const ReadCity city =
        read(gml_model(gml_building(of_building(material("roof", "1 0 0")) + kRoof, "A") + gml_building(kRoof, "B")));
    EXPECT_EQ(city.material(0, 0).rgb, (Colour{255, 0, 0}));
    EXPECT_NE(city.material(1, 0).rgb, (Colour{255, 0, 0}));
}

TEST_F(GmlAppearanceTest, FrontGoesBeforeBackWhateverTheOrder) {
    const std::string back = material("roof", "0 0 1", "<app:isFront>false</app:isFront>"),
                      front = material("roof", "0 1 0", "<app:isFront>true</app:isFront>");
    EXPECT_EQ(read(gml_model(of_model(back + front) + gml_building(kRoof))).material(0, 0).rgb, (Colour{0, 255, 0}));
    EXPECT_EQ(read(gml_model(of_model(front + back) + gml_building(kRoof))).material(0, 0).rgb, (Colour{0, 255, 0}));
    EXPECT_EQ(read(gml_model(of_model(back) + gml_building(kRoof))).material(0, 0).rgb, (Colour{0, 0, 255}));
}

TEST_F(GmlAppearanceTest, ColourOfAnAggregateHoldsForItsPolygons) {
    const std::string roof =
        "<bldg:boundedBy><bldg:RoofSurface><bldg:lod2MultiSurface><gml:"
        "MultiSurface gml:id=\"all\">" +
        gml_surface_member(gml_polygon(kRoofPoints, "roof")) +
        "</gml:MultiSurface></bldg:lod2MultiSurface></bldg:RoofSurface></"
        "bldg:boundedBy>";
    EXPECT_EQ(read(gml_model(of_model(material("all", "1 0 0")) + gml_building(roof))).material(0, 0).rgb,
              (Colour{255, 0, 0}));
}

TEST_F(GmlAppearanceTest, TextureCoordinatesReachTheirPointsAndSpacesInNamesWork) {
    for (const char* name : {"textures/roof tiles.jpg", "textures/roof%20tiles.jpg", "textures\\roof tiles.jpg"}) {
        const ReadCity city = read(gml_model(of_model(texture(name, "roof", kRoofCoordinates)) + gml_building(kRoof)));
        expect_coordinates(city);
        EXPECT_EQ(city.catalog.images.at(0).path, folder / "textures/roof tiles.jpg");
        EXPECT_TRUE(city.material(0, 0).repeat);
        EXPECT_EQ(city.report.defect_count, 0u);
    }
}

TEST_F(GmlAppearanceTest, CityGml3TextureAssociationsAreRead) {
    const std::string data =
        "<app:surfaceData><app:ParameterizedTexture><app:imageURI>textures/roof "
        "tiles.jpg</app:imageURI><app:wrapMode>clamp</app:wrapMode>"
        "<app:textureParameterization><app:TextureAssociation><app:target>#roof</"
        "app:target><app:textureParameterization><app:TexCoordList>"
        "<app:textureCoordinates>0 0 2 0 2 3 0 3 0 "
        "0</app:textureCoordinates><app:ring>#roof_r</app:ring></"
        "app:TexCoordList></app:textureParameterization>"
        "</app:TextureAssociation></app:textureParameterization></"
        "app:ParameterizedTexture></app:surfaceData>";
    const ReadCity city = read(gml_model(of_model(data) + gml_building(kRoof), "3.0"));
    expect_coordinates(city);
    EXPECT_FALSE(city.material(0, 0).repeat);
}

TEST_F(GmlAppearanceTest, TurnedSurfacesKeepTheirCoordinates) {
    const std::string turned =
        "<bldg:lod2MultiSurface><gml:MultiSurface><gml:surfaceMember><gml:"
        "OrientableSurface orientation=\"-\"><gml:baseSurface>" +
        gml_polygon(kRoofPoints, "roof") +
        "</gml:baseSurface></gml:OrientableSurface></gml:surfaceMember></"
        "gml:MultiSurface></bldg:lod2MultiSurface>";
    expect_coordinates(
        read(gml_model(of_model(texture("textures/roof tiles.jpg", "roof", kRoofCoordinates)) + gml_building(turned))));
}

TEST_F(GmlAppearanceTest, MissingImageIsReportedOnceAndFallsBackToTheColour) {
    const ReadCity city = read(
        gml_model(of_model(material("roof", "1 0 0") + texture("textures/_Wood Veneer.jpg", "roof", kRoofCoordinates)) +
                  gml_building(kRoof) + gml_building(kRoof, "C")));
    EXPECT_TRUE(city.reports("B", "image missing: textures/_Wood Veneer.jpg"));
    EXPECT_EQ(city.report.defect_count, 1u);
    EXPECT_EQ(city.material(0, 0).image, -1);
    EXPECT_EQ(city.material(0, 0).rgb, (Colour{255, 0, 0}));
}

TEST_F(GmlAppearanceTest, WrongNumberOfCoordinatesIsReportedAndTheSurfaceStays) {
    const ReadCity city = read(gml_model(
        of_model(texture("textures/roof tiles.jpg", "roof", coordinates("roof_r", "0 0 1 0"))) + gml_building(kRoof)));
    EXPECT_EQ(city.objects.at(0).triangles.size(), 2u);
    EXPECT_EQ(city.material(0, 0).image, -1);
    EXPECT_TRUE(city.reports("B", "without their texture"));
}

TEST_F(GmlAppearanceTest, GeneratedCoordinatesAreReported) {
    const std::string data =
        "<app:surfaceDataMember><app:ParameterizedTexture><app:imageURI>textures/"
        "roof tiles.jpg</app:imageURI><app:target "
        "uri=\"#roof\"><app:TexCoordGen/></app:target>"
        "</app:ParameterizedTexture></app:surfaceDataMember>";
    EXPECT_TRUE(
        read(gml_model(of_model(data) + gml_building(kRoof))).reports("city.gml", "generated or georeferenced"));
}

}  // namespace
}  // namespace citystream::tiles::city
