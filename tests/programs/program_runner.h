// Runs the project's programs as a user would: real binaries, their output and exit codes.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "tests/temporary_folder.h"

namespace citystream::tests {

struct Outcome {
    int exit_code = -1;  ///< -1: ended by a signal
    std::string output;  ///< stdout
    std::string error;   ///< stderr
};

/// Path of a program built beside the tests.
std::string program(const std::string& name);

/// Runs and waits; kills (and reports exit code -1) after `seconds`.
Outcome run(const std::vector<std::string>& command, int seconds = 240);

/// A process in the background, ended on destruction.
class Background {
  public:
    /// Starts and waits (at most `seconds`) until a line of its stdout contains `until`; ready_line() is that line (""
    /// when it never came).
    Background(const std::vector<std::string>& command, const std::string& until, int seconds = 30);
    ~Background();
    Background(const Background&) = delete;
    Background& operator=(const Background&) = delete;
    const std::string& ready_line() const { return ready_line_; }
    pid_t pid() const { return pid_; }
    /// Sends a signal and waits; the exit code, -1 when ended by a signal.
    int stop(int signal);

  private:
    pid_t pid_ = -1;
    int output_ = -1;
    std::string ready_line_;
};

/// "http://127.0.0.1:PORT" out of a server's ready line.
std::string url_in(const std::string& line);

std::string read_file(const std::string& file);
void write_file(const std::string& file, const std::string& text);

/// The 300-building city that these tests share, built once a test program run, with its reference .glb beside it.
const std::string& shared_city();

}  // namespace citystream::tests
