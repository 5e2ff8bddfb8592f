// The program citystream-serve as a user starts it.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include "tests/server/raw_client.h"
#include "tests/server/synthetic_city.h"

namespace citystream::server {
namespace {

const std::string kProgram = std::string(CITYSTREAM_BIN_DIR) + "/citystream-serve";

/// A child process with its output in files; killed when it is still there at the end.
class Program {
  public:
    Program(const std::vector<std::string>& arguments, const test::TemporaryFolder& folder)
        : out_(folder / "stdout"), err_(folder / "stderr") {
        std::filesystem::remove(out_);
        child_ = ::fork();
        if (child_ == 0) {
            ::dup2(::open(out_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), 1);
            ::dup2(::open(err_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), 2);
            std::vector<char*> argv = {const_cast<char*>(kProgram.c_str())};
            for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
            argv.push_back(nullptr);
            ::execv(kProgram.c_str(), argv.data());
            ::_exit(127);
        }
    }
    ~Program() {
        if (child_ <= 0) return;
        ::kill(child_, SIGKILL);
        ::waitpid(child_, nullptr, 0);
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;

    /// The port that the first line of output names; nothing when the program ended or 10 s passed.
    std::optional<uint16_t> port() const {
        static const std::regex kLine("(?:listening on |\"listening\":\")http://127\\.0\\.0\\.1:([0-9]+)");
        for (int i = 0; i < 500; ++i) {
            std::smatch match;
            const std::string text = read(out_);
            if (text.find('\n') != std::string::npos && std::regex_search(text, match, kLine))
                return static_cast<uint16_t>(std::stoi(match[1]));
            ::usleep(20'000);
        }
        return std::nullopt;
    }
    void signal(int number) const { ::kill(child_, number); }
    /// The exit code, or -1 when the program did not end by itself within 10 s.
    int exit_code() {
        for (int i = 0; i < 500; ++i) {
            int status = 0;
            if (::waitpid(child_, &status, WNOHANG) == child_) {
                child_ = 0;
                return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
            }
            ::usleep(20'000);
        }
        return -1;
    }
    std::string output() const { return read(out_); }
    std::string errors() const { return read(err_); }

  private:
    static std::string read(const std::string& file) {
        std::ifstream stream(file);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    std::string out_, err_;
    pid_t child_ = 0;
};

class ServeProgram : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::filesystem::exists(kProgram)) GTEST_SKIP() << kProgram << " has not been built";
        test::write_city(folder_ / "demo.3tz", "Demo", true);
    }
    size_t lines(const std::string& text) { return static_cast<size_t>(std::count(text.begin(), text.end(), '\n')); }
    test::TemporaryFolder folder_;
};

TEST_F(ServeProgram, AnnouncesItsPortServesAndEndsCleanlyOnASignal) {
    for (const int number : {SIGINT, SIGTERM}) {
        Program program({folder_ / "demo.3tz", "--listen", "127.0.0.1:0", "--threads", "2"}, folder_);
        const auto port = program.port();
        ASSERT_TRUE(port) << program.errors();
        EXPECT_EQ(test::RawClient(*port).ask("/demo/tiles/0/0/0.mesh").body, test::mesh_bytes());
        program.signal(number);
        EXPECT_EQ(program.exit_code(), 0);
        EXPECT_EQ(program.errors(), "");
    }
}

TEST_F(ServeProgram, FinishesADownloadBeforeItEnds) {
    Program program({folder_ / "demo.3tz", "--listen", "127.0.0.1:0", "--json"}, folder_);
    const auto port = program.port();
    ASSERT_TRUE(port) << program.errors();
    test::RawClient client(*port, 4096);
    client.get("/demo/tiles/large");
    ::usleep(100'000);
    program.signal(SIGTERM);
    EXPECT_TRUE(client.answer().body == test::large_bytes());
    EXPECT_EQ(program.exit_code(), 0);
    EXPECT_NE(program.output().find("\"stopped\":true,\"requests\":1,"), std::string::npos) << program.output();
}

TEST_F(ServeProgram, FailsWithOneLineWhenAFileCannotBeServed) {
    std::ofstream(folder_ / "text.3tz") << std::string(1000, 'x');
    for (const char* name : {"missing.3tz", "text.3tz"}) {
        Program program({folder_ / "demo.3tz", folder_ / name, "--listen", "127.0.0.1:0"}, folder_);
        EXPECT_EQ(program.exit_code(), 1) << name;
        EXPECT_EQ(lines(program.errors()), 1u) << program.errors();
        EXPECT_NE(program.errors().find(name), std::string::npos) << program.errors();
    }
}

TEST_F(ServeProgram, FailsWithOneLineWhenThePortIsTaken) {
    const test::TemporaryFolder other;
    Program first({folder_ / "demo.3tz", "--listen", "127.0.0.1:0"}, folder_);
    const auto port = first.port();
    ASSERT_TRUE(port);
    Program second({folder_ / "demo.3tz", "--listen", "127.0.0.1:" + std::to_string(*port)}, other);
    EXPECT_EQ(second.exit_code(), 1);
    EXPECT_EQ(lines(second.errors()), 1u) << second.errors();
    EXPECT_NE(second.errors().find("in use"), std::string::npos) << second.errors();
}

TEST_F(ServeProgram, WrongUsageEndsWithCodeTwo) {
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{},
                                                      {"--unknown"},
                                                      {"x.3tz", "--listen", "nonsense"},
                                                      {"x.3tz", "--idle-timeout", "soon"},
                                                      {"x.3tz", "--threads", "-1"}}) {
        Program program(arguments, folder_);
        EXPECT_EQ(program.exit_code(), 2);
        EXPECT_NE(program.errors(), "");
    }
}

TEST_F(ServeProgram, ExplainsItself) {
    Program help({"--help"}, folder_);
    EXPECT_EQ(help.exit_code(), 0);
    EXPECT_NE(help.output().find("Examples:"), std::string::npos);
    Program version({"--version"}, folder_);
    EXPECT_EQ(version.exit_code(), 0);
    EXPECT_NE(version.output().find("citystream-serve "), std::string::npos);
}

}  // namespace
}  // namespace citystream::server
