// Claim: citystream-serve answers range requests from an archive as fast as a web server answers them from files.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>

#include "tests/bench/bench_program.h"
#include "tests/bench/child_process.h"
#include "tests/bench/loopback_client.h"
#include "tests/bench/sample_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;

constexpr const char* kClaim =
    "Ranges of 16, 64 and 256 KiB over 1, 2, 4 and 8 keep-alive connections on the loopback interface: the real "
    "citystream-serve on an archive,\n"
    "against nginx (sendfile) on the unpacked city, in turn. throughput_to_nginx: our bytes a second over nginx's in "
    "the same repetition (the client\n"
    "shares the processors with both). p50/p99 in microseconds. Every answer is compared with the archive's bytes. "
    "Without nginx: ours alone.";
constexpr double kSlice = 0.2;  ///< seconds of load per server, case and repetition
constexpr uint64_t kLeastFile = 256 << 10;
constexpr size_t kMostFiles = 32;

/// nginx with one worker per processor, as its authors recommend for static files; but without tcp_nopush, which on the
/// loopback interface (segments of 64 KiB) holds back answers of about that size for 40 ms and would flatter us.
std::string nginx_configuration(const TemporaryFolder& folder, const std::string& root, uint16_t port) {
    return fmt::format(
        "worker_processes auto;\nerror_log {0};\npid {1};\ndaemon off;\nevents {{ worker_connections 256; }}\n"
        "http {{ access_log off; sendfile on; tcp_nopush off; tcp_nodelay on; keepalive_requests 100000000; "
        "open_file_cache max=1000;\n"
        "  client_body_temp_path {2}; proxy_temp_path {2}; fastcgi_temp_path {2}; uwsgi_temp_path {2}; scgi_temp_path "
        "{2};\n"
        "  server {{ listen 127.0.0.1:{3}; root {4}; }} }}\n",
        folder / "error.log", folder / "nginx.pid", folder / "temp", port, root);
}

bool unpack(const SampleCity& city, const std::string& folder) {
    for (const auto& entry : city.archive->entries()) {
        const std::filesystem::path file = std::filesystem::path(folder) / entry.name;
        std::filesystem::create_directories(file.parent_path());
        const auto bytes = city.archive->find(entry.name);
        if (!std::ofstream(file, std::ios::binary)
                 .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())))
            return false;
    }
    // nginx drops its rights when it is started as root.
    std::filesystem::permissions(std::filesystem::path(folder).parent_path().parent_path(),
                                 std::filesystem::perms::others_exec, std::filesystem::perm_options::add);
    return true;
}

std::vector<ServedFile> large_files(const SampleCity& city, const std::string& base) {
    std::vector<ServedFile> files;
    for (const auto& entry : city.archive->entries()) {
        if (entry.size >= kLeastFile && files.size() < kMostFiles)
            files.push_back({base + entry.name, city.archive->find(entry.name)});
    }
    return files;
}

uint16_t port_in(const std::string& line) {
    const size_t at = line.find("\"port\":");
    return at == std::string::npos ? uint16_t{0}
                                   : static_cast<uint16_t>(std::strtoul(line.c_str() + at + 7, nullptr, 10));
}

double percentile(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return values[static_cast<size_t>(rank)];
}

/// Results of one server over the repetitions of a case.
struct Series {
    std::vector<double> gigabytes_per_second, p50, p99;
    std::string failure;
    void add(const RangeResult& result) {
        if (failure.empty()) failure = result.failure;
        gigabytes_per_second.push_back(static_cast<double>(result.bytes) / result.seconds / 1e9);
        p50.push_back(percentile(result.latencies, 0.5) * 1e6);
        p99.push_back(percentile(result.latencies, 0.99) * 1e6);
    }
    Json json() const {
        return {{"GB_per_s", to_json(spread_of(gigabytes_per_second))},
                {"p50_us", to_json(spread_of(p50))},
                {"p99_us", to_json(spread_of(p99))}};
    }
};

struct Servers {
    uint16_t ours = 0, nginx = 0;  ///< ports; 0: not running
};

void measure_case(const Servers& servers, const SampleCity& city, int connections, uint64_t range_bytes,
                  int repetitions, BenchProgram& program) {
    const auto our_files = large_files(city, "/city/"), nginx_files = large_files(city, "/city/");
    Series ours, nginx;
    for (int i = 0; i < repetitions; ++i) {
        ours.add(load_ranges({servers.ours, connections, range_bytes, kSlice}, our_files));
        if (servers.nginx != 0) nginx.add(load_ranges({servers.nginx, connections, range_bytes, kSlice}, nginx_files));
    }
    program.check(ours.failure.empty(), "citystream-serve: " + ours.failure);
    program.check(nginx.failure.empty(), "nginx: " + nginx.failure);
    Json line{{"range_bytes", range_bytes}, {"connections", connections}, {"ours", ours.json()}};
    if (servers.nginx != 0) {
        line["nginx"] = nginx.json();
        line["throughput_to_nginx"] = to_json(ratio_of(ours.gigabytes_per_second, nginx.gigabytes_per_second));
        line["p50_to_nginx"] = to_json(ratio_of(ours.p50, nginx.p50));
        line["p99_to_nginx"] = to_json(ratio_of(ours.p99, nginx.p99));
    }
    program.print(line);
}

void measure(const SampleCity& city, const std::string& serve, const TemporaryFolder& folder, int repetitions,
             BenchProgram& program) {
    ChildProcess server({serve, city.path, "--listen", "127.0.0.1:0", "--json"});
    Servers servers;
    servers.ours = port_in(server.line_with("\"port\":", 10));
    if (!program.check(servers.ours != 0, "citystream-serve starts and names its port")) return;

    std::optional<ChildProcess> nginx;
    const std::string program_file = find_program("nginx");
    if (program_file.empty()) {
        program.print_skipped("nginx is not installed (package nginx-light): no baseline");
    } else {
        servers.nginx = free_port();
        const std::string root = folder / "www";
        if (!program.check(unpack(city, root + "/city"), "the city can be unpacked")) return;
        std::ofstream(folder / "nginx.conf") << nginx_configuration(folder, root, servers.nginx);
        nginx.emplace(std::vector<std::string>{program_file, "-c", folder / "nginx.conf", "-p", folder / ""});
        if (!program.check(wait_for_port(servers.nginx, 10), "nginx starts")) return;
    }
    for (const uint64_t range_bytes : {16U << 10, 64U << 10, 256U << 10}) {
        for (const int connections : {1, 2, 4, 8})
            measure_case(servers, city, connections, range_bytes, repetitions, program);
    }
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_server", kClaim, ""});
    BenchOptions options;
    options.repetitions = 5;
    options.buildings = 500;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const std::string serve =
        (std::filesystem::canonical("/proc/self/exe").parent_path() / "citystream-serve").string();
    const TemporaryFolder folder;
    const std::string archive = folder / "city.3tz";
    const Status built = build_generated(options.buildings, options.seed, kAllLayers, archive);
    if (!program.check(built.ok(), built.ok() ? "" : built.error().text())) return program.exit_code();
    const auto city = open_city(archive);
    if (!program.check(city.ok(), city.ok() ? "" : city.error().text())) return program.exit_code();
    if (!program.check(!large_files(*city, "").empty(), "the city has entries of at least 256 KiB"))
        return program.exit_code();
    measure(*city, serve, folder, options.repetitions, program);
    return program.exit_code();
}
