#include "client/path/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace citystream::client {
namespace {

Result<CameraPath> parse(const std::string& text) {
    return parse_camera_path(std::span(text.data(), text.size()));
}

const std::string kHeader = "t,x,y,z,yaw,pitch,fov\n";

TEST(CameraPath, ReadsColumnsInAnyOrder) {
    const auto path = parse("fov,yaw,t,z,y,x,pitch\r\n60, 90,0,3,2,1,-10\r\n\r\n61,95,+1.5,6,5,4,-20\n");
    ASSERT_TRUE(path) << path.error().text();
    ASSERT_EQ(path->samples.size(), 2u);
    EXPECT_EQ(path->samples[0].x, 1);
    EXPECT_EQ(path->samples[0].y, 2);
    EXPECT_EQ(path->samples[0].z, 3);
    EXPECT_EQ(path->samples[1].t, 1.5);
    EXPECT_EQ(path->samples[1].pitch, -20);
    EXPECT_EQ(path->duration(), 1.5);
}

TEST(CameraPath, NamesLineAndColumnOfABadNumber) {
    const auto path = parse(kHeader + "0,1,2,3,0,0,60\n1,1,oops,3,0,0,60\n");
    ASSERT_FALSE(path);
    EXPECT_NE(path.error().text().find("line 3"), std::string::npos) << path.error().text();
    EXPECT_NE(path.error().text().find("column y"), std::string::npos) << path.error().text();
}

TEST(CameraPath, RejectsWhatIsNoPath) {
    for (const std::string& bad :
         {std::string(), std::string("\n\n"), kHeader, std::string("t,x,y,z,yaw,pitch\n0,0,0,0,0,0\n"),
          std::string("t,x,y,z,yaw,pitch,roll\n0,0,0,0,0,0,0\n"),
          std::string("t,t,y,z,yaw,pitch,fov\n0,0,0,0,0,0,60\n"), kHeader + "0,nan,0,0,0,0,60\n",
          kHeader + "0,0,inf,0,0,0,60\n", kHeader + "0,1e300,0,0,0,0,60\n", kHeader + "0,0,0,0,0,95,60\n",
          kHeader + "0,0,0,0,0,0,0\n", kHeader + "0,0,0,0,0,0,180\n", kHeader + "0,0,0,0,0,0\n",
          kHeader + "0,0,0,0,0,0,60,7\n", kHeader + "0,,0,0,0,0,60\n", kHeader + "0,1.5x,0,0,0,0,60\n"}) {
        EXPECT_FALSE(parse(bad)) << bad;
    }
}

TEST(CameraPath, RejectsTimeThatDoesNotGrow) {
    EXPECT_FALSE(parse(kHeader + "0,0,0,0,0,0,60\n0,0,0,0,0,0,60\n"));
    EXPECT_FALSE(parse(kHeader + "1,0,0,0,0,0,60\n0.5,0,0,0,0,0,60\n"));
    EXPECT_TRUE(parse(kHeader + "1,0,0,0,0,0,60\n1.5,0,0,0,0,0,60"));
}

TEST(CameraPath, InterpolatesAndTurnsTheShortWay) {
    const auto path = parse(kHeader + "0,0,0,0,350,0,60\n2,10,20,30,10,-10,80\n");
    ASSERT_TRUE(path);
    const CameraSample middle = path->at(1);
    EXPECT_DOUBLE_EQ(middle.x, 5);
    EXPECT_DOUBLE_EQ(middle.z, 15);
    EXPECT_NEAR(std::remainder(middle.yaw, 360.0), 0, 1e-9);
    EXPECT_DOUBLE_EQ(middle.fov, 70);
    EXPECT_EQ(path->at(-5).x, 0);
    EXPECT_EQ(path->at(50).x, 10);
}

TEST(CameraPath, SaysWhichFileCannotBeOpened) {
    const auto path = read_camera_path("/nonexistent/tour.csv");
    ASSERT_FALSE(path);
    EXPECT_NE(path.error().text().find("/nonexistent/tour.csv"), std::string::npos);
}

}  // namespace
}  // namespace citystream::client
