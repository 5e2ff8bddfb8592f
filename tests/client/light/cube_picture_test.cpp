#include "client/light/cube_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "client/light/environment_file.h"
#include "tests/client/light/image_folder.h"
#include "tests/client/light/made_maps.h"
#include "tests/client/light/steps.h"

namespace citystream::client {
namespace {

Rgb light_from(const Direction& d) {
    return {static_cast<float>(2 + d[0]), static_cast<float>(2 + d[1]),
            static_cast<float>(2 + d[2] + 0.5 * d[0] * d[1])};
}

/// A picture that shows light_from, drawn by where each pixel looks: OpenGL's table of major axis, s and t, with y up
/// and z to the north. `place` gives the face's corner in pixels.
struct FaceAxes {
    Direction major, right, down;  ///< of the picture's axes
};
constexpr FaceAxes kFaces[6] = {{{1, 0, 0}, {0, 0, -1}, {0, -1, 0}}, {{-1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
                                {{0, 1, 0}, {1, 0, 0}, {0, 0, 1}},   {{0, -1, 0}, {1, 0, 0}, {0, 0, -1}},
                                {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}},  {{0, 0, -1}, {-1, 0, 0}, {0, -1, 0}}};

Rgb pixel_of(uint32_t face, uint32_t side, uint32_t column, uint32_t row) {
    const double s = (column + 0.5) / side * 2 - 1, t = (row + 0.5) / side * 2 - 1;
    Direction d{};
    for (size_t i = 0; i < 3; ++i) d[i] = kFaces[face].major[i] + s * kFaces[face].right[i] + t * kFaces[face].down[i];
    const double length = std::sqrt(dot(d, d));
    return light_from({d[0] / length, d[2] / length, d[1] / length});
}

struct Layout {
    uint32_t columns, rows;
    std::array<std::array<uint32_t, 2>, 6> places;
};
constexpr Layout kRow = {6, 1, {{{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}, {5, 0}}}};
constexpr Layout kColumn = {1, 6, {{{0, 0}, {0, 1}, {0, 2}, {0, 3}, {0, 4}, {0, 5}}}};
constexpr Layout kCross = {4, 3, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}}};
constexpr Layout kUprightCross = {3, 4, {{{2, 1}, {0, 1}, {1, 0}, {1, 2}, {1, 1}, {1, 3}}}};

std::vector<Rgb> picture_of(const Layout& layout, uint32_t side) {
    const uint32_t width = layout.columns * side;
    std::vector<Rgb> texels(size_t{width} * layout.rows * side);
    for (uint32_t face = 0; face < 6; ++face) {
        const bool hanging = &layout == &kUprightCross && face == 5;
        for (uint32_t row = 0; row < side; ++row) {
            for (uint32_t column = 0; column < side; ++column) {
                texels[(layout.places[face][1] * side + row) * width + layout.places[face][0] * side + column] =
                    hanging ? pixel_of(face, side, side - 1 - column, side - 1 - row)
                            : pixel_of(face, side, column, row);
            }
        }
    }
    return texels;
}

TEST(CubePicture, CrossesAndStripsShowTheLightOfEachDirection) {
    const LightFolder folder;
    for (const Layout* layout : {&kRow, &kColumn, &kCross, &kUprightCross}) {
        constexpr uint32_t kSide = 32;
        const auto read = read_environment(
            folder.write("cube.exr", layout->columns * kSide, layout->rows * kSide, picture_of(*layout, kSide)));
        ASSERT_TRUE(read) << read.error().text();
        EXPECT_EQ(read->map.width, 4 * kSide);
        EXPECT_EQ(read->map.height, 2 * kSide);
        for (const double azimuth : steps(3, 360, 17)) {
            for (const double height : steps(-88, 90, 11)) {
                const Direction from = direction_at(azimuth, height);
                const Rgb there = read->map.radiance(from), expected = light_from(from);
                for (size_t c = 0; c < 3; ++c)
                    EXPECT_NEAR(there[c], expected[c], 0.05) << layout->columns << " " << azimuth << " " << height;
            }
        }
    }
}

/// As OpenEXR's technical introduction has it: right-handed, y up, seen along +z, so that +x is at the left.
constexpr FaceAxes kOpenExrFaces[6] = {{{1, 0, 0}, {0, 0, 1}, {0, -1, 0}},  {{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}},
                                       {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},  {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                       {{0, 0, 1}, {-1, 0, 0}, {0, -1, 0}}, {{0, 0, -1}, {1, 0, 0}, {0, -1, 0}}};

TEST(CubePicture, OpenExrsOwnCubesHaveItsAxes) {
    const LightFolder folder;
    constexpr uint32_t kSide = 32;
    std::vector<float> values;
    for (uint32_t row = 0; row < 6 * kSide; ++row) {
        for (uint32_t column = 0; column < kSide; ++column) {
            const FaceAxes& face = kOpenExrFaces[row / kSide];
            const double s = (column + 0.5) / kSide * 2 - 1, t = (row % kSide + 0.5) / kSide * 2 - 1;
            Direction d{};
            for (size_t i = 0; i < 3; ++i) d[i] = face.major[i] + s * face.right[i] + t * face.down[i];
            const double length = std::sqrt(dot(d, d));
            const Rgb light = light_from({-d[0] / length, d[2] / length, d[1] / length});
            values.insert(values.end(), light.begin(), light.end());
        }
    }
    OIIO::ImageSpec spec(kSide, 6 * kSide, 3, OIIO::TypeDesc::FLOAT);
    spec.attribute("textureformat", "CubeFace Environment");
    const auto read = read_environment(folder.write("cube.exr", spec, values));
    ASSERT_TRUE(read) << read.error().text();
    for (const double azimuth : steps(3, 360, 17)) {
        for (const double height : steps(-88, 90, 11)) {
            const Direction from = direction_at(azimuth, height);
            const Rgb there = read->map.radiance(from), expected = light_from(from);
            for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(there[c], expected[c], 0.05) << azimuth << " " << height;
        }
    }
}

TEST(CubePicture, ConversionKeepsTheEnergyAlsoOfALamp) {
    const LightFolder folder;
    constexpr uint32_t kSide = 16;
    std::vector<Rgb> texels = picture_of(kRow, kSide);
    const auto energy_of = [&] {
        LightSum sum{};
        for (uint32_t face = 0; face < 6; ++face) {
            for (uint32_t row = 0; row < kSide; ++row) {
                for (uint32_t column = 0; column < kSide; ++column) {
                    const double solid_angle =
                        codec::radiance::cell_solid_angle(kSide, (face * kSide + row) * kSide + column);
                    const Rgb& texel = texels[row * 6 * kSide + face * kSide + column];
                    for (size_t c = 0; c < 3; ++c) sum[c] += solid_angle * texel[c];
                }
            }
        }
        return sum;
    };
    for (const float lamp : {2.0F, 1e6F}) {
        texels[5 * 6 * kSide + 2 * kSide + 3] = {lamp, lamp, lamp};
        const auto read = read_environment(folder.write("cube.exr", 6 * kSide, kSide, texels));
        ASSERT_TRUE(read) << read.error().text();
        expect_near(map_energy(read->map), energy_of(), 1e-5);
    }
}

TEST(CubePicture, KnowsItsShapesBySize) {
    EXPECT_EQ(CubePicture::of_size(64, 48)->face_side(), 16u);
    EXPECT_EQ(CubePicture::of_size(48, 64)->face_side(), 16u);
    EXPECT_EQ(CubePicture::of_size(60, 10)->face_side(), 10u);
    EXPECT_EQ(CubePicture::of_size(10, 60)->face_side(), 10u);
    EXPECT_FALSE(CubePicture::of_size(65, 48));
    EXPECT_FALSE(CubePicture::of_size(64, 32));
    EXPECT_FALSE(CubePicture::of_size(3, 3));
}

}  // namespace
}  // namespace citystream::client
