// Claim: finding an entry in an archive by its name, and reading the directory, cost little.
#include <cstring>
#include <string_view>
#include <unordered_map>

#include "tests/bench/bench_program.h"
#include "tests/bench/sample_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::tiles;

constexpr const char* kClaim =
    "ArchiveReader::find (binary search among the sorted names) against std::unordered_map<std::string, "
    "span> filled with the\n"
    "same entries; and parsing all subtrees of a city against copying their bytes. *_ratio: our time over the "
    "baseline's. Every lookup and\n"
    "every parsed subtree is compared with what was written.";
constexpr size_t kLookups = 4096;

std::string entry_name(size_t i) {
    return "tiles/" + std::to_string(i % 12) + "/" + std::to_string(i) + "/" + std::to_string(i * 7) + ".mesh";
}

Status write_archive(const std::string& path, size_t entries) {
    auto writer = archive::ArchiveWriter::create(path);
    if (!writer) return writer.error();
    for (size_t i = 0; i < entries; ++i) {
        const Status added = (*writer)->add(entry_name(i), std::as_bytes(std::span(&i, 1)));
        if (!added) return added;
    }
    return (*writer)->finish();
}

void measure_lookups(size_t entries, const TemporaryFolder& folder, int repetitions, BenchProgram& program) {
    const std::string path = folder / (std::to_string(entries) + ".3tz");
    const Status written = write_archive(path, entries);
    if (!program.check(written.ok(), written.ok() ? "" : written.error().text())) return;
    const auto reader = archive::ArchiveReader::open(path);
    if (!program.check(reader.ok(), reader.ok() ? "" : reader.error().text())) return;
    std::unordered_map<std::string, std::span<const std::byte>> map;
    std::vector<std::string> names;
    for (size_t i = 0; i < entries; ++i) map[entry_name(i)] = (*reader)->find(entry_name(i));
    bool right = true;
    for (size_t i = 0; i < kLookups; ++i) {
        const size_t entry = i * 7919 % entries;
        names.push_back(entry_name(entry));
        const auto found = (*reader)->find(names.back());
        size_t content = entries;
        if (found.size() == sizeof content) std::memcpy(&content, found.data(), sizeof content);
        right = right && content == entry;
    }
    program.check(right, "every entry is found with its own bytes");
    program.check((*reader)->find("tiles/none.mesh").data() == nullptr, "a name that is not there is not found");

    const std::vector<std::function<void()>> work = {[&] {
                                                         for (const auto& name : names) keep((*reader)->find(name));
                                                     },
                                                     [&] {
                                                         for (const auto& name : names) keep(map.find(name)->second);
                                                     }};
    const auto seconds = time_in_turn(work, repetitions);
    std::vector<double> nanoseconds;
    for (const double value : seconds[0]) nanoseconds.push_back(value / kLookups * 1e9);
    program.print({{"case", "find"},
                   {"entries", entries},
                   {"ns_per_lookup", to_json(spread_of(nanoseconds))},
                   {"find_to_unordered_map_ratio", to_json(ratio_of(seconds[0], seconds[1]))}});
}

void measure_directory(const std::string& name, const Result<SampleCity>& city, int repetitions,
                       BenchProgram& program) {
    if (!program.check(city.ok(), city.ok() ? "" : city.error().text())) return;
    size_t bytes = 0, tiles = 0;
    for (const auto& subtree : city->subtrees) {
        const auto again = tileset::write_subtree(subtree.parsed, city->manifest);
        program.check(std::equal(again.begin(), again.end(), subtree.bytes.begin(), subtree.bytes.end()),
                      "a parsed subtree is written back to the same bytes");
        bytes += subtree.bytes.size();
        tiles += subtree.parsed.tiles.size();
    }
    const std::vector<std::function<void()>> work = {
        [&] {
            for (const auto& subtree : city->subtrees)
                keep(tileset::parse_subtree(subtree.bytes, subtree.parsed.root, city->manifest).ok());
        },
        [&] {
            for (const auto& subtree : city->subtrees) {
                const std::vector<std::byte> copy(subtree.bytes.begin(), subtree.bytes.end());
                keep(copy.data());
            }
        }};
    const auto seconds = time_in_turn(work, repetitions);
    std::vector<double> rates, tile_rates;
    for (const double value : seconds[0]) {
        rates.push_back(static_cast<double>(bytes) / value / 1e6);
        tile_rates.push_back(value / static_cast<double>(tiles) * 1e6);
    }
    program.print({{"case", "directory"},
                   {"city", name},
                   {"subtrees", city->subtrees.size()},
                   {"tiles", tiles},
                   {"bytes", bytes},
                   {"bytes_per_tile", rounded(static_cast<double>(bytes) / static_cast<double>(tiles))},
                   {"parse_MB_per_s", to_json(spread_of(rates))},
                   {"microseconds_per_tile", to_json(spread_of(tile_rates))},
                   {"parse_to_copy_ratio", to_json(ratio_of(seconds[0], seconds[1]))}});
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_archive", kClaim, "city.3tz"});
    BenchOptions options;
    options.buildings = 1000;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const TemporaryFolder folder;
    for (const size_t entries : {300UL, 10'000UL, 60'000UL})
        measure_lookups(entries, folder, options.repetitions, program);
    if (options.files.empty()) {
        const std::string archive = folder / "generated.3tz";
        const Status built = build_generated(options.buildings, options.seed, {true, false, false, false}, archive);
        if (program.check(built.ok(), built.ok() ? "" : built.error().text())) {
            measure_directory("generated:" + std::to_string(options.buildings), open_city(archive), options.repetitions,
                              program);
        }
    }
    for (const auto& file : options.files)
        measure_directory(std::filesystem::path(file).filename().string(), city_of_file(file, kAllLayers, folder),
                          options.repetitions, program);
    return program.exit_code();
}
