#include "client/light/environment_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/client/light/steps.h"

namespace citystream::client {
namespace {

Result<EnvironmentPath> parse(const std::string& text) {
    return parse_environment_path(std::span(text.data(), text.size()));
}

const std::string kHeader = "time_s,environment,rotation_degrees,hour\n";

TEST(EnvironmentPath, ReadsColumnsInAnyOrderAndNamesEachEnvironmentOnce) {
    const auto path =
        parse("hour,rotation_degrees,environment,time_s\r\n,,dawn.hdr,0\r\n,90, dawn.hdr ,1.5\n\n9,,sky,2\n");
    ASSERT_TRUE(path) << path.error().text();
    EXPECT_EQ(path->environments, (std::vector<std::string>{"dawn.hdr", "sky"}));
    ASSERT_EQ(path->rows.size(), 3u);
    EXPECT_EQ(path->rows[1].rotation_degrees, 90);
    EXPECT_EQ(path->rows[1].environment, 0u);
    EXPECT_EQ(path->rows[2].environment, 1u);
    EXPECT_EQ(path->rows[2].hour, 9);
}

TEST(EnvironmentPath, TwoColumnsAreEnoughForPictures) {
    const auto path = parse("time_s,environment\n0,a.exr\n10,b.exr\n");
    ASSERT_TRUE(path) << path.error().text();
    EXPECT_EQ(path->at(5).rotation_degrees, 0);
}

TEST(EnvironmentPath, OnePairOfRowsIsADay) {
    const auto path = parse(kHeader + "0,sky,0,0\n48,sky,0,24\n");
    ASSERT_TRUE(path) << path.error().text();
    for (const double t : steps(0, 48, 3)) {
        const auto moment = path->at(t);
        EXPECT_DOUBLE_EQ(moment.parts[0].hour, t / 2);
        EXPECT_EQ(moment.parts[0].weight, 1);
        EXPECT_EQ(moment.parts[1].weight, 0);
    }
}

TEST(EnvironmentPath, AFullTurnIsAFullTurn) {
    const auto path = parse(kHeader + "0,a.hdr,0,\n10,a.hdr,360,\n20,a.hdr,-360,\n");
    ASSERT_TRUE(path) << path.error().text();
    EXPECT_DOUBLE_EQ(path->at(2.5).rotation_degrees, 90);
    EXPECT_DOUBLE_EQ(path->at(15).rotation_degrees, 0);
}

TEST(EnvironmentPath, DifferentEnvironmentsFadeIntoEachOther) {
    const auto path = parse(kHeader + "0,a.hdr,0,\n10,sky,20,8\n");
    ASSERT_TRUE(path) << path.error().text();
    const auto moment = path->at(2.5);
    EXPECT_DOUBLE_EQ(moment.rotation_degrees, 5);
    EXPECT_EQ(moment.parts[0].environment, 0u);
    EXPECT_DOUBLE_EQ(moment.parts[0].weight, 0.75);
    EXPECT_EQ(moment.parts[1].environment, 1u);
    EXPECT_DOUBLE_EQ(moment.parts[1].weight, 0.25);
    EXPECT_EQ(moment.parts[1].hour, 8);
}

TEST(EnvironmentPath, StaysAtItsEnds) {
    const auto path = parse(kHeader + "5,a.hdr,10,\n6,b.hdr,20,\n");
    ASSERT_TRUE(path);
    for (const double t : {-1e300, 0.0, 5.0, std::nan("")}) {
        EXPECT_EQ(path->at(t).rotation_degrees, 10);
        EXPECT_EQ(path->at(t).parts[0].environment, 0u);
        EXPECT_EQ(path->at(t).parts[0].weight, 1);
    }
    for (const double t : {6.0, 1e300}) {
        EXPECT_EQ(path->at(t).rotation_degrees, 20);
        EXPECT_EQ(path->at(t).parts[0].environment, 1u);
    }
}

TEST(EnvironmentPath, ASteadyOneIsAlwaysTheSame) {
    const EnvironmentPath path = steady_environment("sky", 30, 7);
    for (const double t : {-5.0, 0.0, 100.0}) {
        EXPECT_EQ(path.at(t).rotation_degrees, 30);
        EXPECT_EQ(path.at(t).parts[0].hour, 7);
    }
}

TEST(EnvironmentPath, FaultsHaveLineAndColumn) {
    const auto fault = [](const std::string& rows) {
        const auto path = parse(kHeader + "0,sky,0,6\n" + rows);
        return path ? std::string() : path.error().text();
    };
    EXPECT_EQ(fault("one,sky,0,6\n"), "environment path, line 3: column time_s: \"one\" is not a number");
    EXPECT_EQ(fault("0,sky,0,6\n"), "environment path, line 3: column time_s: time must grow from line to line");
    EXPECT_EQ(fault("1,,0,6\n"),
              "environment path, line 3: column environment: empty; expected the file of an environment map or sky");
    EXPECT_EQ(fault("\n1,sky,0,\n"), "environment path, line 4: column hour: the analytic sky needs an hour");
    EXPECT_EQ(fault("1,a.hdr,0,6\n"), "environment path, line 3: column hour: only the analytic sky has an hour");
    EXPECT_EQ(fault("1,a.hdr,north,\n"),
              "environment path, line 3: column rotation_degrees: \"north\" is not a number");
    EXPECT_EQ(fault("1,a.hdr,1e7,\n"), "environment path, line 3: column rotation_degrees: \"1e7\" is beyond 1000000");
    EXPECT_EQ(fault("1,sky,0,nan\n"), "environment path, line 3: column hour: \"nan\" is not finite");
    EXPECT_EQ(fault("1,sky,0\n"), "environment path, line 3: only 3 values, expected 4");
    EXPECT_EQ(fault("1,a\x01.hdr,0,\n"),
              "environment path, line 3: column environment: \"a?.hdr\" is no name of a file");
}

TEST(EnvironmentPath, RefusesWhatIsNoPath) {
    for (const std::string& bad :
         {std::string(), std::string("\n"), kHeader, std::string("time_s,rotation_degrees\n0,0\n"),
          std::string("t,environment\n0,sky\n"), std::string("time_s,environment\n0,sky\n")}) {
        EXPECT_FALSE(parse(bad)) << bad;
    }
}

TEST(EnvironmentPath, TheNumberOfEnvironmentsIsBounded) {
    std::string text = "time_s,environment\n";
    for (int i = 0; i < 64; ++i) text += std::to_string(i) + "," + std::to_string(i) + ".hdr\n";
    EXPECT_TRUE(parse(text));
    EXPECT_TRUE(parse(text + "300,7.hdr\n"));
    EXPECT_NE(parse(text + "300,more.hdr\n").error().text().find("line 66"), std::string::npos);
}

TEST(EnvironmentPath, FilesAreMeantFromTheTablesFolder) {
    const auto folder = std::filesystem::temp_directory_path() / "citystream-environment-path-test";
    std::filesystem::create_directories(folder);
    const std::string file = (folder / "day.csv").string();
    std::ofstream(file) << kHeader << "0,skies/a.hdr,0,\n1,/b.hdr,0,\n2,sky,0,5\n";
    const auto path = read_environment_path(file);
    ASSERT_TRUE(path) << path.error().text();
    EXPECT_EQ(path->environments, (std::vector<std::string>{(folder / "skies/a.hdr").string(), "/b.hdr", "sky"}));
    std::ofstream(file) << "nothing\n";
    EXPECT_EQ(read_environment_path(file).error().text().rfind(file + ": environment path, line 1", 0), 0u);
    std::filesystem::remove_all(folder);
    EXPECT_EQ(read_environment_path(file).error().text(), file + ": cannot open the environment path");
}

TEST(EnvironmentPath, AnyTextIsAnErrorOrAPathWithFiniteMoments) {
    const std::string seed = kHeader + "0,sky,0,6\n1.5,a.hdr,90,\n2,b.exr,-30,\n40,sky,720,30\n";
    uint32_t state = 3;
    const auto random = [&state] { return (state = state * 1664525U + 1013904223U) >> 8; };
    size_t good = 0;
    for (size_t i = 0; i < 20000; ++i) {
        std::string text = seed;
        for (size_t k = 0; k < 1 + i % 3; ++k) {
            const size_t place = random() % text.size();
            static constexpr std::string_view kBytes = "0123456789.,-+e\n\r\t skyn\xff";
            if (random() % 3 == 0)
                text.erase(place, 1 + random() % 4);
            else
                text[place] = kBytes[random() % kBytes.size()];
        }
        const auto path = parse(text);
        if (!path) continue;
        ++good;
        ASSERT_FALSE(path->rows.empty());
        for (const double t : {path->rows.front().time_s, 0.7, 1.7, 30.0, path->rows.back().time_s}) {
            const auto moment = path->at(t);
            ASSERT_TRUE(std::isfinite(moment.rotation_degrees));
            ASSERT_NEAR(moment.parts[0].weight + moment.parts[1].weight, 1, 1e-12);
            for (const auto& part : moment.parts) {
                ASSERT_LT(part.environment, path->environments.size());
                ASSERT_TRUE(std::isfinite(part.hour) && part.weight >= 0);
            }
        }
    }
    EXPECT_GT(good, 1000u);
}

}  // namespace
}  // namespace citystream::client
