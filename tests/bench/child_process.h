// A server under measurement: started as a child, ended with its owner.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace citystream::bench {

class ChildProcess {
  public:
    /// Starts `command` (found by PATH when it has no '/'); its stderr is dropped.
    explicit ChildProcess(const std::vector<std::string>& command);
    /// SIGTERM, and SIGKILL when that does not end it in five seconds.
    ~ChildProcess();
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// First line of its output that contains `text`; "" when it ends or `seconds` pass before.
    std::string line_with(const std::string& text, double seconds);

  private:
    pid_t pid_ = -1;
    int output_ = -1;
};

/// A TCP port of 127.0.0.1 that nobody listened on a moment ago.
uint16_t free_port();

/// Full path of a program in PATH or the usual folders of servers; "" when there is none.
std::string find_program(const std::string& name);

}  // namespace citystream::bench
