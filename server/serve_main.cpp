// citystream-serve: serves 3TZ archives over HTTP.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "command_line/command_line.h"
#include "server/server.h"

namespace {

using namespace citystream;

constexpr const char* kExamples = R"(Examples:
  citystream-serve city.3tz
  citystream-serve city.3tz harbour.3tz --listen 0.0.0.0:8080 --threads 4
  citystream-serve city.3tz --listen 127.0.0.1:0      # any free port; the first line of output names it
Then: http://HOST:PORT/ (pages), /cities.json, /NAME/tileset.json, /healthz, /metrics.
Archives are read once at start; to serve a rebuilt city, start again.)";

struct Arguments {
    std::vector<std::string> archives;
    std::string listen = "127.0.0.1:8080";
    std::string idle_timeout = "30s";
    uint32_t threads = 0;
    uint32_t max_connections = 4096;
    bool json = false;
};

int fail(const std::string& message, int code) {
    fmt::print(stderr, "citystream-serve: {}\n", message);
    return code;
}

/// The line that scripts wait for.
void announce(const server::Server& running, const std::vector<std::string>& names, bool json) {
    if (json) {
        std::string list;
        for (const auto& name : names) list += fmt::format("{}\"{}\"", list.empty() ? "" : ",", name);
        fmt::print("{{\"listening\":\"{}\",\"port\":{},\"cities\":[{}]}}\n", running.url(), running.port(), list);
    } else {
        fmt::print("listening on {}\n", running.url());
        for (const auto& name : names) fmt::print("  {}/{}/\n", running.url(), name);
    }
    std::fflush(stdout);
}

int serve(const Arguments& arguments) {
    const auto listen = server::ListenAddress::parse(arguments.listen);
    if (!listen) return fail("--listen: " + listen.error().text(), 2);
    const auto idle_timeout = server::parse_duration(arguments.idle_timeout);
    if (!idle_timeout) return fail("--idle-timeout: " + idle_timeout.error().text(), 2);

    auto catalog = server::ArchiveCatalog::open(arguments.archives);
    if (!catalog) return fail(catalog.error().text(), 1);
    for (const auto& remark : catalog->remarks()) fmt::print(stderr, "citystream-serve: {}\n", remark);
    std::vector<std::string> names;
    for (const auto& city : catalog->cities()) names.push_back(city.name);

    server::ServerOptions options;
    options.listen = *listen;
    options.idle_timeout = *idle_timeout;
    options.threads = arguments.threads;
    options.max_connections = arguments.max_connections;
    auto running = server::Server::start(std::move(*catalog), options);
    if (!running) return fail(running.error().text(), 1);
    (*running)->stop_on_signals();
    if ((*running)->max_connections() < arguments.max_connections) {
        fmt::print(stderr,
                   "citystream-serve: only {} connections fit the limit of open files (raise it with ulimit -n)\n",
                   (*running)->max_connections());
    }
    announce(**running, names, arguments.json);
    (*running)->wait();

    const auto summary = (*running)->summary();
    if (arguments.json) {
        fmt::print("{{\"stopped\":true,\"requests\":{},\"sent_bytes\":{}}}\n", summary.requests, summary.sent_bytes);
    } else {
        fmt::print("stopped after {} requests, {} bytes sent\n", summary.requests, summary.sent_bytes);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    Arguments arguments;
    CLI::App app{"Serves city archives (3TZ) over HTTP.", "citystream-serve"};
    app.footer(kExamples);
    app.set_version_flag("--version", std::string("citystream-serve " CITYSTREAM_VERSION));
    app.add_option("CITY.3tz", arguments.archives, "Archives to serve, each under /NAME/ (NAME: the file's stem)")
        ->required();
    app.add_option("--listen", arguments.listen, "Address and port; port 0 takes any free one")->capture_default_str();
    app.add_option("--threads", arguments.threads, "Worker threads; 0 is one per processor")
        ->check(command_line::number_from(0, 1024));
    app.add_option("--idle-timeout", arguments.idle_timeout,
                   "Longest wait for a request's head or for progress of an answer")
        ->capture_default_str();
    app.add_option("--max-connections", arguments.max_connections, "Connections beyond this are answered with 503")
        ->check(command_line::number_from(1, 1'000'000))
        ->capture_default_str();
    app.add_flag("--json", arguments.json, "Announce and summarise as JSON lines");
    if (const auto ended = command_line::read_arguments(app, argc, argv)) return *ended;
    return serve(arguments);
}
