#include "tests/bench/bench_program.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>

#include "command_line/command_line.h"

namespace citystream::bench {

double rounded(double value) {
    if (value == 0 || !std::isfinite(value)) return value;
    const double scale = std::pow(10.0, 3 - std::floor(std::log10(std::abs(value))));
    return std::round(value * scale) / scale;
}

Json to_json(const Spread& spread) {
    return {{"min", rounded(spread.min)}, {"median", rounded(spread.median)}, {"max", rounded(spread.max)}};
}

bool BenchProgram::read_arguments(int argc, char** argv, BenchOptions& options) {
    CLI::App app{description_.claim, description_.name};
    app.footer(
        fmt::format("Prints one JSON line per case; exit code 1 when a result is wrong.\nExamples:\n  {0}\n  {0} "
                    "--repetitions 15{1}",
                    description_.name, description_.files.empty() ? "" : " " + description_.files));
    if (!description_.files.empty())
        app.add_option("FILE", options.files, description_.files)->check(CLI::ExistingPath);
    if (description_.generates) {
        app.add_option("--buildings", options.buildings, "of the generated city")
            ->check(command_line::number_from(1, 1'000'000))
            ->capture_default_str();
        app.add_option("--seed", options.seed, "of the generated city")->capture_default_str();
    }
    if (!description_.parts.empty()) app.add_flag("--split", options.split, description_.parts);
    app.add_option("--repetitions", options.repetitions, "of each measurement")
        ->check(command_line::number_from(1, 1000))
        ->capture_default_str();
    for (const BenchOption& option : description_.options) {
        const auto accept = [&option](const std::string& text) {
            if (!option.accept(text)) throw CLI::ValidationError(option.name, text + " is not: " + option.help);
        };
        app.add_option_function<std::string>(option.name, accept, option.help);
    }
    const auto ended = command_line::read_arguments(app, argc, argv);
    exit_code_ = ended.value_or(0);
    return !ended;
}

void BenchProgram::print(const Json& fields) const {
    Json line{{"bench", description_.name}};
    line.update(fields);
    fmt::print("{}\n", line.dump(-1, ' ', false, Json::error_handler_t::replace));
    std::fflush(stdout);
}

bool BenchProgram::check(bool holds, const std::string& what) {
    if (!holds) {
        fmt::print(stderr, "{}: does not hold: {}\n", description_.name, what);
        exit_code_ = 1;
    }
    return holds;
}

}  // namespace citystream::bench
