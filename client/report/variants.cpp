#include "client/report/variants.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string_view>

#include <fmt/format.h>

namespace citystream::client {
namespace {

/// Runs a program to its end; its output is dropped, its errors go where ours go.
Status run_program(const std::vector<std::string>& command) {
    std::vector<char*> words;
    words.reserve(command.size() + 1);
    for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = -1;
    const int failed = posix_spawnp(&child, words[0], &actions, nullptr, words.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) return Error{command[0] + ": cannot be started: " + std::strerror(failed)};
    int state = 0;
    while (waitpid(child, &state, 0) < 0) {
        if (errno != EINTR) return Error{command[0] + ": " + std::strerror(errno)};
    }
    if (WIFEXITED(state) && WEXITSTATUS(state) == 0) return Done{};
    return Error{fmt::format("{} failed: {}", command[0], fmt::join(command.begin() + 1, command.end(), " "))};
}

}  // namespace

bool is_built(const std::string& knob) {
    constexpr std::array<std::string_view, 11> kBuilt = {
        "saliency",   "rate-distortion", "mesh-transport", "normal-bits",      "mesh-topology",     "precision",
        "mesh-steps", "lattice",         "directions",     "local-directions", "radiance-transport"};
    return std::find(kBuilt.begin(), kBuilt.end(), knob) != kBuilt.end();
}

std::string find_builder() {
    std::error_code failed;
    const auto beside = std::filesystem::read_symlink("/proc/self/exe", failed).replace_filename("citystream-build");
    return !failed && std::filesystem::exists(beside, failed) ? beside.string() : "citystream-build";
}

std::vector<std::string> build_command(const VariantOptions& options, const Setting& setting,
                                       const std::string& archive) {
    std::vector<std::string> command = {options.builder};
    command.insert(command.end(), options.arguments.begin(), options.arguments.end());
    command.insert(command.end(), {"--" + setting.knob, setting.value_text(), "-o", archive});
    return command;
}

Status build_variants(const VariantOptions& options, std::vector<Setting>& settings) {
    if (std::none_of(settings.begin(), settings.end(), [](const Setting& one) { return is_built(one.knob); }))
        return Done{};
    std::error_code failed;
    std::filesystem::create_directories(options.folder, failed);
    if (failed) return Error{options.folder + ": " + failed.message()};
    for (Setting& setting : settings) {
        if (!is_built(setting.knob)) continue;
        setting.place = (std::filesystem::path(options.folder) / (setting.file_prefix() + ".3tz")).string();
        if (options.progress) options.progress(fmt::format("building {} {}", setting.knob, setting.label()));
        if (Status built = run_program(build_command(options, setting, setting.place)); !built) return built.error();
    }
    return Done{};
}

}  // namespace citystream::client
