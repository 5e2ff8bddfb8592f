#include "client/light/environment_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/client/light/image_folder.h"
#include "tests/client/light/made_maps.h"

namespace citystream::client {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::string fault_of(const std::string& file) {
    const auto read = read_environment(file);
    return read ? "" : read.error().text();
}

TEST(EnvironmentFile, ReadsTexelsOfAllKindsOfFilesAsTheyAre) {
    const LightFolder folder;
    const EnvironmentMap map = noise_map(64, 32);
    for (const std::string name : {"sky.exr", "sky.hdr", "sky.tif"}) {
        const auto read = read_environment(folder.write(name, 64, 32, map.texels));
        ASSERT_TRUE(read) << read.error().text();
        ASSERT_EQ(read->map.width, 64u);
        ASSERT_EQ(read->map.height, 32u);
        EXPECT_EQ(read->defects.all(), 0u);
        // Radiance files have 8 bits for the greatest channel.
        for (size_t i = 0; i < map.texels.size(); ++i) {
            for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(read->map.texels[i][c], map.texels[i][c], 1.0 / 128) << name;
        }
    }
}

TEST(EnvironmentFile, ReadsTilesGreyAndManyChannels) {
    const LightFolder folder;
    const EnvironmentMap map = noise_map(64, 32);
    OIIO::ImageSpec tiled(64, 32, 5, OIIO::TypeDesc::HALF);
    tiled.tile_width = tiled.tile_height = 16;
    tiled.channelnames = {"R", "G", "B", "A", "Z"};
    std::vector<float> five, one;
    for (const Rgb& texel : map.texels) {
        five.insert(five.end(), {texel[0], texel[1], texel[2], 0.0F, 7.0F});
        one.push_back(texel[1]);
    }
    const auto colour = read_environment(folder.write("tiled.exr", tiled, five));
    ASSERT_TRUE(colour) << colour.error().text();
    const auto grey =
        read_environment(folder.write("grey.exr", OIIO::ImageSpec(64, 32, 1, OIIO::TypeDesc::FLOAT), one));
    ASSERT_TRUE(grey) << grey.error().text();
    for (size_t i = 0; i < map.texels.size(); ++i) {
        for (size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(colour->map.texels[i][c], map.texels[i][c], 1e-3);
            EXPECT_EQ(grey->map.texels[i][c], map.texels[i][1]);
        }
    }
}

TEST(EnvironmentFile, IntegersAreSrgb) {
    const LightFolder folder;
    const std::vector<float> half(size_t{3} * 16 * 8, 0.5F);
    const auto read = read_environment(folder.write("sky.png", OIIO::ImageSpec(16, 8, 3, OIIO::TypeDesc::UINT8), half));
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_NEAR(read->map.texels[20][1], 0.2158, 1e-3);
}

TEST(EnvironmentFile, MendsTexelsThatAreNoRadianceAndCountsThem) {
    const LightFolder folder;
    std::vector<Rgb> texels(size_t{16} * 8, Rgb{1, 1, 1});
    texels[3] = {kNan, 2, 3};
    texels[4] = {kNan, -2, kInfinity};
    texels[5] = {kInfinity, 2, -1};
    texels[6] = {-kInfinity, 2, 3};
    texels[7] = {1, -1, 3};
    texels[8] = {1, 1e20F, 3};
    const auto read = read_environment(folder.write("bad.exr", 16, 8, texels));
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_EQ(read->defects.not_a_number, 2u);
    EXPECT_EQ(read->defects.infinite, 1u);
    EXPECT_EQ(read->defects.negative, 2u);
    EXPECT_EQ(read->defects.too_great, 1u);
    EXPECT_EQ(read->defects.text(), "6 texels mended: 2 not a number, 1 infinite, 2 negative, 1 too great");
    EXPECT_EQ(read->map.texels[3], (Rgb{0, 2, 3}));
    EXPECT_EQ(read->map.texels[4], (Rgb{0, 0, 65504}));
    EXPECT_EQ(read->map.texels[5], (Rgb{65504, 2, 0}));
    EXPECT_EQ(read->map.texels[6], (Rgb{0, 2, 3}));
    EXPECT_EQ(read->map.texels[8], (Rgb{1, kGreatestRadiance, 3}));
    for (const Rgb& texel : read->map.texels) {
        for (const float v : texel) EXPECT_TRUE(v >= 0 && v <= kGreatestRadiance);
    }
}

TEST(EnvironmentFile, AMapWithoutAnyRadianceIsAnErrorButABlackOneIsNot) {
    const LightFolder folder;
    const std::vector<Rgb> bad(size_t{16} * 8, Rgb{kNan, kNan, kNan}), black(size_t{16} * 8);
    EXPECT_NE(fault_of(folder.write("bad.exr", 16, 8, bad)).find("no texel of it is a radiance"), std::string::npos);
    EXPECT_EQ(fault_of(folder.write("black.exr", 16, 8, black)), "");
}

TEST(EnvironmentFile, ErrorsNameTheFileAndTheFault) {
    const LightFolder folder;
    const std::vector<Rgb> texels(size_t{20} * 8, Rgb{1, 1, 1});
    EXPECT_EQ(fault_of(folder.path("none.hdr")),
              "cannot read environment map " + folder.path("none.hdr") + ": there is no such file");
    EXPECT_NE(fault_of(folder.path()).find("it is no file"), std::string::npos);
    EXPECT_NE(fault_of(folder.write_bytes("empty.hdr", "")).find("empty"), std::string::npos);
    EXPECT_NE(fault_of(folder.write("odd.exr", 20, 8, texels)).find("20 x 8 is no shape"), std::string::npos);
    for (const std::string name : {"text.hdr", "text.exr", "text.csv"}) {
        const std::string fault = fault_of(folder.write_bytes(name, "time_s,environment\n0,sky\n"));
        EXPECT_NE(fault.find(name), std::string::npos) << fault;
        EXPECT_EQ(fault.find('\n'), std::string::npos) << fault;
    }
}

TEST(EnvironmentFile, FilesThatAreTooLargeAreRefusedBeforeTheyAreRead) {
    const LightFolder folder;
    const std::string giant = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 120000\n";
    EXPECT_NE(fault_of(folder.write_bytes("giant.hdr", giant)).find("out of range"), std::string::npos);
    const std::string faces = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3000 +X 18000\n";
    EXPECT_NE(fault_of(folder.write_bytes("faces.hdr", faces)).find("faces of 3000"), std::string::npos);
}

TEST(EnvironmentFile, PicturesThatLieOtherwiseAreRefused) {
    const LightFolder folder;
    const auto file_with = [&](const char* axes) {
        const std::string texels(size_t{8} * 4 * 4, '\x80');
        return folder.write_bytes("turned.hdr",
                                  "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + std::string(axes) + "\n" + texels);
    };
    EXPECT_TRUE(read_environment(file_with("-Y 4 +X 8")));
    for (const char* axes : {"+Y 4 +X 8", "-Y 4 -X 8"})
        EXPECT_NE(fault_of(file_with(axes)).find("turned or mirrored"), std::string::npos) << axes;
}

TEST(EnvironmentFile, WideMapsAreReducedWhileTheyAreRead) {
    const LightFolder folder;
    const EnvironmentMap map = made_map(4200, 2100, [](const Direction& d) {
        return Rgb{static_cast<float>(1 + d[0]), static_cast<float>(1 + d[1]), static_cast<float>(1 + d[2])};
    });
    const auto read = read_environment(folder.write("wide.hdr", 4200, 2100, map.texels));
    ASSERT_TRUE(read) << read.error().text();
    EXPECT_EQ(read->map.width, kGreatestMapWidth);
    EXPECT_EQ(read->map.height, kGreatestMapWidth / 2);
    expect_near(map_energy(read->map), map_energy(map), 0.005);
}

TEST(EnvironmentFile, ReadsTheRealMaps) {
    const std::vector<std::string> files = shared_environments();
    if (files.empty()) GTEST_SKIP() << "../shared/data/hdr_env is absent";
    for (const std::string& file : files) {
        const auto read = read_environment(file);
        ASSERT_TRUE(read) << read.error().text();
        EXPECT_EQ(read->map.width, 2 * read->map.height) << file;
        EXPECT_GE(read->map.width, 1000u) << file;
        EXPECT_EQ(read->defects.all(), 0u) << file << ": " << read->defects.text();
        double most = 0;
        for (const Rgb& texel : read->map.texels) most = std::max(most, luminance(texel));
        // Their README's greatest luminances, which take the middle of what an 8 bit mantissa stands for.
        if (file.ends_with("immenstadter_horn_1k.hdr")) {
            EXPECT_NEAR(most, 6720, 6720 / 256.0);
        }
        if (file.ends_with("potsdamer_platz_1k.hdr")) {
            EXPECT_NEAR(most, 10.97, 10.97 / 256.0);
        }
    }
}

TEST(EnvironmentFile, DamagedFilesGiveAnErrorOrAMapWithoutDefects) {
    const LightFolder folder;
    folder.write("good.hdr", 32, 16, noise_map(32, 16).texels);
    folder.write("good.exr", 32, 16, noise_map(32, 16).texels);
    uint32_t state = 7;
    const auto random = [&state] { return state = state * 1664525U + 1013904223U; };
    size_t refused = 0;
    for (const std::string ending : {".hdr", ".exr"}) {
        const std::string good = folder.bytes_of("good" + ending);
        for (size_t i = 0; i < 200; ++i) {
            std::string bytes = good;
            if (i % 2 == 0)
                bytes.resize(random() % good.size());
            else
                for (size_t k = 0; k < 1 + i % 4; ++k)
                    bytes[random() % bytes.size()] = static_cast<char>(random() >> 24);
            const auto read = read_environment(folder.write_bytes("damaged" + ending, bytes));
            if (!read) {
                EXPECT_NE(read.error().text().find("damaged"), std::string::npos);
                ++refused;
                continue;
            }
            for (const Rgb& texel : read->map.texels) {
                for (const float v : texel) ASSERT_TRUE(v >= 0 && v <= kGreatestRadiance);
            }
        }
    }
    EXPECT_GT(refused, 150u);
}

}  // namespace
}  // namespace citystream::client
