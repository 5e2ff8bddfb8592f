// The independent checker in Python reads what the writers wrote: cities of several shapes, and cities that were spoilt
// on purpose.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "tests/tiles/archive/temporary_folder.h"
#include "tests/tiles/tileset/synthetic_city.h"

namespace citystream::tiles::tileset {
namespace {

using archive::TemporaryFolder;

bool has_python() {
    return std::system("python3 --version >/dev/null 2>&1") == 0;
}

// Exit code of the checker on this city; 0: no defects.
int checked(const SyntheticCity& city) {
    const TemporaryFolder folder;
    const auto status = write_synthetic_city(city, folder / "city.3tz");
    EXPECT_TRUE(status.ok()) << (status.ok() ? "" : status.error().text());
    const std::string command = "python3 \"" CITYSTREAM_SOURCE_DIR "/tests/conformance/check_tileset.py\" \"" +
                                (folder / "city.3tz") + "\" >\"" + (folder / "log") + "\" 2>&1";
    const int result = std::system(command.c_str());
    if (result != 0) ::testing::Test::RecordProperty("log", folder / "log");
    return WEXITSTATUS(result);
}

TEST(Conformance, DirectoriesFollow3DTiles11) {
    if (!has_python()) GTEST_SKIP() << "python3 is not installed";
    EXPECT_EQ(checked(make_synthetic_city(1, 6, 3)), 0);
    EXPECT_EQ(checked(make_synthetic_city(2, 5, 1)), 0);
    EXPECT_EQ(checked(make_synthetic_city(3, 1, 8)), 0);
    EXPECT_EQ(checked(make_synthetic_city(4, 7, 4)), 0);
}

TEST(Conformance, TheCheckerFindsSpoiltDirectories) {
    if (!has_python()) GTEST_SKIP() << "python3 is not installed";
    const auto spoilt = [](auto spoil) {
        SyntheticCity city = make_synthetic_city(1, 4, 2);
        spoil(city);
        return checked(city);
    };
    EXPECT_EQ(spoilt([](SyntheticCity& city) { city.manifest.tiles += 1; }), 1);
    EXPECT_EQ(spoilt([](SyntheticCity& city) { city.subtrees[0].child_subtrees.pop_back(); }), 1);
    EXPECT_EQ(spoilt([](SyntheticCity& city) { city.subtrees[0].tiles[0].steps(Layer::kMesh).back().end += 1; }), 1);
    EXPECT_EQ(spoilt([](SyntheticCity& city) { city.subtrees[0].tiles[0].bounds.max[2] += 500; }), 1);
    EXPECT_EQ(spoilt([](SyntheticCity& city) { city.subtrees[0].tiles[0].geometric_error = 1000; }), 1);
    EXPECT_EQ(spoilt([](SyntheticCity& city) { city.entries.erase(layer_path(Layer::kMesh, {0, 0, 0})); }), 1);
    EXPECT_EQ(spoilt([](SyntheticCity& city) { city.manifest.levels += 1; }), 1);
}

}  // namespace
}  // namespace citystream::tiles::tileset
