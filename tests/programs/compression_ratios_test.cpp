// The table of compression ratios that bench_atlas_city prints, recomputed from its own columns: the thesis's totals
// (tables 7 to 13) are ten times what theirs give.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/programs/program_runner.h"

namespace citystream::tests {
namespace {

using Json = nlohmann::json;

constexpr double kThesisPhotographs = 622130.85;  // MB of a level
constexpr double kRounding = 2e-3;                // of figures of four digits, and their quotients

std::vector<Json> lines_of(const std::string& text) {
    std::vector<Json> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(Json::parse(line));
    return lines;
}

/// Lines of the table, by setting and level.
std::map<std::string, std::map<std::string, Json>> table_of(const std::vector<Json>& lines) {
    std::map<std::string, std::map<std::string, Json>> table;
    for (const Json& line : lines) {
        if (line.contains("setting"))
            table[line["setting"].get<std::string>()][line["level"].get<std::string>()] = line;
    }
    return table;
}

TEST(CompressionRatios, OfAllLevelsAreUncompressedOverCompressedBytes) {
    const Outcome outcome =
        run({program("bench_atlas_city"), "--buildings", "60", "--textures", "56", "--sample", "4"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto table = table_of(lines_of(outcome.output));
    ASSERT_EQ(table.size(), 11U);
    for (const auto& [setting, levels] : table) {
        ASSERT_EQ(levels.size(), 4U) << setting;
        double megabytes = 0, photographs = 0;
        for (const char* level : {"0", "1", "2"}) {
            const Json& line = levels.at(level);
            const double of_level = line["mb"].get<double>() * line["ratio"].get<double>();
            megabytes += line["mb"].get<double>();
            if (photographs > 0) {
                EXPECT_NEAR(of_level, photographs / (level[0] - '0'), kRounding * of_level) << setting << level;
            }
            photographs += of_level;
        }
        const Json& all = levels.at("all");
        EXPECT_NEAR(all["mb"].get<double>(), megabytes, kRounding * megabytes) << setting;
        EXPECT_NEAR(all["ratio"].get<double>(), photographs / megabytes, kRounding * photographs / megabytes)
            << setting;
    }
}

TEST(CompressionRatios, OfTheThesisAreATenthOfWhatItPrints) {
    const Outcome outcome =
        run({program("bench_atlas_city"), "--buildings", "60", "--textures", "56", "--sample", "1"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
    const auto table = table_of(lines_of(outcome.output));
    const std::map<std::string, double> totals = {
        {"view only", 441396.86}, {"rmse:0.05", 177016.07}, {"rmse:0.1", 16432},   {"rmse:0.2", 326.33},
        {"hvse:0.1", 246778.16},  {"hvse:0.3", 57659.43},   {"hvse:0.5", 17995.80}};
    for (const auto& [setting, megabytes] : totals) {
        const Json& all = table.at(setting).at("all");
        const double ratio = 3 * kThesisPhotographs / megabytes;
        EXPECT_NEAR(all["thesis_ratio"].get<double>(), ratio, kRounding * ratio) << setting;
        EXPECT_NEAR(all["thesis_printed"].get<double>(), 10 * ratio, 0.02 * 10 * ratio) << setting;
    }
}

}  // namespace
}  // namespace citystream::tests
