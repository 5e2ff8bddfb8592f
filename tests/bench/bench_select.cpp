// Claim: choosing what to draw costs as much as what is seen, not as much as the city.
#include <algorithm>
#include <cmath>

#include "client/cache/directory_cache.h"
#include "client/cache/layer_store.h"
#include "client/select/selection.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/camera_tours.h"
#include "tests/bench/sample_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;
using tiles::tileset::Layer;

constexpr const char* kClaim =
    "Selector::select over the whole directory of a city, for cameras at street, roof and great height, against a "
    "brute-force pass that tests\n"
    "every tile of the directory by the same rule. Both must choose the same tiles and steps. tiles_visited: tiles "
    "that the walk looks at.\n"
    "FILEs are cities or .3tz archives (a 30,000-building one: citystream-build generate --buildings 30000 --layers "
    "mesh -o city.3tz).";

/// One tile by the rule, from scratch.
struct Judgement {
    bool visible = false, fine_enough = false;
    double pixels_per_metre = 0;
};

Judgement judge(const DirectoryCache& directory, const DirectoryNode& node, const Camera& camera, double tolerance) {
    Judgement result;
    const auto& bounds = node.record->bounds;
    result.visible = camera.sees(bounds, directory.origin());
    if (!result.visible) return result;
    result.pixels_per_metre =
        camera.pixels_per_metre(std::max(camera.distance_to(bounds, directory.origin()), camera.near_plane));
    result.fine_enough = node.is_leaf() || node.record->geometric_error * result.pixels_per_metre <= tolerance;
    return result;
}

struct BruteForce {
    std::vector<SelectedTile> tiles;  ///< in the directory's order
    uint64_t visited = 0;             ///< tiles that a walk from the root would look at
};

/// Judges every tile, then takes those that are fine enough below tiles that are not. The directory's nodes come
/// parents first.
BruteForce select_by_force(const DirectoryCache& directory, const CityKnowledge& knowledge, const Camera& camera,
                           double tolerance) {
    const auto& nodes = directory.nodes();
    std::vector<bool> open(nodes.size());  // every tile above is visible and too coarse
    const PositionRule positions = position_rule(camera, tolerance);
    BruteForce result;
    for (NodeIndex i = 0; i < nodes.size(); ++i) {
        const Judgement judged = judge(directory, nodes[i], camera, tolerance);
        const bool reached = nodes[i].parent == kNoNode || open[nodes[i].parent];
        open[i] = reached && judged.visible && !judged.fine_enough;
        result.visited += reached ? 1 : 0;
        if (!reached || !judged.visible || !judged.fine_enough) continue;
        SelectedTile tile;
        tile.node = i;
        tile.steps[static_cast<size_t>(Layer::kMesh)] =
            mesh_prefix(nodes[i].record->steps(Layer::kMesh), usable_steps(nodes[i], knowledge.tiles[i], Layer::kMesh),
                        granted_in(positions, nodes[i].record->bounds, directory.manifest().origin));
        for (const Layer layer : {Layer::kAtlas, Layer::kFacade}) {
            if (layer == Layer::kFacade && nodes[i].record->flat_facade_error * judged.pixels_per_metre <= tolerance)
                continue;
            tile.steps[static_cast<size_t>(layer)] =
                shortest_prefix(nodes[i].record->steps(layer), usable_steps(nodes[i], knowledge.tiles[i], layer),
                                judged.pixels_per_metre, tolerance);
        }
        result.tiles.push_back(tile);
    }
    return result;
}

bool same_choice(std::vector<SelectedTile> a, const std::vector<SelectedTile>& b) {
    std::sort(a.begin(), a.end(), [](const auto& x, const auto& y) { return x.node < y.node; });
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& x, const auto& y) { return x.node == y.node && x.steps == y.steps; });
}

void measure_tour(const std::string& name, const Tour& tour, const DirectoryCache& directory,
                  const CityKnowledge& knowledge, double tolerance, int repetitions, BenchProgram& program) {
    Selector selector(directory, knowledge);
    std::vector<Camera> cameras;
    std::vector<double> visited, chosen;
    bool same = true;
    for (const CameraSample& sample : tour.path.samples) {
        cameras.push_back(Camera::from_sample(sample, 1280, 720));
        const BruteForce expected = select_by_force(directory, knowledge, cameras.back(), tolerance);
        same = same && same_choice(selector.select(cameras.back(), tolerance, kSlotBytes).tiles, expected.tiles);
        visited.push_back(static_cast<double>(expected.visited));
        chosen.push_back(static_cast<double>(expected.tiles.size()));
    }
    program.check(same, name + ", " + tour.name + ": the walk and the brute force choose the same");
    const std::vector<std::function<void()>> work = {
        [&] {
            for (const Camera& camera : cameras) keep(selector.select(camera, tolerance, kSlotBytes).tiles.size());
        },
        [&] {
            for (const Camera& camera : cameras)
                keep(select_by_force(directory, knowledge, camera, tolerance).tiles.size());
        }};
    const auto seconds = time_in_turn(work, repetitions);
    std::vector<double> microseconds;
    for (const double value : seconds[0]) microseconds.push_back(value / static_cast<double>(cameras.size()) * 1e6);
    program.print({{"city", name},
                   {"tour", tour.name},
                   {"tolerance_px", tolerance},
                   {"tiles", directory.nodes().size()},
                   {"cameras", cameras.size()},
                   {"tiles_visited", to_json(spread_of(visited))},
                   {"tiles_chosen", to_json(spread_of(chosen))},
                   {"microseconds", to_json(spread_of(microseconds))},
                   {"time_to_brute_force", to_json(ratio_of(seconds[0], seconds[1]))}});
}

void measure_city(const std::string& name, const Result<SampleCity>& city, int repetitions, BenchProgram& program) {
    if (!program.check(city.ok(), city.ok() ? "" : city.error().text())) return;
    DirectoryCache directory(city->manifest, nullptr);
    for (const auto& subtree : city->subtrees)
        program.check(directory.add_subtree(subtree.bytes, subtree.parsed.root).ok(), "a subtree joins the directory");
    CityKnowledge knowledge;
    knowledge.tiles.resize(directory.nodes().size());
    knowledge.dictionary.learn(city->maps);
    for (const double tolerance : {1.0, 4.0}) {
        for (const Tour& tour : tours_of(*city))
            measure_tour(name, tour, directory, knowledge, tolerance, repetitions, program);
    }
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_select", kClaim, "city.3tz"});
    BenchOptions options;
    options.buildings = 3000;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const TemporaryFolder folder;
    if (options.files.empty()) {
        const std::string archive = folder / "generated.3tz";
        const Status built = build_generated(options.buildings, options.seed, {true, false, false, false}, archive);
        if (program.check(built.ok(), built.ok() ? "" : built.error().text())) {
            measure_city("generated:" + std::to_string(options.buildings), open_city(archive), options.repetitions,
                         program);
        }
    }
    for (const auto& file : options.files)
        measure_city(std::filesystem::path(file).filename().string(), city_of_file(file, kAllLayers, folder),
                     options.repetitions, program);
    return program.exit_code();
}
