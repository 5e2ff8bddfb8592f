// Claim: what a flight receives is little more than what it draws, because levels and steps are chosen by one rule.
#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>

#include "client/cache/directory_cache.h"
#include "client/cache/host_layer_store.h"
#include "client/load/city_index.h"
#include "client/load/drawn_prefixes.h"
#include "client/select/selection.h"
#include "client/stream/chart_boxes.h"
#include "client/stream/city_streamer.h"
#include "client/stream/fetcher.h"
#include "client/stream/layer_decoder.h"
#include "codec/mesh/mesh_layer.h"
#include "tests/bench/bench_program.h"
#include "tests/bench/camera_tours.h"
#include "tests/bench/sample_city.h"

namespace {

using namespace citystream;
using namespace citystream::bench;
using namespace citystream::client;
using tiles::tileset::kLayerCount;
using tiles::tileset::Layer;

constexpr const char* kClaim =
    "Bytes received over the bytes of the layer prefixes that were drawn (over_fetch), for street, roof and high "
    "flights through a city at\n"
    "1280 x 720 and 1 pixel. ours: CityStreamer, directory and the indices of facades and shared charts counted. "
    "whole_tiles: the same tiles, "
    "every layer with all its\n"
    "steps and exact maps. leaves_only: every visible leaf with the prefix that the rule asks for, no coarser levels. "
    "everything: all "
    "leaves, all steps.\n"
    "The baselines' bytes are sums of the directory; all are put over the same drawn bytes. Below 1, a baseline\n"
    "receives less in sum than we do. frame_to_leaves_only: bytes that one camera's selection needs (to start, to "
    "keep) over those of its\n"
    "visible leaves. FILEs are cities or .3tz archives.";
constexpr uint64_t kStoreBytes = uint64_t{1} << 30;
constexpr double kTolerance = 1;
constexpr MapDemand kExact = {0, std::nullopt};

/// Bytes that a client without one of our means would receive: the longest prefix asked for of each layer and shared
/// chart, and maps once.
class Received {
  public:
    explicit Received(const CityKnowledge& knowledge) : knowledge_(knowledge) {}
    void add_layer(const DirectoryNode& node, Layer layer, uint32_t steps) {
        uint64_t& before = layers_[node.record->address][static_cast<size_t>(layer)];
        const uint64_t now = std::max(before, wire_prefix_bytes(node.record->steps(layer), steps));
        bytes_ += now - before;
        before = now;
    }
    void add_whole(const DirectoryNode& node) {
        for (const Layer layer : {Layer::kMesh, Layer::kFacade, Layer::kAtlas}) {
            add_layer(node, layer, static_cast<uint32_t>(node.record->steps(layer).size()));
        }
    }
    void add_maps(const std::vector<uint32_t>& maps, const MapDemand& demand) {
        for (const uint32_t map : maps) {
            const std::optional<MapPiece> piece = knowledge_.dictionary.wanted(map, demand);
            if (piece && pieces_.insert(*piece).second) bytes_ += knowledge_.dictionary.wire_bytes(*piece);
        }
    }
    void add_chart(const ChartPrefix& prefix) {
        uint64_t& before = charts_[prefix.chart];
        const uint64_t now = std::max(before, knowledge_.charts.wire_bytes(prefix));
        bytes_ += now - before;
        before = now;
    }
    /// All that a tile shows of the dictionaries.
    void add_shared(const TileKnowledge& tile) {
        add_maps(tile.facade_maps, kExact);
        for (const auto& use : tile.charts) add_chart({use.number, knowledge_.charts.usable_levels(use.number)});
    }
    uint64_t bytes() const { return bytes_; }

  private:
    const CityKnowledge& knowledge_;
    std::map<tiles::tileset::TileAddress, std::array<uint64_t, kLayerCount>> layers_;
    std::set<MapPiece> pieces_;
    std::map<uint32_t, uint64_t> charts_;  ///< by number: of the longest prefix
    uint64_t bytes_ = 0;
};

/// The directory, the placements' maps and the shared charts, all known: what the baselines choose from.
struct KnownCity {
    DirectoryCache directory;
    CityKnowledge knowledge;
};

/// The first `count` steps of a layer as they lie in the archive.
std::vector<std::vector<std::byte>> wire_of(const SampleCity& city, const DirectoryNode& node, Layer layer,
                                            size_t count) {
    std::vector<std::vector<std::byte>> wire;
    uint64_t begin = 0;
    for (const auto& step : std::span(node.record->steps(layer)).first(count)) {
        const auto bytes = city.layer_bytes(*node.record, layer).subspan(begin, step.end - begin);
        wire.emplace_back(bytes.begin(), bytes.end());
        begin = step.end;
    }
    return wire;
}

bool learn_maps(const SampleCity& city, const DirectoryNode& node, TileKnowledge& known) {
    const auto& steps = node.record->steps(Layer::kFacade);
    if (steps.empty()) return true;
    DecodedPrefix prefix;
    LayerFacts facts;
    DecodeFailure failure;
    const NameLimits limits = {kAnyChart, static_cast<uint32_t>(city.maps.size()), 0};
    const auto wire = wire_of(city, node, Layer::kFacade, steps.size());
    if (!decode_layer(Layer::kFacade, wire, steps, limits, prefix, facts, failure)) return false;
    known.facade_maps = facts.facade_maps;
    known.placements = facts.placements;
    known.facade_maps_known = true;
    return true;
}

/// From the first steps of its atlas and mesh, as clients do.
bool learn_charts(const SampleCity& city, const DirectoryCache& directory, NodeIndex index, TileKnowledge& known) {
    const DirectoryNode& node = directory.node(index);
    const auto& steps = node.record->steps(Layer::kAtlas);
    if (!names_charts(city.manifest) || steps.empty()) return true;
    DecodedPrefix atlas;
    LayerFacts facts;
    DecodeFailure failure;
    const NameLimits limits = {kAnyChart, 0, city.charts.size()};
    const auto wire = wire_of(city, node, Layer::kAtlas, 1);
    if (!decode_layer(Layer::kAtlas, wire, std::span(steps).first(1), limits, atlas, facts, failure)) return false;
    known.charts = facts.atlas.shared_charts;
    known.alpha_charts = facts.atlas.alpha_charts;
    known.charts_known = true;
    if (!learns_chart_boxes(directory, index)) return true;
    const auto first = std::span(node.record->steps(Layer::kMesh)).first(1);
    const auto mesh = decode_mesh_content(wire_of(city, node, Layer::kMesh, 1), first);
    if (!mesh) return false;
    known.chart_boxes = chart_boxes_of(*mesh, 1, tile_corner(directory, index), double{first[0].error});
    known.chart_boxes_known = true;
    return true;
}

KnownCity know(const SampleCity& city, BenchProgram& program) {
    KnownCity known{DirectoryCache(city.manifest, nullptr), {}};
    for (const auto& subtree : city.subtrees)
        program.check(known.directory.add_subtree(subtree.bytes, subtree.parsed.root).ok(),
                      "a subtree joins the directory");
    known.knowledge.tiles.resize(known.directory.nodes().size());
    known.knowledge.dictionary.learn(city.maps);
    known.knowledge.charts.learn(city.charts);
    for (NodeIndex i = 0; i < known.directory.nodes().size(); ++i) {
        TileKnowledge& tile = known.knowledge.tiles[i];
        program.check(learn_maps(city, known.directory.node(i), tile), "a facade layer decodes");
        program.check(learn_charts(city, known.directory, i, tile), "what an atlas shares decodes");
    }
    return known;
}

struct Baselines {
    uint64_t whole_tiles = 0, leaves_only = 0, everything = 0;
    std::vector<double> frame_to_leaves;  ///< what one camera's selection needs over what its visible leaves need
};

/// Adds the prefixes that the rule asks for of every visible leaf.
void add_visible_leaves(const KnownCity& known, Selector& selector, const Camera& camera, Received& received) {
    const auto& nodes = known.directory.nodes();
    const PositionRule positions = position_rule(camera, kTolerance);
    for (NodeIndex i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf() || !selector.visible(i)) continue;
        const double scale = selector.pixels_per_metre(i);
        received.add_layer(
            nodes[i], Layer::kMesh,
            mesh_prefix(nodes[i].record->steps(Layer::kMesh),
                        usable_steps(nodes[i], known.knowledge.tiles[i], Layer::kMesh),
                        granted_in(positions, nodes[i].record->bounds, known.directory.manifest().origin)));
        for (const Layer layer : {Layer::kAtlas, Layer::kFacade}) {
            if (layer == Layer::kFacade && nodes[i].record->flat_facade_error * scale <= kTolerance) continue;
            const uint32_t usable = usable_steps(nodes[i], known.knowledge.tiles[i], layer);
            received.add_layer(nodes[i], layer,
                               shortest_prefix(nodes[i].record->steps(layer), usable, scale, kTolerance));
            if (layer == Layer::kFacade)
                received.add_maps(known.knowledge.tiles[i].facade_maps,
                                  {kTexelShare * kTolerance / scale, std::nullopt});
        }
        for (const auto& use : known.knowledge.tiles[i].charts) {
            const double near = selector.chart_pixels_per_metre(i, use.chart_in_tile);
            received.add_chart(known.knowledge.charts.wanted(use, near, kTolerance));
        }
    }
}

Baselines baselines_of(const KnownCity& known, const Tour& tour) {
    Baselines result;
    Received whole(known.knowledge), leaves(known.knowledge), everything(known.knowledge);
    Selector selector(known.directory, known.knowledge);
    const auto& nodes = known.directory.nodes();
    for (const CameraSample& sample : tour.path.samples) {
        const Camera camera = Camera::from_sample(sample, 1280, 720);
        const Selection chosen = selector.select(camera, kTolerance, kSlotBytes);
        for (const SelectedTile& tile : chosen.tiles) {
            whole.add_whole(nodes[tile.node]);
            whole.add_shared(known.knowledge.tiles[tile.node]);
        }
        Received frame(known.knowledge);
        add_visible_leaves(known, selector, camera, frame);
        add_visible_leaves(known, selector, camera, leaves);
        if (frame.bytes() > 0) {
            const auto leaf_bytes = static_cast<double>(frame.bytes());
            result.frame_to_leaves.push_back(static_cast<double>(chosen.cost.wire_bytes) / leaf_bytes);
        }
    }
    for (NodeIndex i = 0; i < nodes.size(); ++i) {
        if (!nodes[i].is_leaf()) continue;
        everything.add_whole(nodes[i]);
        everything.add_shared(known.knowledge.tiles[i]);
    }
    result.whole_tiles = whole.bytes();
    result.leaves_only = leaves.bytes();
    result.everything = everything.bytes();
    return result;
}

struct Flight {
    uint64_t received = 0, drawn = 0, requests = 0, tiles_missing = 0;
    std::string failure;
};

Flight fly(const SampleCity& city, const Tour& tour) {
    Flight flight;
    auto fetcher = Fetcher::open(city.path, {});
    if (!fetcher) return {0, 0, 0, 0, fetcher.error().text()};
    HostLayerStore store(kStoreBytes, kSlotBytes, true);
    StreamerOptions options;
    options.tolerance_pixels = kTolerance;
    auto streamer = CityStreamer::open(**fetcher, store, options);
    if (!streamer) return {0, 0, 0, 0, streamer.error().text()};
    CityIndex index;
    index.learn(tiles::tileset::kTilesetPath, city.archive->find(tiles::tileset::kTilesetPath));
    for (const auto& subtree : city.subtrees)
        index.learn(tiles::tileset::subtree_path(subtree.parsed.root), subtree.bytes);
    index.learn(tiles::tileset::kFacadeIndexPath, city.archive->find(tiles::tileset::kFacadeIndexPath));
    if (!city.charts.empty())
        index.learn(tiles::tileset::kChartIndexPath, city.archive->find(tiles::tileset::kChartIndexPath));
    DrawnPrefixes drawn(index, store);
    for (const CameraSample& sample : tour.path.samples) {
        StreamerFrame frame;
        drawn.note((*streamer)->update(Camera::from_sample(sample, 1280, 720), frame), [](auto, bool) {});
        flight.tiles_missing += frame.tiles_missing;
        for (const auto& warning : frame.warnings) flight.failure = warning;
    }
    streamer->reset();
    flight.received = (*fetcher)->statistics().body_bytes;
    flight.requests = (*fetcher)->statistics().requests;
    flight.drawn = drawn.bytes();
    return flight;
}

void measure_tour(const std::string& name, const SampleCity& city, const KnownCity& known, const Tour& tour,
                  int repetitions, BenchProgram& program) {
    std::vector<double> over_fetch;
    Flight flight;
    for (int i = 0; i < repetitions; ++i) {
        flight = fly(city, tour);
        if (!program.check(flight.failure.empty(), name + ", " + tour.name + ": " + flight.failure)) return;
        if (!program.check(flight.drawn > 0 && flight.received >= flight.drawn,
                           tour.name + ": what is drawn was received"))
            return;
        over_fetch.push_back(static_cast<double>(flight.received) / static_cast<double>(flight.drawn));
    }
    program.check(flight.tiles_missing == 0, tour.name + ": every tile is drawn as chosen");
    const Baselines baselines = baselines_of(known, tour);
    const auto over = [&](uint64_t bytes) {
        return rounded(static_cast<double>(bytes) / static_cast<double>(flight.drawn));
    };
    program.print({{"city", name},
                   {"tour", tour.name},
                   {"cameras", tour.path.samples.size()},
                   {"requests", flight.requests},
                   {"received_bytes", flight.received},
                   {"drawn_bytes", flight.drawn},
                   {"over_fetch", to_json(spread_of(over_fetch))},
                   {"over_fetch_whole_tiles", over(baselines.whole_tiles)},
                   {"over_fetch_leaves_only", over(baselines.leaves_only)},
                   {"over_fetch_everything", over(baselines.everything)},
                   {"frame_to_leaves_only", to_json(spread_of(baselines.frame_to_leaves))}});
}

void measure_city(const std::string& name, const Result<SampleCity>& city, int repetitions, BenchProgram& program) {
    if (!program.check(city.ok(), city.ok() ? "" : city.error().text())) return;
    const KnownCity known = know(*city, program);
    for (const Tour& tour : tours_of(*city)) measure_tour(name, *city, known, tour, repetitions, program);
}

}  // namespace

int main(int argc, char** argv) {
    BenchProgram program({"bench_over_fetch", kClaim, "city.3tz"});
    BenchOptions options;
    options.buildings = 3000;
    options.repetitions = 5;
    if (!program.read_arguments(argc, argv, options)) return program.exit_code();
    const TemporaryFolder folder;
    if (options.files.empty()) {
        const std::string archive = folder / "generated.3tz";
        const Status built = build_generated(options.buildings, options.seed, kAllLayers, archive);
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
