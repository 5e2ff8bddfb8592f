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
#include "tests/bench/recorded_tracks.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;

constexpr const char* kClaim =
    "Bytes of positions that a flight moves: every step of a tile once, when a frame first needs it. Three recorded\n"
    "drone tracks moved onto the city (made-up flights where ../shared/data is absent), 1280 x 720.\n"
    "adaptive: steps by the position tolerance (error_px: the greatest that any frame's tiles had). fixed: one step, "
    "its\n"
    "bits the same for the whole flight, as many as the greatest error of adaptive allows (fixed_equal), 16 bits\n"
    "across each tile (fixed_16) or all of them (full). adaptive_as_16: adaptive at the tolerance that is the error "
    "of\n"
    "fixed_16. detail: bytes of the whole mesh with levels of detail alone (full positions), adaptive precision alone\n"
    "(all visible leaves), both, or neither. bits: of a coordinate, weighted by vertices drawn: full, of the steps "
    "that\n"
    "are needed, and as vertices are granted them one by one. FILEs are cities or .3tz archives.";
constexpr LayerSet kMeshAndFacades = {true, true, false, false};
constexpr uint32_t kWidth = 1280, kHeight = 720;
constexpr uint32_t kFixedBits = 16;
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

size_t step_for(const PositionCosts& tile, uint32_t granted) {
    size_t step = 0;
    while (step + 1 < tile.dropped().size() && tile.dropped()[step] > granted) ++step;
    return step;
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
};

Moved adaptive_bytes(const City& city, const Flown& flown) {
    Moved moved;
    const auto steps = most_needed(
        city, flown, [](const PositionCosts& tile, const Sight& sight) { return step_for(tile, sight.granted); });
    for (size_t i = 0; i < steps.size(); ++i) {
        if (!steps[i]) continue;
        moved.positions += city.costs[i].step_bytes()[*steps[i]];
        moved.whole += city.costs[i].step_bytes()[*steps[i]] + city.costs[i].other_bytes();
    }
    return moved;
}

/// `dropped(tile)` bits in every tile that is seen.
template <typename Dropped>
Moved fixed_bytes(City& city, const Flown& flown, const Dropped& dropped) {
    Moved moved;
    const auto seen = most_needed(city, flown, [](const PositionCosts&, const Sight&) { return size_t{0}; });
    for (size_t i = 0; i < seen.size(); ++i) {
        if (!seen[i]) continue;
        const double bytes = city.costs[i].fixed_bytes(dropped(city.costs[i]));
        moved.positions += bytes;
        moved.whole += bytes + city.costs[i].other_bytes();
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
            bits.steps += shown(tile.dropped()[step_for(tile, sight.granted)]);
            bits.vertices += shown(dropped_by_vertices(city, flown.rules[f], tile));
        }
    }
    if (vertices > 0) bits = {bits.full / vertices, bits.steps / vertices, bits.vertices / vertices};
    return bits;
}

void measure_tour(const std::string& name, City& city, const Tour& tour, double tolerance, BenchProgram& program) {
    const auto full = [](const PositionCosts& tile) { return tile.finest_dropped(); };
    const auto at_16 = [](const PositionCosts& tile) { return dropped_at_16(tile); };
    const auto chosen_step = [](const PositionCosts& tile, const Sight& sight) {
        return tile.dropped()[step_for(tile, sight.granted)];
    };
    const Flown flown = fly(city, tour, tolerance, tolerance, false);
    const double error = greatest_error(city, flown, chosen_step);
    program.check(error <= tolerance, tour.name + ": no step drops more than its tile is granted");
    const Moved adaptive = adaptive_bytes(city, flown), whole = fixed_bytes(city, flown, full);
    const Moved fixed_16 = fixed_bytes(city, flown, at_16);
    const uint32_t uniform = uniform_dropped(flown, tolerance);
    const Moved equal = fixed_bytes(city, flown, [&](const PositionCosts&) { return uniform; });
    const double error_16 =
        greatest_error(city, flown, [](const PositionCosts& tile, const Sight&) { return dropped_at_16(tile); });
    Json fields = {{"city", name},
                   {"tour", tour.name},
                   {"tolerance_px", tolerance},
                   {"frames", flown.frames.size()},
                   {"adaptive_bytes", rounded(adaptive.positions)},
                   {"error_px", rounded(error)},
                   {"fixed_equal_bytes", rounded(equal.positions)},
                   {"fixed_equal_dropped", uniform},
                   {"adaptive_to_fixed_equal", rounded(adaptive.positions / equal.positions)},
                   {"fixed_16_bytes", rounded(fixed_16.positions)},
                   {"fixed_16_error_px", rounded(error_16)},
                   {"adaptive_to_fixed_16", rounded(adaptive.positions / fixed_16.positions)},
                   {"full_bytes", rounded(whole.positions)},
                   {"adaptive_to_full", rounded(adaptive.positions / whole.positions)}};
    if (error_16 > 0) {
        const Flown as_16 = fly(city, tour, tolerance, error_16, false);
        fields["adaptive_as_16_bytes"] = rounded(adaptive_bytes(city, as_16).positions);
        fields["adaptive_as_16_to_fixed_16"] = rounded(adaptive_bytes(city, as_16).positions / fixed_16.positions);
    }
    const Flown leaves = fly(city, tour, tolerance, tolerance, true);
    fields["detail"] = {{"neither", rounded(fixed_bytes(city, leaves, full).whole)},
                        {"levels", rounded(whole.whole)},
                        {"precision", rounded(adaptive_bytes(city, leaves).whole)},
                        {"both", rounded(adaptive.whole)}};
    const Bits bits = bits_of(city, flown);
    fields["bits"] = {
        {"full", rounded(bits.full)}, {"steps", rounded(bits.steps)}, {"vertices", rounded(bits.vertices)}};
    program.print(fields);
}

void measure_city(const std::string& name, const Result<SampleCity>& sample, BenchProgram& program) {
    if (!program.check(sample.ok(), sample.ok() ? "" : sample.error().text())) return;
    City city{*sample, DirectoryCache(sample->manifest, nullptr), {}, {}};
    for (const auto& subtree : sample->subtrees)
        program.check(city.directory.add_subtree(subtree.bytes, subtree.parsed.root).ok(),
                      "a subtree joins the directory");
    city.knowledge.tiles.resize(city.directory.nodes().size());
    for (const DirectoryNode& node : city.directory.nodes()) {
        auto costs = PositionCosts::of_tile(*sample, *node.record);
        if (!program.check(costs.ok(), costs.ok() ? "" : costs.error().text())) return;
        city.costs.push_back(std::move(*costs));
    }
    for (const double tolerance : {0.5, 1.0, 4.0}) {
        for (const Tour& tour : tracks_of(*sample)) measure_tour(name, city, tour, tolerance, program);
    }
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_positions", kClaim, "city.3tz"});
    BenchOptions options;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const TemporaryFolder folder;
    if (options.files.empty()) {
        const std::string archive = folder / "generated.3tz";
        const Status built = build_generated(options.buildings, options.seed, kMeshAndFacades, archive);
        if (program.check(built.ok(), built.ok() ? "" : built.error().text()))
            measure_city("generated " + std::to_string(options.buildings), open_city(archive), program);
    }
    for (const std::string& file : options.files)
        measure_city(file, city_of_file(file, kMeshAndFacades, folder), program);
    return program.exit_code();
}
