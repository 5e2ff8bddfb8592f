// Claim: bytes and bits of positions follow the view. Adaptive precision moves fewer bytes than any fixed number of
// bits with the same error on the screen, and multiplies with the levels of detail.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "client/cache/directory_cache.h"
#include "client/select/selection.h"
#include "codec/mesh/mesh_resident_layout.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/position_costs.h"
#include "tests/bench/position_pictures.h"
#include "tests/bench/recorded_tracks.h"
#include "tiles/city/city_input.h"
#include "tiles/city/generator.h"
#include "tiles/layers/build_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;

constexpr const char* kClaim =
    "Bytes of positions that a flight moves: every step of a tile once, when a frame first needs it. Three recorded\n"
    "drone tracks moved onto the city (made-up flights where ../shared/data is absent), 1280 x 720.\n"
    "table steps: the whole city in one step, in so many, and in as many as the builder takes: bytes of first steps "
    "and\n"
    "of all over those of one step; finer bits that come later cost more than when all are told at once.\n"
    "table flight: adaptive: steps by the position tolerance (error_px: the greatest that any frame's tiles had).\n"
    "fixed: one step, its bits the same for the whole flight, as many as the greatest error of adaptive allows\n"
    "(fixed_equal), 16 bits across each tile (fixed_16) or all of them (full). adaptive_as_16: adaptive at the "
    "tolerance\n"
    "that is the error of fixed_16. to_full: by number of steps. detail: bytes of the whole mesh with levels of "
    "detail\n"
    "alone (full positions), adaptive precision alone (all visible leaves), both, or neither: of the flight, and of a "
    "frame\n"
    "that starts with nothing (mean). bits: of a coordinate, weighted by vertices drawn: full, of the steps that are\n"
    "needed, and as vertices are granted them one by one.\n"
    "table pictures: frames of the client with bits left out to its own frames with all bits: PSNR (99: equal), wire "
    "bytes\n"
    "of the flight; ap, cap: how the city was built. FILEs are cities, or .3tz archives (no cap).";
constexpr uint32_t kWidth = 1280, kHeight = 720;
constexpr uint32_t kFixedBits = 16;
constexpr int kPictures = 4;  // of each flight
/// Of a tile's vertices, for the average of what they are granted one by one.
constexpr size_t kSampledVertices = 64;

struct City {
    const SampleCity& sample;
    DirectoryCache directory;
    CityKnowledge knowledge;
    std::vector<PositionCosts> costs;  ///< by node
};

/// A tile in a frame.
struct Sight {
    NodeIndex node = 0;
    double nearest = 0;  ///< metres to its nearest vertex
    uint32_t granted = 0;
};

double nearest_vertex(const City& city, const Camera& camera, NodeIndex node) {
    const PositionCosts& tile = city.costs[node];
    const GridPoint origin = city.sample.manifest.tile_origin(tile.record());
    const std::array<double, 3> from = {to_metres(origin.x) - camera.position[0],
                                        to_metres(origin.y) - camera.position[1],
                                        to_metres(origin.z) - camera.position[2]};
    double squared = std::numeric_limits<double>::infinity();
    for (const auto& vertex : tile.mesh().vertices) {
        double sum = 0;
        for (size_t c = 0; c < 3; ++c) sum += std::pow(from[c] + to_metres(vertex.position[c]), 2);
        squared = std::min(squared, sum);
    }
    return std::max(std::sqrt(squared), camera.near_plane);
}

/// Tiles that a frame shows: those that the rule chooses, or all visible leaves.
std::vector<Sight> tiles_in(City& city, const Camera& camera, double tolerance, bool leaves, const PositionRule& rule) {
    std::vector<NodeIndex> nodes;
    if (leaves) {
        for (NodeIndex i = 0; i < city.directory.nodes().size(); ++i) {
            const DirectoryNode& node = city.directory.node(i);
            if (node.is_leaf() && camera.sees(node.record->bounds, city.directory.origin())) nodes.push_back(i);
        }
    } else {
        Selector selector(city.directory, city.knowledge);
        for (const SelectedTile& tile : selector.select(camera, tolerance, 4096).tiles) nodes.push_back(tile.node);
    }
    std::vector<Sight> out;
    for (const NodeIndex node : nodes) {
        if (city.costs[node].mesh().vertices.empty()) continue;
        out.push_back({node, nearest_vertex(city, camera, node),
                       granted_in(rule, city.directory.node(node).record->bounds, city.sample.manifest.origin)});
    }
    return out;
}

uint32_t dropped_at_16(const PositionCosts& tile) {
    const uint32_t surplus = tile.full_bits() > kFixedBits ? tile.full_bits() - kFixedBits : 0;
    return std::max(surplus, tile.finest_dropped());
}

/// The frames of a flight, seen at one geometric tolerance and one position tolerance.
struct Flown {
    std::vector<std::vector<Sight>> frames;
    std::vector<PositionRule> rules;
};

Flown fly(City& city, const Tour& tour, double tolerance, double position_tolerance, bool leaves) {
    Flown flown;
    for (const CameraSample& sample : tour.path.samples) {
        const Camera camera = Camera::from_sample(sample, kWidth, kHeight);
        flown.rules.push_back(position_rule(camera, position_tolerance));
        flown.frames.push_back(tiles_in(city, camera, tolerance, leaves, flown.rules.back()));
    }
    return flown;
}

/// Bits that are left out where the builder's steps are taken by what a tile is granted.
uint32_t bits_dropped(const PositionCosts& tile, const Sight& sight) {
    const PositionSteps& steps = tile.steps(StepChoice::kBest);
    return steps.dropped[steps.step_for(sight.granted)];
}

/// Greatest error of any frame, where a tile drops `dropped(tile, sight)` bits; of tiles whose geometry allows it.
template <typename Dropped>
double greatest_error(const City& city, const Flown& flown, const Dropped& dropped) {
    double error = 0;
    for (size_t f = 0; f < flown.frames.size(); ++f) {
        for (const Sight& sight : flown.frames[f]) {
            const PositionCosts& tile = city.costs[sight.node];
            const uint32_t bits = dropped(tile, sight);
            if (bits > tile.finest_dropped()) error = std::max(error, flown.rules[f].error_pixels(bits, sight.nearest));
        }
    }
    return error;
}

/// Of each tile, the most that any frame asks of it.
template <typename Need>
std::vector<std::optional<size_t>> most_needed(const City& city, const Flown& flown, const Need& need) {
    std::vector<std::optional<size_t>> most(city.costs.size());
    for (const auto& frame : flown.frames) {
        for (const Sight& sight : frame)
            most[sight.node] = std::max(most[sight.node].value_or(0), need(city.costs[sight.node], sight));
    }
    return most;
}

struct Moved {
    double positions = 0, whole = 0;  ///< bytes

    void add(const PositionSteps& steps, size_t step) {
        positions += steps.bytes[step];
        whole += steps.bytes[step] + steps.other;
    }
};

/// Of a whole flight. In one step: all bits.
Moved adaptive_bytes(const City& city, const Flown& flown, StepChoice choice) {
    const auto needed = most_needed(city, flown, [&](const PositionCosts& tile, const Sight& sight) {
        return tile.steps(choice).step_for(sight.granted);
    });
    Moved moved;
    for (size_t i = 0; i < needed.size(); ++i) {
        if (needed[i]) moved.add(city.costs[i].steps(choice), *needed[i]);
    }
    return moved;
}

/// Of a frame that starts with nothing, mean of all.
Moved frame_bytes(const City& city, const Flown& flown, StepChoice choice) {
    Moved moved;
    for (const auto& frame : flown.frames) {
        for (const Sight& sight : frame) {
            const PositionSteps& steps = city.costs[sight.node].steps(choice);
            moved.add(steps, steps.step_for(sight.granted));
        }
    }
    const auto frames = static_cast<double>(flown.frames.size());
    return {moved.positions / frames, moved.whole / frames};
}

/// Of positions with `dropped(tile)` bits left out in every tile that is seen.
template <typename Dropped>
double fixed_bytes(City& city, const Flown& flown, const Dropped& dropped) {
    double moved = 0;
    const auto seen = most_needed(city, flown, [](const PositionCosts&, const Sight&) { return size_t{0}; });
    for (size_t i = 0; i < seen.size(); ++i) {
        if (seen[i]) moved += city.costs[i].fixed_bytes(dropped(city.costs[i]));
    }
    return moved;
}

/// The most bits that a whole flight may drop at an error.
uint32_t uniform_dropped(const Flown& flown, double error) {
    uint32_t dropped = RESIDENT_CELL_BITS;
    for (size_t f = 0; f < flown.frames.size(); ++f) {
        for (const Sight& sight : flown.frames[f]) {
            while (dropped > 0 && flown.rules[f].error_pixels(dropped, sight.nearest) > error) --dropped;
        }
    }
    return dropped;
}

/// Bits of a coordinate, of the vertices of all frames.
struct Bits {
    double full = 0, steps = 0, vertices = 0;
};

double dropped_by_vertices(const City& city, const PositionRule& rule, const PositionCosts& tile) {
    const auto& vertices = tile.mesh().vertices;
    const GridPoint origin = city.sample.manifest.tile_origin(tile.record());
    const size_t stride = std::max<size_t>(1, vertices.size() / kSampledVertices);
    double sum = 0, count = 0;
    for (size_t v = 0; v < vertices.size(); v += stride) {
        const auto& at = vertices[v].position;
        const std::array<double, 3> place = {to_metres(origin.x - city.sample.manifest.origin.x + at[0]),
                                             to_metres(origin.y - city.sample.manifest.origin.y + at[1]),
                                             to_metres(origin.z + at[2])};
        sum += std::max(granted_in(rule, {place, place}, city.sample.manifest.origin), tile.finest_dropped());
        ++count;
    }
    return sum / count;
}

Bits bits_of(const City& city, const Flown& flown) {
    Bits bits;
    double vertices = 0;
    for (size_t f = 0; f < flown.frames.size(); ++f) {
        for (const Sight& sight : flown.frames[f]) {
            const PositionCosts& tile = city.costs[sight.node];
            const auto weight = static_cast<double>(tile.mesh().vertices.size());
            const auto shown = [&](double dropped) { return weight * std::max(0.0, tile.full_bits() - dropped); };
            vertices += weight;
            bits.full += shown(0);
            bits.steps += shown(bits_dropped(tile, sight));
            bits.vertices += shown(dropped_by_vertices(city, flown.rules[f], tile));
        }
    }
    if (vertices > 0) bits = {bits.full / vertices, bits.steps / vertices, bits.vertices / vertices};
    return bits;
}

Json detail_of(const std::array<Moved, 4>& moved) {
    return {{"neither", rounded(moved[0].whole)},
            {"levels", rounded(moved[1].whole)},
            {"precision", rounded(moved[2].whole)},
            {"both", rounded(moved[3].whole)}};
}

/// Levels of precision and levels of detail, alone and together.
void add_detail(const City& city, const Flown& flown, const Flown& leaves, Json& fields) {
    const auto table = [&](const auto& bytes_of) {
        return detail_of({bytes_of(city, leaves, StepChoice::kOne), bytes_of(city, flown, StepChoice::kOne),
                          bytes_of(city, leaves, StepChoice::kBest), bytes_of(city, flown, StepChoice::kBest)});
    };
    fields["detail"] = {{"flight", table(adaptive_bytes)}, {"frame", table(frame_bytes)}};
}

/// `error`, `adaptive`: greatest error and bytes of adaptive precision.
void add_fixed(City& city, const Flown& flown, double error, double adaptive, Json& fields) {
    const uint32_t uniform = uniform_dropped(flown, error);
    const double equal = fixed_bytes(city, flown, [&](const PositionCosts&) { return uniform; });
    const double fixed_16 = fixed_bytes(city, flown, dropped_at_16);
    const double error_16 =
        greatest_error(city, flown, [](const PositionCosts& tile, const Sight&) { return dropped_at_16(tile); });
    fields["fixed_equal_bytes"] = rounded(equal);
    fields["fixed_equal_dropped"] = uniform;
    fields["adaptive_to_fixed_equal"] = rounded(adaptive / equal);
    fields["fixed_16_bytes"] = rounded(fixed_16);
    fields["fixed_16_error_px"] = rounded(error_16);
    fields["adaptive_to_fixed_16"] = rounded(adaptive / fixed_16);
}

void measure_tour(const std::string& name, City& city, const Tour& tour, double tolerance, double share,
                  BenchProgram& program) {
    const Flown flown = fly(city, tour, tolerance, share * tolerance, false);
    const Flown leaves = fly(city, tour, tolerance, share * tolerance, true);
    const double error = greatest_error(city, flown, bits_dropped);
    program.check(error <= share * tolerance, tour.name + ": no step drops more than its tile is granted");
    const double adaptive = adaptive_bytes(city, flown, StepChoice::kBest).positions;
    const double full = adaptive_bytes(city, flown, StepChoice::kOne).positions;
    Json fields = {{"table", "flight"},
                   {"city", name},
                   {"tour", tour.name},
                   {"tolerance_px", tolerance},
                   {"position_tolerance_px", share * tolerance},
                   {"frames", flown.frames.size()},
                   {"adaptive_bytes", rounded(adaptive)},
                   {"error_px", rounded(error)},
                   {"full_bytes", rounded(full)}};
    add_fixed(city, flown, error, adaptive, fields);
    if (const double error_16 = fields["fixed_16_error_px"]; error_16 > 0) {
        const double as_16 =
            adaptive_bytes(city, fly(city, tour, tolerance, error_16, false), StepChoice::kBest).positions;
        fields["adaptive_as_16_to_fixed_16"] = rounded(as_16 / double{fields["fixed_16_bytes"]});
    }
    fields["to_full"] = {{"builder", rounded(adaptive / full)},
                         {"two", rounded(adaptive_bytes(city, flown, StepChoice::kTwo).positions / full)},
                         {"three", rounded(adaptive_bytes(city, flown, StepChoice::kThree).positions / full)}};
    add_detail(city, flown, leaves, fields);
    const Bits bits = bits_of(city, flown);
    fields["bits"] = {
        {"full", rounded(bits.full)}, {"steps", rounded(bits.steps)}, {"vertices", rounded(bits.vertices)}};
    program.print(fields);
}

void print_steps(const std::string& name, const City& city, BenchProgram& program) {
    Json fields = {{"table", "steps"}, {"city", name}};
    constexpr std::array<const char*, kStepChoices.size()> kNames = {"builder", "one", "two", "three"};
    double one = 0;
    for (const PositionCosts& tile : city.costs) one += tile.steps(StepChoice::kOne).bytes.back();
    fields["one_bytes"] = rounded(one);
    for (const StepChoice choice : kStepChoices) {
        if (choice == StepChoice::kOne) continue;
        double first = 0, all = 0;
        for (const PositionCosts& tile : city.costs) {
            first += tile.steps(choice).bytes.front();
            all += tile.steps(choice).bytes.back();
        }
        fields[kNames[static_cast<size_t>(choice)]] = {{"first", rounded(first / one)}, {"all", rounded(all / one)}};
    }
    program.print(fields);
}

void measure_costs(const std::string& name, const SampleCity& sample, const CityHeights& heights,
                   BenchProgram& program) {
    City city{sample, DirectoryCache(sample.manifest, nullptr), {}, {}};
    for (const auto& subtree : sample.subtrees)
        program.check(city.directory.add_subtree(subtree.bytes, subtree.parsed.root).ok(),
                      "a subtree joins the directory");
    city.knowledge.tiles.resize(city.directory.nodes().size());
    for (const DirectoryNode& node : city.directory.nodes()) {
        auto costs = PositionCosts::of_tile(sample, *node.record);
        if (!program.check(costs.ok(), costs.ok() ? "" : costs.error().text())) return;
        city.costs.push_back(std::move(*costs));
    }
    print_steps(name, city, program);
    const std::vector<Tour> tours = tracks_of(sample, heights);
    for (const double tolerance : {0.5, 1.0, 4.0}) {
        for (const double share : {1.0, kPositionShare}) {
            for (const Tour& tour : tours) measure_tour(name, city, tour, tolerance, share, program);
        }
    }
}

/// Archives of one city by how their positions were built; the second is missing where the city came as an archive.
struct Archives {
    std::string adaptive, constrained;
};

void measure_pictures(const std::string& name, const std::vector<Tour>& tours, const Archives& archives,
                      BenchProgram& program) {
    constexpr double kTolerance = 1;
    for (const Tour& tour : tours) {
        const auto full = fly_with_positions(archives.adaptive, tour, kTolerance, 0);
        if (!program.check(full.ok(), full.ok() ? "" : full.error().text())) return;
        for (const double tolerance : {0.5, 0.125, kPositionShare * kTolerance}) {
            Json fields = {{"table", "pictures"},
                           {"city", name},
                           {"tour", tour.name},
                           {"tolerance_px", kTolerance},
                           {"position_tolerance_px", tolerance},
                           {"full_wire_bytes", full->wire_bytes}};
            const auto add = [&](const std::string& kind, const std::string& archive) {
                if (archive.empty()) return;
                const auto flight = fly_with_positions(archive, tour, kTolerance, tolerance);
                if (!program.check(flight.ok(), flight.ok() ? "" : flight.error().text())) return;
                const PictureDifference difference = difference_of(*flight, *full);
                fields[kind] = {{"least_db", rounded(difference.least_db)},
                                {"median_db", rounded(difference.median_db)},
                                {"wire_bytes", flight->wire_bytes}};
            };
            add("ap", archives.adaptive);
            add("cap", archives.constrained);
            program.print(fields);
        }
    }
}

void measure_city(const std::string& name, const Archives& archives, BenchProgram& program) {
    const auto sample = open_city(archives.adaptive);
    if (!program.check(sample.ok(), sample.ok() ? "" : sample.error().text())) return;
    const auto heights = CityHeights::of_city(*sample);
    if (!program.check(heights.ok(), heights.ok() ? "" : heights.error().text())) return;
    measure_costs(name, *sample, *heights, program);
    measure_pictures(name, tracks_of(*sample, *heights, kPictures), archives, program);
}

/// Builds the city with both precisions.
void build_and_measure(const std::string& name, const tiles::layers::CitySource& source, const TemporaryFolder& folder,
                       BenchProgram& program) {
    const Archives archives{folder / "adaptive.3tz", folder / "constrained.3tz"};
    for (const auto precision :
         {tiles::layers::PositionPrecision::kAdaptive, tiles::layers::PositionPrecision::kConstrained}) {
        tiles::layers::BuildOptions options;
        const bool adaptive = precision == tiles::layers::PositionPrecision::kAdaptive;
        options.output = adaptive ? archives.adaptive : archives.constrained;
        options.mesh.precision = precision;
        tiles::city::CityReport report;
        const auto built = tiles::layers::build_city(options, source, report);
        if (!program.check(built.ok(), built.ok() ? "" : name + ": " + built.error().text())) return;
    }
    measure_city(name, archives, program);
}

void measure_generated(const BenchOptions& options, const TemporaryFolder& folder, BenchProgram& program) {
    tiles::city::GeneratorOptions generator;
    generator.buildings = options.buildings;
    generator.seed = options.seed;
    const auto source = [&](tiles::city::CityHeader& header, tiles::city::CityCatalog& catalog,
                            tiles::city::CityReport& report, const tiles::city::CitySink& sink) -> Status {
        tiles::city::generate_city(generator, header, catalog, report, sink);
        return Done{};
    };
    build_and_measure("generated " + std::to_string(options.buildings), source, folder, program);
}

void measure_file(const std::string& file, const TemporaryFolder& folder, BenchProgram& program) {
    const std::filesystem::path path(file);
    if (path.extension() == ".3tz") return measure_city(path.filename().string(), {file, ""}, program);
    const auto source = [&](tiles::city::CityHeader& header, tiles::city::CityCatalog& catalog,
                            tiles::city::CityReport& report, const tiles::city::CitySink& sink) {
        return tiles::city::read_city({file}, {}, header, catalog, report, sink);
    };
    build_and_measure(path.filename().string(), source, folder, program);
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_positions", kClaim, "city or .3tz"});
    BenchOptions options;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const TemporaryFolder folder;
    if (options.files.empty()) measure_generated(options, folder, program);
    for (const std::string& file : options.files) measure_file(file, folder, program);
    return program.exit_code();
}
