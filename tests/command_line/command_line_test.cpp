#include "command_line/command_line.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace citystream::command_line {
namespace {

/// What a program with one number and one count prints on stderr, and how it ends.
struct Ended {
    std::optional<int> code;
    std::string error;
};

Ended call(const std::vector<std::string>& words) {
    CLI::App app{"A program."};
    double number = 0;
    uint32_t count = 0;
    app.add_option("--number", number)->check(number_from(0.01, 1e6));
    app.add_option("--count", count)->check(word_or("0", number_from(56U, 1000U)));
    std::vector<const char*> arguments = {"/some/folder/program"};
    for (const std::string& word : words) arguments.push_back(word.c_str());
    testing::internal::CaptureStderr();
    Ended ended;
    ended.code = read_arguments(app, static_cast<int>(arguments.size()), arguments.data());
    ended.error = testing::internal::GetCapturedStderr();
    return ended;
}

TEST(CommandLine, NumbersWithinTheirRangeAreTaken) {
    for (const char* good : {"0.01", "1", "1e6", "2.5e-1", "+3"}) {
        const Ended ended = call({"--number", good});
        EXPECT_FALSE(ended.code) << good << ended.error;
        EXPECT_EQ(ended.error, "") << good;
    }
    for (const char* good : {"0", "56", "1000"}) EXPECT_FALSE(call({"--count", good}).code) << good;
}

TEST(CommandLine, WhatIsNoNumberOrOutOfRangeIsOneLineAndWrongUsage) {
    const auto refused = [](const std::string& option, const std::string& value) {
        const Ended ended = call({option, value});
        ASSERT_EQ(ended.code, kWrongUsage) << value;
        EXPECT_TRUE(ended.error.starts_with("program: ")) << ended.error;
        EXPECT_EQ(std::count(ended.error.begin(), ended.error.end(), '\n'), 1) << ended.error;
        EXPECT_NE(ended.error.find(option), std::string::npos) << ended.error;
        const std::string first_word = value.substr(0, value.find('\n'));
        EXPECT_NE(ended.error.find(first_word), std::string::npos) << ended.error;
    };
    for (const char* bad : {"nan", "NAN", "-nan", "nan(1)", "inf", "-inf", "0", "0.0099", "1000001", "1x", "x", "1\n2"})
        refused("--number", bad);
    for (const char* bad : {"-3", "1", "55", "1001", "nan", "many"}) refused("--count", bad);
    EXPECT_NE(call({"--count", "-3"}).error.find("-3 is not 0 or 56 to 1000"), std::string::npos);
}

TEST(CommandLine, HelpEndsWellAndWhatIsUnknownDoesNot) {
    testing::internal::CaptureStdout();
    EXPECT_EQ(call({"--help"}).code, 0);
    EXPECT_NE(testing::internal::GetCapturedStdout().find("A program."), std::string::npos);
    EXPECT_EQ(call({"--unknown"}).code, kWrongUsage);
}

}  // namespace
}  // namespace citystream::command_line
