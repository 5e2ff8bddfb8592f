#include "client/reference/reference_renderer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include <nlohmann/json.hpp>

#include "client/render/lighting_layout.h"
#include "tests/temporary_folder.h"

namespace citystream::client {
namespace {

/// A file that vanishes with its folder.
class GlbFile {
  public:
    std::string write(const std::string& bytes) const { return folder_.write_bytes("city.glb", bytes); }

  private:
    tests::TemporaryFolder folder_;
};

std::string word(uint32_t value) {
    return std::string(reinterpret_cast<const char*>(&value), 4);
}

std::string glb_of(const nlohmann::json& json, std::string binary) {
    std::string text = json.dump();
    while (text.size() % 4) text += ' ';
    while (binary.size() % 4) binary += '\0';
    const auto total = static_cast<uint32_t>(12 + 8 + text.size() + 8 + binary.size());
    return "glTF" + word(2) + word(total) + word(static_cast<uint32_t>(text.size())) + "JSON" + text +
           word(static_cast<uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
}

/// A wall 4 m wide and high, 10 m north of the scene's origin, facing south (glTF axes: x, y up, -z north), drawn once
/// or as two instances.
std::string wall_glb(bool instanced) {
    const float positions[12] = {-2, 0, -10, 2, 0, -10, 2, 4, -10, -2, 4, -10};
    const float normals[12] = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
    const uint16_t indices[6] = {0, 1, 2, 0, 2, 3};
    const float translations[6] = {-6, 0, 0, 6, 0, 0};
    std::string binary;
    binary.append(reinterpret_cast<const char*>(positions), sizeof positions)
        .append(reinterpret_cast<const char*>(normals), sizeof normals);
    binary.append(reinterpret_cast<const char*>(indices), sizeof indices)
        .append(reinterpret_cast<const char*>(translations), sizeof translations);
    nlohmann::json node = {{"mesh", 0}};
    if (instanced) node["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = 3;
    const nlohmann::json json = {
        {"asset", {{"version", "2.0"}, {"extras", {{"citystream", {{"origin", {1000.0, 2000.0, 50.0}}}}}}}},
        {"scene", 0},
        {"scenes", {{{"nodes", {0}}}}},
        {"nodes", nlohmann::json::array({node})},
        {"meshes",
         {{{"primitives", {{{"attributes", {{"POSITION", 0}, {"NORMAL", 1}}}, {"indices", 2}, {"material", 0}}}}}}},
        {"materials", {{{"pbrMetallicRoughness", {{"baseColorFactor", {1.0, 0.0, 0.0, 1.0}}}}}}},
        {"buffers", {{{"byteLength", binary.size()}}}},
        {"bufferViews",
         {{{"buffer", 0}, {"byteOffset", 0}, {"byteLength", 48}},
          {{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 48}},
          {{"buffer", 0}, {"byteOffset", 96}, {"byteLength", 12}},
          {{"buffer", 0}, {"byteOffset", 108}, {"byteLength", 24}}}},
        {"accessors",
         {{{"bufferView", 0},
           {"componentType", 5126},
           {"count", 4},
           {"type", "VEC3"},
           {"min", {-2, 0, -10}},
           {"max", {2, 4, -10}}},
          {{"bufferView", 1}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
          {{"bufferView", 2}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}},
          {{"bufferView", 3}, {"componentType", 5126}, {"count", 2}, {"type", "VEC3"}}}}};
    return glb_of(json, binary);
}

CameraSample looking_north() {
    CameraSample sample;
    sample.x = 1000;
    sample.y = 2000;
    sample.z = 52;
    sample.fov = 60;
    return sample;
}

std::array<uint8_t, 3> pixel(const FrameImage& image, uint32_t x, uint32_t y) {
    const uint8_t* p = &image.rgba[4 * (size_t{y} * image.width + x)];
    return {p[0], p[1], p[2]};
}

FrameImage draw(const std::string& glb, uint32_t supersample = 1, bool lit = true) {
    const GlbFile file;
    ReferenceOptions options{200, 100, supersample, {-1, 0, 0, 0}};
    options.lit = lit;
    auto renderer = ReferenceRenderer::create(file.write(glb), options);
    EXPECT_TRUE(renderer) << renderer.error().text();
    if (!renderer) return {};
    auto image = (*renderer)->draw(Camera::from_sample(looking_north(), 200, 100));
    EXPECT_TRUE(image);
    return image ? std::move(image).value() : FrameImage{};
}

TEST(ReferenceRenderer, PutsAWallWhereTheCameraSeesItInTheLightOfTheSun) {
    const FrameImage image = draw(wall_glb(false));
    ASSERT_EQ(image.width, 200u);
    const double lit = LIGHT_AMBIENT + LIGHT_SUN * -LIGHT_SUN_Y;  // the wall faces south
    const auto middle = pixel(image, 100, 50);
    EXPECT_NEAR(middle[0], 255 * std::min(1.0, lit), 1);
    EXPECT_EQ(middle[1], 0);
    // Half a wall of 2 m at 10 m is 2 / (10 tan 30) of half the frame's 50 pixels: 17.3 either way.
    EXPECT_EQ(pixel(image, 84, 50)[1], 0);
    EXPECT_EQ(pixel(image, 81, 50)[2], std::lround(255 * SKY_B));
    EXPECT_EQ(pixel(image, 116, 50)[1], 0);
    EXPECT_EQ(pixel(image, 118, 50)[2], std::lround(255 * SKY_B));
    EXPECT_EQ(pixel(image, 100, 34)[1], 0);
    EXPECT_EQ(pixel(image, 100, 31)[2], std::lround(255 * SKY_B));
}

TEST(ReferenceRenderer, DrawsEveryInstanceAtItsPlace) {
    const FrameImage image = draw(wall_glb(true));
    ASSERT_EQ(image.width, 200u);
    EXPECT_EQ(pixel(image, 100, 50)[2], std::lround(255 * SKY_B));
    EXPECT_EQ(pixel(image, 100 - 52, 50)[1], 0);
    EXPECT_EQ(pixel(image, 100 + 52, 50)[1], 0);
}

TEST(ReferenceRenderer, SupersamplingBlendsOnlyEdges) {
    const FrameImage plain = draw(wall_glb(false)), smooth = draw(wall_glb(false), 2);
    ASSERT_EQ(plain.rgba.size(), smooth.rgba.size());
    EXPECT_EQ(pixel(plain, 100, 50), pixel(smooth, 100, 50));
    EXPECT_EQ(pixel(plain, 10, 10), pixel(smooth, 10, 10));
    EXPECT_NE(plain.rgba, smooth.rgba);
}

TEST(ReferenceRenderer, SurfacesShowTheirOwnColoursWhereNoLightIsWanted) {
    const FrameImage image = draw(wall_glb(false), 1, false);
    ASSERT_EQ(image.width, 200u);
    EXPECT_EQ(pixel(image, 100, 50), (std::array<uint8_t, 3>{255, 0, 0}));
}

TEST(ReferenceRenderer, RefusesDamagedFilesWithOneClearError) {
    const GlbFile file;
    const std::string whole = wall_glb(false);
    for (size_t length = 0; length < whole.size(); length += 7)
        EXPECT_FALSE(ReferenceRenderer::create(file.write(whole.substr(0, length)), {})) << length;
    std::string beyond = whole;
    const size_t count = beyond.find("\"count\":4");
    ASSERT_NE(count, std::string::npos);
    beyond.replace(count, 9, "\"count\":9");
    EXPECT_FALSE(ReferenceRenderer::create(file.write(beyond), {}));
    EXPECT_FALSE(ReferenceRenderer::create("/nonexistent/city.glb", {}));
}

}  // namespace
}  // namespace citystream::client
