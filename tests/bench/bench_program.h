// What every bench program does alike: its options, its JSON lines, its checks and its exit code.
#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/bench/measure.h"

namespace citystream::bench {

using Json = nlohmann::ordered_json;

/// {"min":..,"median":..,"max":..}, rounded to four significant digits.
Json to_json(const Spread& spread);

/// A number rounded to four significant digits, for printing.
double rounded(double value);

/// Options of all bench programs; a program sets its own defaults and says what its FILEs are.
struct BenchOptions {
    std::vector<std::string> files;
    uint32_t buildings = 500;  ///< of the generated city
    uint64_t seed = 1;
    int repetitions = 7;
    bool split = false;  ///< parts of each case on lines of their own, too
};

/// An option that only one program has.
struct BenchOption {
    std::string name, help;                          ///< "--texel"
    std::function<bool(const std::string&)> accept;  ///< takes the text; false: wrong usage
};

struct BenchDescription {
    std::string name, claim;  ///< the claim is the help text: what is compared with what, and what the fields mean
    std::string files;        ///< what FILE arguments are; empty: the program takes none
    bool generates = true;    ///< has --buildings and --seed
    std::string parts = {};   ///< what --split shows; empty: the program has no --split
    std::vector<BenchOption> options = {};
};

class BenchProgram {
  public:
    explicit BenchProgram(BenchDescription description) : description_(std::move(description)) {}

    /// Reads the arguments into `options`. False: the program is to end with exit_code() (help, wrong usage).
    bool read_arguments(int argc, char** argv, BenchOptions& options);

    /// Prints one line, with the bench's name first.
    void print(const Json& fields) const;
    void print_skipped(const std::string& why) const { print({{"skipped", why}}); }

    /// Something that must hold: says so on stderr and makes the exit code 1 when it does not. Returns `holds`.
    bool check(bool holds, const std::string& what);
    int exit_code() const { return exit_code_; }

  private:
    BenchDescription description_;
    int exit_code_ = 0;
};

}  // namespace citystream::bench
