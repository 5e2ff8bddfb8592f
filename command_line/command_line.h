// What the command lines of all programs do alike: wrong usage is one clear line on stderr and exit code 2, and numbers
// are checked as numbers.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>

namespace citystream::command_line {

inline constexpr int kFailed = 1, kWrongUsage = 2;

/// Numbers from `least` to `most`. CLI::Range lets nan through, which is neither below nor above anything.
template <typename Number>
CLI::Validator number_from(Number least, Number most) {
    const std::string range = fmt::format("{} to {}", least, most);
    const auto fault = [least, most, range](std::string& text) {
        Number value{};
        const bool inside = CLI::detail::lexical_cast(text, value) && value >= least && value <= most;
        return inside ? std::string() : fmt::format("{} is not a number from {}", text, range);
    };
    return CLI::Validator(fault, range);
}

/// `word`, or what `other` takes.
inline CLI::Validator word_or(const std::string& word, const CLI::Validator& other) {
    const std::string both = word + " or " + other.get_description();
    const auto fault = [word, other, both](std::string& text) {
        return text == word || other(text).empty() ? std::string() : fmt::format("{} is not {}", text, both);
    };
    return CLI::Validator(fault, both);
}

/// What has a name: "" is as if the option were not there, which nobody means who types it.
inline CLI::Validator not_empty() {
    return CLI::Validator([](std::string& text) { return text.empty() ? std::string("empty") : std::string(); }, "");
}

/// The program's name as it was called, without its folder.
inline std::string program_name(const CLI::App& app) {
    return std::filesystem::path(app.get_name()).filename().string();
}

/// Reads the arguments. Nothing: go on. Else the program is to end with this: 0 after --help or --version, kWrongUsage
/// after a line that says what is wrong.
inline std::optional<int> read_arguments(CLI::App& app, int argc, const char* const* argv) {
    app.failure_message([](const CLI::App* failed, const CLI::Error& error) {
        std::string line = fmt::format("{}: {}; see --help", program_name(*failed), error.what());
        std::replace(line.begin(), line.end(), '\n', ' ');
        return line + '\n';
    });
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : kWrongUsage;
    }
    return std::nullopt;
}

}  // namespace citystream::command_line
