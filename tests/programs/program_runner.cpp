#include "tests/programs/program_runner.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>

namespace citystream::tests {
namespace {

using Clock = std::chrono::steady_clock;

pid_t start(const std::vector<std::string>& command, int output, int error) {
    std::vector<char*> arguments;
    for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const pid_t pid = fork();
    if (pid != 0) return pid;
    dup2(output, STDOUT_FILENO);
    dup2(error, STDERR_FILENO);
    execvp(arguments[0], arguments.data());
    _exit(127);
}

int exit_code_of(int status) {
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// Waits for the end of a process, killing it at the deadline.
int wait_until(pid_t pid, Clock::time_point deadline) {
    int status = 0;
    while (waitpid(pid, &status, WNOHANG) == 0) {
        if (Clock::now() > deadline) {
            kill(pid, SIGKILL);
            waitpid(pid, &status, 0);
            return -1;
        }
        usleep(5000);
    }
    return exit_code_of(status);
}

}  // namespace

std::string program(const std::string& name) {
    return std::string(CITYSTREAM_BIN_DIR) + "/" + name;
}

Outcome run(const std::vector<std::string>& command, int seconds) {
    const TemporaryFolder folder;
    const std::string output = folder / "stdout", error = folder / "stderr";
    const int out = open(output.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600),
              err = open(error.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600);
    const pid_t pid = start(command, out, err);
    Outcome outcome;
    outcome.exit_code = wait_until(pid, Clock::now() + std::chrono::seconds(seconds));
    close(out);
    close(err);
    outcome.output = read_file(output);
    outcome.error = read_file(error);
    return outcome;
}

Background::Background(const std::vector<std::string>& command, const std::string& until, int seconds) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return;
    // Servers log every request to stderr.
    const int silence = open("/dev/null", O_WRONLY | O_CLOEXEC);
    pid_ = start(command, ends[1], silence);
    close(silence);
    close(ends[1]);
    output_ = ends[0];
    std::string text;
    const auto deadline = Clock::now() + std::chrono::seconds(seconds);
    while (Clock::now() < deadline) {
        pollfd waiting{output_, POLLIN, 0};
        if (poll(&waiting, 1, 100) <= 0) continue;
        char buffer[512];
        const ssize_t count = read(output_, buffer, sizeof buffer);
        if (count <= 0) return;
        text.append(buffer, static_cast<size_t>(count));
        const size_t found = text.find(until);
        const size_t line_end = found == std::string::npos ? found : text.find('\n', found);
        if (line_end == std::string::npos) continue;
        const size_t line_begin = text.rfind('\n', found) + 1;
        ready_line_ = text.substr(line_begin, line_end - line_begin);
        return;
    }
}

Background::~Background() {
    if (pid_ > 0) stop(SIGKILL);
    if (output_ >= 0) close(output_);
}

int Background::stop(int signal) {
    if (pid_ <= 0) return -1;
    kill(pid_, signal);
    const int code = wait_until(pid_, Clock::now() + std::chrono::seconds(30));
    pid_ = -1;
    return code;
}

std::string url_in(const std::string& line) {
    const size_t begin = line.find("http://");
    return begin == std::string::npos ? "" : line.substr(begin, line.find_first_of(" )\t\r\n", begin) - begin);
}

std::string read_file(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
}

void write_file(const std::string& file, const std::string& text) {
    std::ofstream(file, std::ios::binary) << text;
}

const std::string& shared_city() {
    static const TemporaryFolder folder;
    static const std::string city = [] {
        std::string archive = folder / "city.3tz";
        const Outcome built = run({program("citystream-build"), "generate", "--buildings", "300", "--seed", "7", "-o",
                                   archive, "--reference", folder / "city.glb"});
        EXPECT_EQ(built.exit_code, 0) << built.error;
        return archive;
    }();
    return city;
}

}  // namespace citystream::tests
