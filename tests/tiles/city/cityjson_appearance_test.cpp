#include "tiles/city/cityjson_appearance.h"

#include <gtest/gtest.h>

#include "tests/tiles/city/city_probe.h"

namespace citystream::tiles::city {
namespace {

/// One square of 4 m with whatever `more` says of it.
std::string square(const std::string& appearance, const std::string& more, const std::string& rings = "[0,1,2,3]") {
    return R"({"type":"CityJSON","version":"2.0","appearance":{)" + appearance +
           R"(},"CityObjects":{"b":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"2",)" + more +
           R"("boundaries":[[)" + rings +
           R"(]]}]}},"vertices":[[0,0,0],[4,0,0],[4,4,0],[0,4,0],[1,1,0],[2,1,0],[2,2,0]]})";
}

const std::string kMaterials =
    R"("materials":[{"name":"red","diffuseColor":[1,0,0]},{"name":"none"},{"name":"half","diffuseColor":[0.5,0.5,0.5]}])";
const std::string kTextures =
    R"("textures":[{"image":"roof%20tiles.jpg","wrapMode":"wrap"},{"image":"wall.png","wrapMode":"border"},{"image":"gone.jpg"}],"vertices-texture":[[0,0],[2,0],[2,3],[0,3],[0.5,0.5]])";

using Colour = std::array<uint8_t, 3>;

class Textured : public testing::Test {
  protected:
    Textured() {
        folder.write("roof tiles.jpg", "x");
        folder.write("wall.png", "x");
    }
    ReadCity read(const std::string& text) const { return read_files({folder.write("city.json", text)}); }
    TestFolder folder;
};

TEST(CityJsonMaterials, ValuesForEachSurfaceAndOneValueForAllAreRead) {
    const ReadCity each = read_text(square(kMaterials, R"("material":{"m":{"values":[2]}},)"));
    EXPECT_EQ(each.material(0, 0).rgb, (Colour{128, 128, 128}));
    const ReadCity all = read_text(square(kMaterials, R"("material":{"m":{"value":0}},)"));
    EXPECT_EQ(all.material(0, 0).rgb, (Colour{255, 0, 0}));
    EXPECT_EQ(all.material(0, 0).image, -1);
}

TEST(CityJsonMaterials, DefaultThemeGoesBeforeTheFirst) {
    const std::string themes = R"("material":{"winter":{"value":0},"summer":{"value":2}},)";
    EXPECT_EQ(read_text(square(kMaterials, themes)).material(0, 0).rgb, (Colour{255, 0, 0}));
    EXPECT_EQ(read_text(square(kMaterials + R"(,"default-theme-material":"summer")", themes)).material(0, 0).rgb,
              (Colour{128, 128, 128}));
}

TEST(CityJsonMaterials, MaterialWithoutColourAndIndexOutOfRangeFallBackToTheDefault) {
    const Colour plain = read_text(square("", "")).material(0, 0).rgb;
    EXPECT_EQ(read_text(square(kMaterials, R"("material":{"m":{"value":1}},)")).material(0, 0).rgb, plain);
    const ReadCity wild = read_text(square(kMaterials, R"("material":{"m":{"value":9}},)"));
    EXPECT_EQ(wild.material(0, 0).rgb, plain);
    EXPECT_TRUE(wild.reports("b", "material reference(s) ignored"));
}

TEST_F(Textured, TextureCoordinatesFollowTheirPoints) {
    const ReadCity city = read(square(kTextures, R"("texture":{"t":{"values":[[[0,0,1,2,3]]]}},)"));
    const CityObject& object = city.objects.at(0);
    ASSERT_EQ(object.triangles.size(), 2u);
    for (const Triangle& t : object.triangles) {
        for (size_t k = 0; k < 3; ++k) {
            const Vec3& p = object.vertices[t.vertex[k]];
            EXPECT_DOUBLE_EQ(t.texcoord[k].x, p.x / 4 * 2);
            EXPECT_DOUBLE_EQ(t.texcoord[k].y, p.y / 4 * 3);
        }
    }
    ASSERT_EQ(city.catalog.images.size(), 1u);
    EXPECT_EQ(city.catalog.images[0].path, folder / "roof tiles.jpg");
    EXPECT_TRUE(city.material(0, 0).repeat);
    EXPECT_EQ(city.report.defect_count, 0u);
}

TEST_F(Textured, WrapModeOtherThanWrapAndMirrorClamps) {
    const ReadCity city = read(square(kTextures, R"("texture":{"t":{"values":[[[1,0,1,2,3]]]}},)"));
    EXPECT_EQ(city.catalog.images.at(0).path, folder / "wall.png");
    EXPECT_FALSE(city.material(0, 0).repeat);
}

TEST_F(Textured, HolesHaveTheirOwnCoordinates) {
    const ReadCity city =
        read(square(kTextures, R"("texture":{"t":{"values":[[[0,0,1,2,3],[0,4,4,4]]]}},)", "[0,1,2,3],[4,5,6]"));
    EXPECT_EQ(city.material(0, 0).image, 0);
    size_t at_hole = 0;
    for (const Triangle& t : city.objects.at(0).triangles) {
        for (const Vec2& uv : t.texcoord) at_hole += uv.x == 0.5 && uv.y == 0.5 ? 1 : 0;
    }
    EXPECT_GE(at_hole, 3u);
}

TEST_F(Textured, NullRingHasNoTexture) {
    const ReadCity city = read(square(kTextures, R"("texture":{"t":{"values":[[[null]]]}},)"));
    EXPECT_EQ(city.material(0, 0).image, -1);
    EXPECT_EQ(city.report.defect_count, 0u);
}

TEST_F(Textured, CoordinatesThatDoNotFitAreReportedAndTheSurfaceStays) {
    for (const char* values : {"[[[0,0,1,2]]]", "[[[0,0,1,2,99]]]", "[[[7,0,1,2,3]]]", "[[[0,0,1,\"2\",3]]]"}) {
        const ReadCity city = read(square(kTextures, std::string(R"("texture":{"t":{"values":)") + values + "}},"));
        ASSERT_EQ(city.objects.size(), 1u) << values;
        EXPECT_EQ(city.material(0, 0).image, -1) << values;
        EXPECT_TRUE(city.reports("b", "texture or material reference(s) ignored")) << values;
    }
}

TEST_F(Textured, MissingImageIsReportedOnceAndTheMaterialColourStays) {
    const ReadCity city = read(square(kTextures + "," + kMaterials,
                                      R"("material":{"m":{"value":0}},"texture":{"t":{"values":[[[2,0,1,2,3]]]}},)"));
    EXPECT_TRUE(city.reports("b", "image missing: gone.jpg"));
    EXPECT_EQ(city.report.defect_count, 1u);
    EXPECT_EQ(city.material(0, 0).rgb, (Colour{255, 0, 0}));
    EXPECT_TRUE(city.catalog.images.empty());
    EXPECT_EQ(city.objects[0].triangles[0].texcoord[1].x, 0);
}

}  // namespace
}  // namespace citystream::tiles::city
